//! From the names in a scene to a stepper.

use nalgebra::SVector;

use materialpoint::error::{GridError, SetupError};
use materialpoint::grid::Grid;
use materialpoint::law::AnyLaw;
use materialpoint::scalar::Scalar;
use materialpoint::stepper::Simulation;
use materialpoint_steppers::{Build, BuildError, Parts};

use super::error::RunError;
use super::initial::{Initial, initial};
use super::space::InSpace;
use crate::scene::{Phases, Scene};

/// A stepper of the method that the scene names.
pub type Built<const D: usize> = Result<Box<dyn Simulation<D>>, RunError>;

/// The scene's grid.
pub(super) fn grid<T: Scalar, const D: usize>(scene: &Scene) -> Result<Grid<T, D>, GridError> {
    let bound = |values: &[f64]| SVector::from(per_axis(values, f64::NAN).map(T::lit));
    Grid::new(
        bound(&scene.grid.min),
        bound(&scene.grid.max),
        per_axis(&scene.grid.cells, 0),
    )
}

/// The entries of a list with one for each axis; `missing` where there is none.
pub(super) fn per_axis<A: Copy, const D: usize>(values: &[A], missing: A) -> [A; D] {
    std::array::from_fn(|axis| values.get(axis).copied().unwrap_or(missing))
}

/// What a stepper starts from, before its types are known.
pub struct Start<'a, const D: usize> {
    pub(super) scene: &'a Scene,
    initial: Initial<D>,
}

impl<'a, const D: usize> Start<'a, D>
where
    Scene: InSpace<D>,
{
    /// Of a run with steps of `dt` (s), or of none.
    pub(super) fn new(scene: &'a Scene, dt: f64) -> Result<Self, RunError> {
        let initial = initial(scene, &grid(scene)?, dt)?;
        Ok(Self { scene, initial })
    }

    /// The stepper once the law is known.
    pub(super) fn with_law<T: Scalar>(self, law: AnyLaw<T, D>) -> Built<D>
    where
        Parts<T, D>: Build<D>,
    {
        let scene = self.scene;
        let Initial {
            particles,
            liquid,
            surface,
            first_particles,
        } = self.initial;
        let parts = Parts {
            grid: grid(scene)?,
            law,
            liquid: match scene.material.phases {
                Phases::One { .. } => None,
                Phases::Two(soil) => Some(soil.cast()),
            },
            velocity_mass: scene.method.velocity_mass,
            virtual_points: scene.method.virtual_points,
            particles,
            pores: liquid,
            surface: surface.iter().map(|point| point.cast()).collect(),
            under_stress: scene.bodies.iter().any(|body| body.stress.is_some()),
        };
        parts.stepper(scene.method.method()).map_err(|error| match error {
            BuildError::NoSuchMethod(method) => RunError::NoSuchMethod(method),
            BuildError::NoSuchMass(mass) => RunError::NoSuchMass(mass),
            BuildError::Setup(error) => of_body(error, &first_particles),
        })
    }
}

/// An error of the initial stress with the body whose particle it is about.
fn of_body(error: SetupError, first_particles: &[usize]) -> RunError {
    match error {
        SetupError::InitialStress {
            particle,
            position,
            stress,
            allowed,
        } => {
            let first = first_particles.iter().rposition(|&first| first <= particle);
            RunError::InitialStress {
                body: first.unwrap_or(0),
                position,
                stress,
                allowed,
            }
        }
        error => error.into(),
    }
}
