//! Why a run could not start or go on.

use thiserror::Error;

use super::checkpoint::CheckpointError;
use crate::error::{GridError, SetupError, StepError, named};
use crate::method::Method;
use crate::output::OutputError;
use crate::reference::ReferenceError;
use crate::scene::ExpressionError;

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
    #[error("step {step}: the energy of the particles became {value}; {}", advice(*dt, *critical, remedy))]
    NoEnergy {
        /// Number of the step, from 1.
        step: usize,
        /// What came out (J; in one dimension J/m2, in two J/m).
        value: f64,
        /// Time step of the run (s).
        dt: f64,
        /// Largest stable step of the initial layout (s), if it could be found.
        critical: Option<f64>,
        /// What helps against a step above it, besides a smaller one.
        remedy: &'static str,
    },
    /// The run stopped on the way.
    #[error("{source}; {}{note}", advice(*dt, *critical, remedy))]
    Stopped {
        /// What happened, at which step, to which particle.
        source: StepError,
        /// Time step of the run (s).
        dt: f64,
        /// Largest stable step of the initial layout (s), if it could be found.
        critical: Option<f64>,
        /// What helps against a step above it, besides a smaller one.
        remedy: &'static str,
        /// What else was seen in the particles as they are then: empty, or the end of a sentence.
        note: String,
    },
}

fn advice(dt: f64, critical: Option<f64>, remedy: &str) -> String {
    match critical {
        Some(limit) if dt > limit => format!(
            "the run is unstable: time.step = {dt:.3e} s is above the largest stable step, {limit:.3e} s, so take a smaller one or \"auto\"{remedy}"
        ),
        Some(limit) => format!(
            "time.step = {dt:.3e} s is within the largest stable step of the initial layout, {limit:.3e} s, so look at the loads, the grid's extent and the method"
        ),
        None => format!("time.step = {dt:.3e} s; look at the loads and the grid's extent"),
    }
}

impl From<CheckpointError> for RunError {
    fn from(error: CheckpointError) -> Self {
        Self::Checkpoint(Box::new(error))
    }
}
