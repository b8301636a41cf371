//! Steps with nodal patches: bodies that turn and cross cells, free and between walls.

use materialpoint::basis::BSpline;
use materialpoint::grid::{Face, Grid};
use materialpoint::law::{Moduli, NeoHookean};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::NodalTaylor;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::vector;

#[test]
fn no_step_with_nodal_patches_allocates() {
    let grid = Grid::new(vector![-1.0, -1.0], vector![1.0, 1.0], [8; 2]).unwrap();
    let mut points = lattice(&grid, grid.min(), grid.max(), [3; 2]);
    points.retain(|(x, _)| x.norm() < 0.6);
    let law = NeoHookean {
        moduli: Moduli::from_young(1e3, 0.3).unwrap(),
    };
    let mut particles = Particles::at_rest(&points, 1.0);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *v = vector![-2.0 * x[1], 3.0 * x[0]];
    }
    let basis = BSpline::<2>;
    let fits = NodalTaylor::<f64, 2, 6>::for_basis(&basis);
    let setup = Setup::new(grid, basis, fits, law, OnePhase, particles);
    let mut stepper = Stepper::new(setup).unwrap();
    let mut walls = Forcing::none();
    for face in Face::all::<2>() {
        walls.set_face(face, FaceCondition::roller(face.axis));
    }
    for forcing in [&Forcing::none(), &walls] {
        let steps = allocation_counter::measure(|| {
            for _ in 0..100 {
                stepper.step(1e-3, forcing).unwrap();
            }
        });
        assert_eq!(steps.count_total, 0);
    }
    assert!(stepper.diagnostics().grid_crossings > 10);
}
