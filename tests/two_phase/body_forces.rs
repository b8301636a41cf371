//! Forces per mass of each particle act on both phases; conditions that a phase does not know are refused.

use materialpoint::basis::{BSpline, BasisFamily, Linear};
use materialpoint::error::StepError;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, OnePhase, Phase, TwoPhase};
use materialpoint::reconstruction::{Reconstruction, RelaxedTaylor, Shepard, Taylor};
use materialpoint::stepper::{Forcing, PoreCondition, Setup, Stepper};
use nalgebra::SVector;

const DT: f64 = 1e-4;

fn soil(drag: Drag) -> TwoPhase<f64> {
    TwoPhase {
        porosity: 0.4,
        solid_density: 2.6e3,
        liquid_density: 1e3,
        liquid_bulk_modulus: 3e8,
        permeability: 1e-3,
        permeability_exponent: 0.0,
        gravity: 9.81,
        drag,
    }
}

/// A block at rest in the middle of its grid.
fn block<const D: usize, B, R, P>(
    basis: B,
    reconstruction: R,
    phase: P,
) -> Stepper<f64, D, B, R, LinearElastic<f64>, P>
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
    P: Phase<f64, D>,
{
    let grid = Grid::new(SVector::zeros(), SVector::repeat(1.0), [8; D]).unwrap();
    let points = lattice(&grid, &SVector::repeat(0.25), &SVector::repeat(0.75), [4; D]);
    let particles = Particles::at_rest(&points, soil(Drag::Implicit).dry_density());
    let moduli = Moduli::from_young(1e7, 0.2).unwrap();
    Stepper::new(
        Setup::new(
            grid,
            basis,
            reconstruction,
            LinearElastic { moduli },
            phase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
    )
    .unwrap()
}

/// Momentum (kg m/s) of solid and liquid.
fn momenta<const D: usize, B, R>(
    stepper: &Stepper<f64, D, B, R, LinearElastic<f64>, TwoPhase<f64>>,
) -> [SVector<f64, D>; 2]
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    let particles = stepper.particles();
    let mut sum = [SVector::zeros(); 2];
    for p in 0..particles.len() {
        let liquid_mass = 0.4 * 1e3 * particles.volume[p];
        sum[0] += particles.velocity[p] * particles.mass[p];
        sum[1] += particles.phase[p].velocity * liquid_mass;
    }
    sum
}

/// From rest, without stress, the mixture gains `dt sum (m_s + n m_w) b`, however the force varies; and under
/// a uniform one each phase falls with the acceleration `b`, as with the same force in the forcing.
fn check<const D: usize, B, R>(basis: B, reconstruction: R)
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D> + Clone,
{
    for drag in [Drag::Implicit, Drag::Explicit] {
        let uneven =
            |x: &SVector<f64, D>| SVector::from_fn(|a, _| 3.0 * x[a] - (a as f64 + 1.0) * x[0] * x[0]);
        let mut stepper = block(basis.clone(), reconstruction.clone(), soil(drag));
        stepper.set_body_forces(uneven);
        stepper.step(DT, &Forcing::none()).unwrap();
        let particles = stepper.particles();
        let expected = (0..particles.len()).fold(SVector::zeros(), |sum: SVector<f64, D>, p| {
            let mass = particles.mass[p] + 0.4 * 1e3 * particles.volume[p];
            sum + uneven(&particles.initial_position[p]) * (mass * DT)
        });
        let [solid, liquid] = momenta(&stepper);
        let error = (solid + liquid - expected).norm() / expected.norm();
        assert!(error < 1e-12, "{error:e}");

        let gravity = SVector::from_fn(|a, _| 2.0 - a as f64);
        let mut stepper = block(basis.clone(), reconstruction.clone(), soil(drag));
        stepper.set_body_forces(|_| gravity);
        for _ in 0..20 {
            stepper.step(DT, &Forcing::none()).unwrap();
        }
        let fallen = gravity * (20.0 * DT);
        for p in 0..stepper.particles().len() {
            let solid = stepper.particles().velocity[p];
            let liquid = stepper.particles().phase[p].velocity;
            let error = (solid - fallen).norm().max((liquid - fallen).norm()) / fallen.norm();
            assert!(error < 1e-11, "{p}: {error:e}");
        }
    }
}

#[test]
fn a_force_of_each_particle_acts_on_solid_and_liquid() {
    check::<1, _, _>(Linear, Shepard);
    check::<1, _, _>(BSpline::<2>, Taylor::<f64, 1, 3>::for_degree(2));
    check::<1, _, _>(Linear, RelaxedTaylor::<f64, 1, 3>::for_basis(&Linear));
    check::<2, _, _>(Linear, Shepard);
}

#[test]
fn conditions_that_a_phase_does_not_know_are_refused_before_anything_moves() {
    let face = Face {
        axis: 0,
        side: Side::Max,
    };
    let mut one = block::<1, _, _, _>(Linear, Shepard, OnePhase);
    let open = Forcing::none().with_pores(face, PoreCondition::Pressure(0.0));
    assert_eq!(one.step(DT, &open), Err(StepError::PressureWithoutFlow { face }));
    assert_eq!(one.steps(), 0);
    let mut two = block::<1, _, _, _>(Linear, Shepard, soil(Drag::Implicit));
    assert!(one.step(DT, &Forcing::none()).is_ok() && two.step(DT, &open).is_ok());
}
