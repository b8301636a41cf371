//! Why a run could not start or go on.

use thiserror::Error;

use super::checkpoint::CheckpointError;
use crate::output::OutputError;
use crate::scene::ExpressionError;
use materialpoint::error::{GridError, SetupError, StepError, named};
use materialpoint::mass::VelocityMass;
use materialpoint::method::Method;
use materialpoint::reference::ReferenceError;

/// Why a run could not start or go on.
#[derive(Debug, Error)]
pub enum RunError {
    /// The grid cannot be built.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// The particles or the material cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// An expression has no finite value where it is needed.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// The reference cannot be evaluated.
    #[error("reference: {0}")]
    Reference(#[from] ReferenceError),
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The run cannot be resumed from that checkpoint.
    #[error(transparent)]
    Checkpoint(Box<CheckpointError>),
    /// No such combination of basis and reconstruction.
    #[error("method {0} does not exist")]
    NoSuchMethod(Method),
    /// A reconstruction that has another mass.
    #[error("method.velocity_mass = \"{}\": the reconstruction has no such mass; leave it out", .0.name())]
    NoSuchMass(VelocityMass),
    /// Another number of axes than the caller counts on.
    #[error("the scene has {found} axes; expected {expected}")]
    Dimension {
        /// Axes of the scene.
        found: usize,
        /// Axes asked for.
        expected: usize,
    },
    /// A law that these dimensions do not have.
    #[error("material.law.{law} does not exist in {dimension} dimensions")]
    NoSuchLaw {
        /// Its name.
        law: &'static str,
        /// Axes of the scene.
        dimension: usize,
    },
    /// A body whose shape leaves out every particle of its box.
    #[error(
        "body.{index}.inside: no particle of the body's box is inside; expected a shape that holds some, or more particles_per_cell"
    )]
    EmptyBody {
        /// Number of the body, from 0.
        index: usize,
    },
    /// A stress at the start that the law cannot bear.
    #[error(
        "body.{body}.stress: at {position:.4?} m it is {}, which the law cannot start under; {allowed}",
        named(stress)
    )]
    InitialStress {
        /// Number of the body, from 0.
        body: usize,
        /// Where (m).
        position: Vec<f64>,
        /// Components of the stress (Pa) by name.
        stress: Vec<(String, f64)>,
        /// What the law bears instead.
        allowed: String,
    },
    /// `step = "auto"` that never gets to the end.
    #[error(
        "time.end: with time.step = \"auto\" it takes {steps:.1e} steps of {dt:.3e} s; expected at most 1e12, so an earlier end, larger cells or a softer material"
    )]
    TooManySteps {
        /// How many it would be.
        steps: f64,
        /// Their size (s).
        dt: f64,
    },
    /// `step = "auto"` on particles that nothing resists.
    #[error(
        "time.step = \"auto\": nothing resists a motion of these particles, so no step is critical; give a number"
    )]
    NoCriticalStep,
    /// Stresses or velocities at the start that have no finite energy.
    #[error(
        "the energy at the start is {value}; expected smaller velocities and stresses (linear-elastic at large strain bears less than youngs_modulus)"
    )]
    NoEnergyAtStart {
        /// What came out (J; in one dimension J/m2, in two J/m).
        value: f64,
    },
    /// Numbers that grew beyond what a float can hold, or a stress beyond what the law can bear.
    #[error("step {step}: the energy of the particles became {value}; {advice}")]
    NoEnergy {
        /// Number of the step, from 1.
        step: usize,
        /// What came out (J; in one dimension J/m2, in two J/m).
        value: f64,
        /// What to do, with the key to change.
        advice: String,
    },
    /// The run stopped on the way.
    #[error("{source}; {advice}")]
    Stopped {
        /// What happened, at which step, to which particle.
        source: StepError,
        /// What to do, with the key to change.
        advice: String,
    },
}

impl From<CheckpointError> for RunError {
    fn from(error: CheckpointError) -> Self {
        Self::Checkpoint(Box::new(error))
    }
}
