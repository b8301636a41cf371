//! Forces per mass of each particle act on both phases; conditions that a phase does not know are refused.

use materialpoint::error::StepError;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, PoreLiquid, TwoPhase};
use materialpoint::stepper::{Forcing, PoreCondition, Simulation};
use materialpoint_steppers::{Build, Parts};
use nalgebra::SVector;

use crate::compiled::{self, parts};

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
fn block<const D: usize>(
    basis: Basis,
    reconstruction: ReconstructionKind,
    liquid: Option<TwoPhase<f64>>,
) -> Box<dyn Simulation<D>>
where
    Parts<f64, D>: Build<D>,
{
    let grid = Grid::new(SVector::zeros(), SVector::repeat(1.0), [8; D]).unwrap();
    let points = lattice(&grid, &SVector::repeat(0.25), &SVector::repeat(0.75), [4; D]);
    let particles = Particles::at_rest(&points, soil(Drag::Implicit).dry_density());
    let moduli = Moduli::from_young(1e7, 0.2).unwrap();
    let parts = Parts {
        liquid,
        pores: vec![PoreLiquid::default(); points.len()],
        ..parts(grid, LinearElastic { moduli }, particles)
    };
    compiled::simulation(
        Method::new(basis, reconstruction),
        VelocityMass::Consistent,
        parts,
    )
}

/// Momentum (kg m/s) of solid and liquid.
fn momenta<const D: usize>(stepper: &dyn Simulation<D>) -> [SVector<f64, D>; 2] {
    let (particles, liquid) = (stepper.particles(), stepper.liquid());
    let mut sum = [SVector::zeros(); 2];
    for p in 0..particles.len() {
        let liquid_mass = 0.4 * 1e3 * particles.volume[p];
        sum[0] += particles.velocity[p] * particles.mass[p];
        sum[1] += liquid[p].velocity * liquid_mass;
    }
    sum
}

/// From rest, without stress, the mixture gains `dt sum (m_s + n m_w) b`, however the force varies; and under
/// a uniform one each phase falls with the acceleration `b`, as with the same force in the forcing.
fn check<const D: usize>(basis: Basis, reconstruction: ReconstructionKind)
where
    Parts<f64, D>: Build<D>,
{
    for drag in [Drag::Implicit, Drag::Explicit] {
        let uneven =
            |x: &SVector<f64, D>| SVector::from_fn(|a, _| 3.0 * x[a] - (a as f64 + 1.0) * x[0] * x[0]);
        let mut stepper = block::<D>(basis, reconstruction, Some(soil(drag)));
        stepper.set_body_forces(&uneven);
        stepper.step(DT, &Forcing::none()).unwrap();
        let particles = stepper.particles();
        let expected = (0..particles.len()).fold(SVector::zeros(), |sum: SVector<f64, D>, p| {
            let mass = particles.mass[p] + 0.4 * 1e3 * particles.volume[p];
            sum + uneven(&particles.initial_position[p]) * (mass * DT)
        });
        let [solid, liquid] = momenta(stepper.as_ref());
        let error = (solid + liquid - expected).norm() / expected.norm();
        assert!(error < 1e-12, "{error:e}");

        let gravity = SVector::from_fn(|a, _| 2.0 - a as f64);
        let mut stepper = block::<D>(basis, reconstruction, Some(soil(drag)));
        stepper.set_body_forces(&|_| gravity);
        for _ in 0..20 {
            stepper.step(DT, &Forcing::none()).unwrap();
        }
        let fallen = gravity * (20.0 * DT);
        let (particles, liquid) = stepper.into_particles();
        for p in 0..particles.len() {
            let (solid, liquid) = (particles.velocity[p], liquid[p].velocity);
            let error = (solid - fallen).norm().max((liquid - fallen).norm()) / fallen.norm();
            assert!(error < 1e-11, "{p}: {error:e}");
        }
    }
}

#[test]
fn a_force_of_each_particle_acts_on_solid_and_liquid() {
    use ReconstructionKind::{RelaxedTaylor, Shepard, Taylor};
    check::<1>(Basis::Linear, Shepard);
    check::<1>(Basis::BSpline { degree: 2 }, Taylor);
    check::<1>(Basis::Linear, RelaxedTaylor);
    check::<2>(Basis::Linear, Shepard);
}

#[test]
fn conditions_that_a_phase_does_not_know_are_refused_before_anything_moves() {
    let face = Face {
        axis: 0,
        side: Side::Max,
    };
    let state = |stepper: &dyn Simulation<1>| {
        let mut bytes = Vec::new();
        stepper.save(&mut bytes).unwrap();
        bytes
    };
    let block = |liquid| block::<1>(Basis::Linear, ReconstructionKind::Shepard, liquid);
    let mut one = block(None);
    let before = state(one.as_ref());
    let open = Forcing::none().with_pores(face, PoreCondition::Pressure(0.0));
    assert_eq!(one.step(DT, &open), Err(StepError::PressureWithoutFlow { face }));
    // With the number of steps.
    assert!(state(one.as_ref()) == before);
    let mut two = block(Some(soil(Drag::Implicit)));
    assert!(one.step(DT, &Forcing::none()).is_ok() && two.step(DT, &open).is_ok());
    assert!(state(one.as_ref()) != before);
}
