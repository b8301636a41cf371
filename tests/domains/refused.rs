//! What cannot work is told.

use materialpoint::basis::Linear;
use materialpoint::error::SetupError;
use materialpoint::grid::Grid;
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::particles::Particles;
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::{Reconstruction, RelaxedTaylor, Shepard};
use materialpoint::stepper::{Setup, Stepper};
use nalgebra::{SVector, vector};

use super::bodies::{particles, stepper};
use super::edges::Corners;
use super::gimp::Gimp;

fn attempt<const D: usize, B, R>(
    basis: B,
    reconstruction: R,
    (grid, particles): (Grid<f64, D>, Particles<f64, D>),
) -> Result<(), SetupError>
where
    B: materialpoint::basis::BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    Stepper::new(Setup::new(
        grid,
        basis,
        reconstruction,
        LinearElastic {
            moduli: Moduli::from_young(1.0, 0.2).unwrap(),
        },
        OnePhase,
        particles,
    ))
    .map(|_| ())
}

/// Half a cell to each side is the most, and one particle a cell is that large.
#[test]
fn a_particle_larger_than_a_cell_is_refused() {
    let body = |volume: f64| {
        let grid = Grid::new(vector![0.0, 0.0], vector![4.0, 4.0], [4, 4]).unwrap();
        let points = [(vector![1.5, 1.5], 1.0), (vector![2.5, 1.5], volume)];
        (grid, Particles::at_rest(&points, 1.0))
    };
    assert_eq!(attempt(Gimp, Shepard, body(1.0)), Ok(()));
    let found = attempt(Gimp, Shepard, body(1.44));
    let Err(SetupError::Value { particle, value, .. }) = found else {
        panic!("{found:?}");
    };
    assert_eq!(particle, 1);
    assert!((value - 0.6).abs() < 1e-12, "{value}");
    assert_eq!(attempt(Linear, Shepard, body(1.44)), Ok(()));
}

#[test]
fn domains_that_no_one_asks_for_are_refused_and_given_ones_are_taken() {
    let (grid, mut all) = particles::<1>(8, 2);
    all.domains.half_lengths = vec![vector![0.125]; all.len()];
    let taken = stepper(Gimp, Shepard, (grid.clone(), all.clone()));
    assert_eq!(taken.particles().domains, all.domains);
    let unwanted = |name| Err(SetupError::UnwantedDomains { name });
    let lengths = unwanted("domains.half_lengths");
    assert_eq!(attempt(Linear, Shepard, (grid.clone(), all.clone())), lengths);
    assert_eq!(attempt(Corners, Shepard, (grid.clone(), all.clone())), lengths);
    all.domains.half_lengths.pop();
    let found = attempt(Gimp, Shepard, (grid.clone(), all.clone()));
    assert!(matches!(found, Err(SetupError::Lengths { .. })), "{found:?}");
    all.domains.half_lengths.push(vector![f64::NAN]);
    let found = attempt(Gimp, Shepard, (grid, all));
    assert!(matches!(found, Err(SetupError::Value { .. })), "{found:?}");
}

/// Mistakes change nothing, and domains that were written are those of the next step.
#[test]
fn domains_are_checked_where_particles_are_edited() {
    let mut stepper = stepper(Gimp, Shepard, particles::<2>(7, 2));
    let before = stepper.particles().domains.clone();
    let found = stepper.edit_particles(|all| all.domains.half_lengths.clear());
    assert!(matches!(found, Err(SetupError::Lengths { .. })), "{found:?}");
    let found = stepper.edit_particles(|all| all.domains.half_lengths[2][1] = 0.7);
    assert!(matches!(found, Err(SetupError::Value { .. })), "{found:?}");
    assert_eq!(stepper.particles().domains, before);
    stepper
        .edit_particles(|all| all.domains.half_lengths.fill(SVector::repeat(0.1)))
        .unwrap();
    stepper
        .step(1e-3, &materialpoint::stepper::Forcing::none())
        .unwrap();
    let sizes = &stepper.particles().domains.half_lengths;
    assert!(sizes.iter().all(|half| *half == vector![0.1, 0.1]));
}

/// Ties between cells continue one polynomial a cell; over domains there is none.
#[test]
fn relaxed_fits_beyond_one_axis_want_points() {
    let found = attempt(
        Gimp,
        RelaxedTaylor::<f64, 2, 6>::for_degree(1),
        particles::<2>(7, 3),
    );
    assert!(
        matches!(found, Err(SetupError::NotPolynomial { .. })),
        "{found:?}"
    );
}
