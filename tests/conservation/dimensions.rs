//! The stepper in two and three dimensions: the same code as in one.

use materialpoint::basis::{BSpline, BasisFamily, DualDomain, Linear};
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Moduli, NeoHookean};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::{Reconstruction, Shepard, Taylor};
use materialpoint::stepper::{Conservation, FaceCondition, Forcing, Setup, Simulation, Stepper};
use nalgebra::SVector;

const CELLS: usize = 5;
/// Ends before a particle crosses a cell edge: with two particles left in a cell the line's fit has fewer
/// functions (never more than particles) than the square's, which has six particles there.
const STEPS: usize = 20;
const DT: f64 = 2e-3;
const ROUND_OFF: f64 = 1e-14;

/// A block of unit size between frictionless walls that moves along x only, with Poisson's ratio 0: the
/// vibrating bar. Returns the displacements along x of the particles in the first row, and the conservation
/// errors.
fn bar<const D: usize, B, R>(basis: B, reconstruction: R, mass: VelocityMass) -> (Vec<f64>, Conservation<f64>)
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    let grid = Grid::new(SVector::zeros(), SVector::repeat(1.0), [CELLS; D]).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [3; D]);
    let mut particles = Particles::at_rest(&points, 2e3);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = 0.8 * (std::f64::consts::PI * x[0]).sin();
    }
    let mut forcing = Forcing::none();
    for axis in 0..D {
        for side in [Side::Min, Side::Max] {
            forcing.set_face(Face { axis, side }, FaceCondition::roller(axis));
        }
    }
    let mut stepper = Stepper::new(
        Setup::new(
            grid,
            basis,
            reconstruction,
            NeoHookean {
                moduli: Moduli::uniaxial(4e4).unwrap(),
            },
            OnePhase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(mass)),
    )
    .unwrap();
    for _ in 0..STEPS {
        stepper.step(DT, &forcing).unwrap();
    }
    // In the order in which they were given, not the one that they are kept in.
    let particles = Simulation::particles(&stepper);
    let row = particles.displacement.iter().take(3 * CELLS);
    (row.map(|u| u[0]).collect(), stepper.diagnostics().conservation)
}

#[track_caller]
fn assert_close(bar: &[f64], (other, errors): (Vec<f64>, Conservation<f64>), tolerance: f64) {
    for (a, b) in bar.iter().zip(&other) {
        assert!((a - b).abs() <= tolerance, "{a} {b}");
    }
    assert!(errors.mass < 1e-13 && errors.momentum < 1e-13, "{errors:?}");
}

#[test]
fn the_bar_in_a_box_is_the_bar_on_a_line() {
    let lumped = VelocityMass::Lumped;
    let line = bar::<1, _, _>(Linear, Shepard, lumped).0;
    // The walls make no motion of their own: the bar moves by more than a tenth of a cell.
    assert!(line.iter().any(|u| u.abs() > 0.02));
    assert_close(&line, bar::<2, _, _>(Linear, Shepard, lumped), ROUND_OFF);
    assert_close(&line, bar::<3, _, _>(Linear, Shepard, lumped), ROUND_OFF);
    let line = bar::<1, _, _>(BSpline::<2>, Shepard, lumped).0;
    assert_close(&line, bar::<2, _, _>(BSpline::<2>, Shepard, lumped), ROUND_OFF);
    assert_close(&line, bar::<3, _, _>(BSpline::<2>, Shepard, lumped), ROUND_OFF);
    let line = bar::<1, _, _>(DualDomain::new(), Shepard, lumped).0;
    assert_close(
        &line,
        bar::<2, _, _>(DualDomain::new(), Shepard, lumped),
        ROUND_OFF,
    );
}

/// Not to round-off, and rightly so: a fit with a given mean is not the product of fits along the axes (the
/// functions of y take part of what x leaves over), and Gauss forces over particle masses vary across the
/// walls with B-splines.
#[test]
fn the_fits_and_the_consistent_mass_agree_to_the_scheme_s_accuracy() {
    for mass in [VelocityMass::Lumped, VelocityMass::Consistent] {
        let line = bar::<1, _, _>(Linear, Taylor::<f64, 1, 3>::new(), mass).0;
        assert_close(
            &line,
            bar::<2, _, _>(Linear, Taylor::<f64, 2, 6>::new(), mass),
            1e-4,
        );
        assert_close(
            &line,
            bar::<3, _, _>(Linear, Taylor::<f64, 3, 10>::new(), mass),
            1e-4,
        );
        let line = bar::<1, _, _>(BSpline::<2>, Taylor::<f64, 1, 3>::new(), mass).0;
        assert_close(
            &line,
            bar::<2, _, _>(BSpline::<2>, Taylor::<f64, 2, 6>::new(), mass),
            1e-4,
        );
        assert_close(
            &line,
            bar::<3, _, _>(BSpline::<2>, Taylor::<f64, 3, 10>::new(), mass),
            1e-4,
        );
    }
}

/// Three and four functions in two and three dimensions, two on a line.
#[test]
fn linear_fits_agree_too() {
    let lumped = VelocityMass::Lumped;
    let line = bar::<1, _, _>(BSpline::<2>, Taylor::<f64, 1, 2>::new(), lumped).0;
    let plane = bar::<2, _, _>(BSpline::<2>, Taylor::<f64, 2, 3>::new(), lumped);
    assert_close(&line, plane, 1e-4);
    let space = bar::<3, _, _>(BSpline::<2>, Taylor::<f64, 3, 4>::new(), lumped);
    assert_close(&line, space, 1e-4);
}
