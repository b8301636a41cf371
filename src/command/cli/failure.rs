//! What ends the command early, and with which status.

use std::fmt;

use materialpoint_command::output::OutputError;
use materialpoint_command::run::RunError;
use materialpoint_command::scene::SceneError;
use materialpoint_command::study::StudyError;

/// Ends the command.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad scene or flags: status 2.
    Input(String),
    /// The run stopped: status 3.
    Stopped(String),
}

impl Failure {
    pub(crate) fn status(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Stopped(_) => 3,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(message) | Self::Stopped(message) => f.write_str(message),
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Input(error.to_string())
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::Stopped(error.to_string())
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        let message = error.to_string();
        match error {
            RunError::Stopped { .. } | RunError::NoEnergy { .. } | RunError::Output(_) => {
                Self::Stopped(message)
            }
            _ => Self::Input(message),
        }
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        let message = error.to_string();
        match error {
            StudyError::NoReference | StudyError::NothingToDo => Self::Input(message),
            StudyError::Run { source, .. } => match Self::from(*source) {
                Self::Input(_) => Self::Input(message),
                Self::Stopped(_) => Self::Stopped(message),
            },
            StudyError::Output(_) => Self::Stopped(message),
        }
    }
}
