//! Steps of one method and nothing else, to be run under an instruction counter:
//!
//! `valgrind --tool=callgrind --toggle-collect='*step_many*' target/release/deps/instructions-* METHOD`
//!
//! A count, unlike a time, does not depend on what else the machine does. It shows what a phase, a law or a
//! reconstruction adds to a step.

use materialpoint::basis::BasisFamily;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Hill, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::method::{Method, MethodVisitor};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Reconstruction;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Simulation, Stepper};
use nalgebra::vector;

const CELLS: usize = 250;
const PER_CELL: usize = 8;
const STEPS: usize = 50;

struct Build;

impl MethodVisitor<f64> for Build {
    type Output = Box<dyn Simulation<1>>;

    fn visit<B, R>(self, basis: B, reconstruction: R) -> Self::Output
    where
        B: BasisFamily<f64, 1> + Send + 'static,
        R: Reconstruction<f64, 1> + Clone + Send + 'static,
    {
        let grid = Grid::new(vector![0.0], vector![1.0], [CELLS]).expect("a valid grid");
        let points = lattice(&grid, grid.min(), grid.max(), [PER_CELL]);
        let mut particles = Particles::at_rest(&points, 2e3);
        for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
            v[0] = 0.8 * (std::f64::consts::PI * x[0]).sin();
        }
        let moduli = Moduli::uniaxial(4e4).expect("a positive modulus");
        let stepper = Stepper::new(
            Setup::new(grid, basis, reconstruction, Hill { moduli }, OnePhase, particles)
                .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
        );
        Box::new(stepper.expect("a valid setup"))
    }
}

#[inline(never)]
fn step_many(simulation: &mut dyn Simulation<1>, forcing: &Forcing<f64, 1>) {
    for _ in 0..STEPS {
        simulation.step(1e-5, forcing).expect("a stable step");
    }
}

fn main() {
    let wanted = std::env::args().nth(1).filter(|name| !name.starts_with('-'));
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let fixed = |forcing: Forcing<f64, 1>, end| forcing.with_face(end, FaceCondition::fixed());
    let forcing = ends.into_iter().fold(Forcing::none(), fixed);
    for method in Method::ALL {
        if wanted.as_ref().is_some_and(|name| *name != method.to_string()) {
            continue;
        }
        let mut simulation = method.dispatch(Build).expect("one of them");
        step_many(simulation.as_mut(), &forcing);
        println!("{method}: {} particles, {STEPS} steps", CELLS * PER_CELL);
    }
}
