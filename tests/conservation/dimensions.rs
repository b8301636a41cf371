//! The stepper in two and three dimensions: the same code as in one.

use materialpoint::basis::{BSpline, BasisFamily};
use materialpoint::grid::{Face, Grid};
use materialpoint::law::{Moduli, NeoHookean};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::{Reconstruction, Taylor};
use materialpoint::stepper::{Conservation, FaceCondition, Forcing, Setup, Simulation, Stepper};
use materialpoint_steppers::{Build, Parts};
use nalgebra::SVector;

use crate::compiled::{self, behind_pointer, parts};

const CELLS: usize = 5;
/// Ends before a particle crosses a cell edge: with two particles left in a cell the line's fit has fewer
/// functions (never more than particles) than the square's, which has six particles there.
const STEPS: usize = 20;
const DT: f64 = 2e-3;
const ROUND_OFF: f64 = 1e-14;

/// A block of unit size between frictionless walls that moves along x only, with Poisson's ratio 0: the
/// vibrating bar.
fn block<const D: usize>() -> (Grid<f64, D>, Particles<f64, D>, NeoHookean<f64>) {
    let grid = Grid::new(SVector::zeros(), SVector::repeat(1.0), [CELLS; D]).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [3; D]);
    let mut particles = Particles::at_rest(&points, 2e3);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = 0.8 * (std::f64::consts::PI * x[0]).sin();
    }
    let moduli = Moduli::uniaxial(4e4).unwrap();
    (grid, particles, NeoHookean { moduli })
}

/// Displacements along x of the particles in the first row after some steps, and the conservation errors.
fn moved<const D: usize>(stepper: &mut dyn Simulation<D>) -> (Vec<f64>, Conservation<f64>) {
    let forcing = Face::all::<D>().fold(Forcing::none(), |forcing, face| {
        forcing.with_face(face, FaceCondition::roller(face.axis))
    });
    for _ in 0..STEPS {
        stepper.step(DT, &forcing).unwrap();
    }
    // In the order in which they were given, not the one that they are kept in.
    let particles = stepper.particles();
    let row = particles.displacement.iter().take(3 * CELLS);
    (row.map(|u| u[0]).collect(), stepper.diagnostics().conservation)
}

fn bar<const D: usize>(
    basis: Basis,
    reconstruction: ReconstructionKind,
    mass: VelocityMass,
) -> (Vec<f64>, Conservation<f64>)
where
    Parts<f64, D>: Build<D>,
{
    let (grid, particles, law) = block::<D>();
    let method = Method::new(basis, reconstruction);
    let mut stepper = compiled::simulation(method, mass, parts(grid, law, particles));
    moved(stepper.as_mut())
}

/// With linear fits, which no method has.
fn linear_bar<const D: usize, const NB: usize>() -> (Vec<f64>, Conservation<f64>)
where
    Taylor<f64, D, NB>: Reconstruction<f64, D, Mass = VelocityMass>,
    BSpline<2>: BasisFamily<f64, D>,
{
    let (grid, particles, law) = block::<D>();
    let (law, particles) = behind_pointer(law, particles);
    let fits = Taylor::<f64, D, NB>::new();
    let setup = Setup::new(grid, BSpline::<2>, fits, law, OnePhase, particles);
    let mut stepper = Stepper::new(setup.with_velocity_mass(VelocityMass::Lumped)).unwrap();
    moved(&mut stepper)
}

#[track_caller]
fn assert_close(bar: &[f64], (other, errors): (Vec<f64>, Conservation<f64>), tolerance: f64) {
    for (a, b) in bar.iter().zip(&other) {
        assert!((a - b).abs() <= tolerance, "{a} {b}");
    }
    assert!(errors.mass < 1e-13 && errors.momentum < 1e-13, "{errors:?}");
}

const LINEAR: Basis = Basis::Linear;
const DUAL_DOMAIN: Basis = Basis::DualDomain;
const BSPLINE: Basis = Basis::BSpline { degree: 2 };

#[test]
fn the_bar_in_a_box_is_the_bar_on_a_line() {
    let (sums, lumped) = (ReconstructionKind::Shepard, VelocityMass::Lumped);
    let line = bar::<1>(LINEAR, sums, lumped).0;
    // The walls make no motion of their own: the bar moves by more than a tenth of a cell.
    assert!(line.iter().any(|u| u.abs() > 0.02));
    assert_close(&line, bar::<2>(LINEAR, sums, lumped), ROUND_OFF);
    assert_close(&line, bar::<3>(LINEAR, sums, lumped), ROUND_OFF);
    let line = bar::<1>(BSPLINE, sums, lumped).0;
    assert_close(&line, bar::<2>(BSPLINE, sums, lumped), ROUND_OFF);
    assert_close(&line, bar::<3>(BSPLINE, sums, lumped), ROUND_OFF);
    let line = bar::<1>(DUAL_DOMAIN, sums, lumped).0;
    assert_close(&line, bar::<2>(DUAL_DOMAIN, sums, lumped), ROUND_OFF);
}

/// Not to round-off, and rightly so: a fit with a given mean is not the product of fits along the axes (the
/// functions of y take part of what x leaves over), and Gauss forces over particle masses vary across the
/// walls with B-splines.
#[test]
fn the_fits_and_the_consistent_mass_agree_to_the_scheme_s_accuracy() {
    let fits = ReconstructionKind::Taylor;
    for mass in [VelocityMass::Lumped, VelocityMass::Consistent] {
        for basis in [LINEAR, BSPLINE] {
            let line = bar::<1>(basis, fits, mass).0;
            assert_close(&line, bar::<2>(basis, fits, mass), 1e-4);
            assert_close(&line, bar::<3>(basis, fits, mass), 1e-4);
        }
    }
}

/// Three and four functions in two and three dimensions, two on a line.
#[test]
fn linear_fits_agree_too() {
    let line = linear_bar::<1, 2>().0;
    assert_close(&line, linear_bar::<2, 3>(), 1e-4);
    assert_close(&line, linear_bar::<3, 4>(), 1e-4);
}
