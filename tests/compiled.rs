//! Steppers of methods by name that are compiled already, once for the command and all tests: a test that
//! names the types of a stepper has it compiled once more, which takes a second of a processor or two.

use materialpoint::grid::Grid;
use materialpoint::law::{AnyLaw, ConstitutiveLaw};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Method, ReconstructionKind};
use materialpoint::particles::Particles;
use materialpoint::record::Record;
use materialpoint::scalar::Scalar;
use materialpoint::stepper::Simulation;
use materialpoint_steppers::{Build, Parts};

/// One phase and no surface: what differs is changed in it.
pub fn parts<const D: usize, L>(grid: Grid<f64, D>, law: L, particles: Particles<f64, D>) -> Parts<f64, D>
where
    L: ConstitutiveLaw<f64, D, State: Record<f64>> + 'static,
{
    behind(grid, AnyLaw::new(law), particles)
}

/// The same with a law that is behind a pointer already.
pub fn behind<const D: usize>(
    grid: Grid<f64, D>,
    law: AnyLaw<f64, D>,
    particles: Particles<f64, D>,
) -> Parts<f64, D> {
    Parts {
        grid,
        law,
        liquid: None,
        velocity_mass: VelocityMass::Lumped,
        virtual_points: false,
        particles,
        pores: Vec::new(),
        surface: Vec::new(),
        under_stress: false,
    }
}

/// The stepper of a method, with this mass or, where its reconstruction has no such mass, with the one that
/// it has.
pub fn simulation<const D: usize>(
    method: Method,
    mass: VelocityMass,
    parts: Parts<f64, D>,
) -> Box<dyn Simulation<D>>
where
    Parts<f64, D>: Build<D>,
{
    let velocity_mass = match method.reconstruction {
        ReconstructionKind::Shepard => VelocityMass::Lumped,
        ReconstructionKind::RelaxedTaylor => VelocityMass::Constrained,
        ReconstructionKind::Taylor | ReconstructionKind::Spline => mass,
    };
    let parts = Parts {
        velocity_mass,
        ..parts
    };
    parts.stepper(method).unwrap()
}

/// The law behind a pointer, and the particles with its states at rest: steppers of tests that name the same
/// types but for the law are one.
pub fn behind_pointer<T, const D: usize, L, P>(
    law: L,
    particles: Particles<T, D, (), P>,
) -> (AnyLaw<T, D>, Particles<T, D, T, P>)
where
    T: Scalar,
    L: ConstitutiveLaw<T, D, State: Record<T>> + 'static,
    P: Copy + Default,
{
    let law = AnyLaw::new(law);
    let states = law.at_rest(particles.len());
    (law, particles.with_states(states))
}
