//! Why a run cannot be resumed.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::file::VERSION;
use materialpoint::error::RestoreError;

/// A checkpoint that a run cannot be resumed from.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// The file cannot be opened or read.
    #[error("the checkpoint `{}` cannot be read ({source})", path.display())]
    Read {
        /// The file asked for.
        path: PathBuf,
        /// What the system answered.
        source: io::Error,
    },
    /// The file is something else.
    #[error("`{}` is no checkpoint; expected the file that a run with output.checkpoint_every leaves", path.display())]
    NotACheckpoint {
        /// The file asked for.
        path: PathBuf,
    },
    /// Written by a version of the program with another format.
    #[error("the checkpoint `{}` has format {found}; this version reads format {VERSION}, so resume with the version that wrote it", path.display())]
    Version {
        /// The file asked for.
        path: PathBuf,
        /// The format that it says it has.
        found: u32,
    },
    /// Bytes are missing or changed.
    #[error("the checkpoint `{}` is damaged or incomplete: {problem}; take an older copy or start the run anew", path.display())]
    Damaged {
        /// The file asked for.
        path: PathBuf,
        /// How that shows.
        problem: &'static str,
    },
    /// Written by a run of another scene.
    #[error("the checkpoint `{}` belongs to another scene: {key} was {there} and is {here} now; only title, [output] and, with a fixed step, time.end may differ", path.display())]
    OtherScene {
        /// The file asked for.
        path: PathBuf,
        /// First key that differs.
        key: Box<str>,
        /// Its value when the checkpoint was written.
        there: Box<str>,
        /// Its value now.
        here: Box<str>,
    },
    /// Beyond the end of the scene.
    #[error("the checkpoint `{}` was written after {done} steps, and the run has {steps} now; give a later time.end", path.display())]
    Beyond {
        /// The file asked for.
        path: PathBuf,
        /// Steps taken when it was written.
        done: usize,
        /// Steps of the scene.
        steps: usize,
    },
    /// Its last step was cut short by the end of its run, or would be by the end of this one.
    #[error("the checkpoint `{}` was written after step {done}, which took {there} s and would take {here} s with this time.end; expected time.end = {end:?} or a later one from an earlier checkpoint", path.display())]
    LastStep {
        /// The file asked for.
        path: PathBuf,
        /// The step.
        done: usize,
        /// Its size (s).
        there: f64,
        /// The size that it would have now (s).
        here: f64,
        /// End of the run that wrote it (s).
        end: f64,
    },
    /// The state in it does not fit the scene or makes no sense.
    #[error("the checkpoint `{}`: {source}", path.display())]
    State {
        /// The file asked for.
        path: PathBuf,
        /// What is wrong with it.
        source: RestoreError,
    },
}
