//! Checkpoints: all that a run needs to go on where it was, in one file.
//!
//! A checkpoint holds the scene as far as it makes the numbers, the steps, how far the run is with the range
//! of its energy, the frames written so far, and the simulation's state to the bit ([`Simulation::save`]).
//! Frames that were written after it are written again by the resumed run, under the same names and with the
//! same bits.

mod error;
mod file;
mod identity;

pub use error::CheckpointError;

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use super::frames::Frames;
use super::march::{EnergyRange, Milestone};
use super::schedule::Schedule;
use crate::output::{OutputError, SeriesFrame};
use crate::scene::{Scene, StepSize};
use file::{Content, Sealed};
use identity::{Difference, difference, identity};
use materialpoint::error::RestoreError;
use materialpoint::stepper::{CriticalStep, Mechanism, Simulation};

/// Name of the file in the output folder.
const NAME: &str = "checkpoint.mpm";

/// Writes a checkpoint to the folder of `frames`, if there is one, in place of the one before; returns where
/// it is.
///
/// # Errors
/// Those of the folder; the checkpoint before is then as it was.
pub(super) fn write<const D: usize>(
    (scene, schedule): (&Scene, &Schedule),
    milestone: &Milestone,
    frames: &Frames<'_>,
    simulation: &dyn Simulation<D>,
) -> Result<Option<PathBuf>, OutputError> {
    let Some(folder) = frames.folder() else {
        return Ok(None);
    };
    let path = folder.write_with(NAME, |out| {
        let mut out = Sealed::new(out)?;
        put_text(&mut out, &identity(scene))?;
        put_schedule(&mut out, schedule)?;
        put_milestone(&mut out, milestone)?;
        put_frames(&mut out, frames.written())?;
        simulation.save(&mut out)?;
        out.finish()
    })?;
    Ok(Some(path))
}

/// A checkpoint of the very scene, opened as far as the state of its simulation.
pub(super) struct Checkpoint {
    path: PathBuf,
    content: Content,
    schedule: Schedule,
    milestone: Milestone,
    frames: Vec<SeriesFrame>,
}

impl Checkpoint {
    /// Opens the file at `path` to resume a run of `scene`.
    ///
    /// # Errors
    /// If the file is none, is damaged or belongs to another run.
    pub(super) fn open(path: &Path, scene: &Scene) -> Result<Self, CheckpointError> {
        let mut content = file::open(path)?;
        let read = |source: io::Error| CheckpointError::Read {
            path: path.into(),
            source,
        };
        let there = take_text(&mut content).map_err(read)?;
        if let Some(Difference { key, there, here }) = difference(&there, &identity(scene)) {
            return Err(CheckpointError::OtherScene {
                path: path.into(),
                key: key.into(),
                there: there.into(),
                here: here.into(),
            });
        }
        let past = take_schedule(&mut content).map_err(read)?;
        let milestone = take_milestone(&mut content).map_err(read)?;
        if !past.makes_sense(scene, milestone.done) {
            return Err(CheckpointError::Damaged {
                path: path.into(),
                problem: "its steps make no sense",
            });
        }
        // Automatic steps go on as they were; the end is that of then.
        let schedule = match scene.time.step {
            StepSize::Fixed(_) => past.with_end(scene.time.end),
            StepSize::Auto { .. } => past,
        };
        check_steps(path, milestone.done, &past, &schedule)?;
        let frames = take_frames(&mut content).map_err(read)?;
        Ok(Self {
            path: path.into(),
            content,
            schedule,
            milestone,
            frames,
        })
    }

    /// The steps of the run.
    pub(super) fn schedule(&self) -> Schedule {
        self.schedule
    }

    /// Gives `simulation` the state; returns how far the run is and the frames written so far.
    ///
    /// # Errors
    /// If the state does not fit; `simulation` is then of no further use.
    pub(super) fn restore<const D: usize>(
        mut self,
        simulation: &mut dyn Simulation<D>,
    ) -> Result<(Milestone, Vec<SeriesFrame>), CheckpointError> {
        let state = |source| CheckpointError::State {
            path: self.path.clone(),
            source,
        };
        simulation.restore(&mut self.content).map_err(state)?;
        let rest = io::copy(&mut self.content, &mut io::sink());
        match rest.map_err(|error| state(RestoreError::Read(error)))? {
            0 => Ok((self.milestone, self.frames)),
            _ => Err(CheckpointError::Damaged {
                path: self.path,
                problem: "it is longer than the state of its simulation",
            }),
        }
    }
}

/// Refuses a checkpoint whose steps are not those that this run would have taken.
fn check_steps(path: &Path, done: usize, past: &Schedule, now: &Schedule) -> Result<(), CheckpointError> {
    let path = || path.to_owned();
    if done > now.steps {
        return Err(CheckpointError::Beyond {
            path: path(),
            done,
            steps: now.steps,
        });
    }
    // Only the last of the steps taken may be the last of a run, which ends on time.
    let last = done.saturating_sub(1);
    let (there, here) = (past.size(last), now.size(last));
    if there.to_bits() != here.to_bits() {
        return Err(CheckpointError::LastStep {
            path: path(),
            done,
            there,
            here,
            end: past.end,
        });
    }
    Ok(())
}

fn put_schedule(out: &mut impl Write, schedule: &Schedule) -> io::Result<()> {
    let Schedule {
        steps,
        dt,
        end,
        since: (first, start),
        before,
        range: [least, most],
        stiffness,
        limit,
        exceeded: (when, stable),
    } = *schedule;
    put_count(out, steps)?;
    put_count(out, first)?;
    let numbers = [dt, end, start, before, least, most, stiffness, when];
    numbers
        .into_iter()
        .try_for_each(|number| put_number(out, number))?;
    put_limit(out, limit)?;
    put_limit(out, stable)
}

fn put_limit(out: &mut impl Write, limit: CriticalStep<f64>) -> io::Result<()> {
    put_number(out, limit.step)?;
    let mechanism = match limit.mechanism {
        Mechanism::Wave => 0,
        Mechanism::Drag => 1,
        Mechanism::Diffusion => 2,
    };
    put_count(out, mechanism)
}

fn take_limit(from: &mut impl Read) -> io::Result<CriticalStep<f64>> {
    Ok(CriticalStep {
        step: take_number(from)?,
        mechanism: match take_count(from)? {
            0 => Mechanism::Wave,
            1 => Mechanism::Drag,
            _ => Mechanism::Diffusion,
        },
    })
}

fn take_schedule(from: &mut impl Read) -> io::Result<Schedule> {
    let (steps, first) = (take_count(from)?, take_count(from)?);
    let mut numbers = [0.0; 8];
    for number in &mut numbers {
        *number = take_number(from)?;
    }
    let [dt, end, start, before, least, most, stiffness, when] = numbers;
    Ok(Schedule {
        steps,
        dt,
        end,
        since: (first, start),
        before,
        range: [least, most],
        stiffness,
        limit: take_limit(from)?,
        exceeded: (when, take_limit(from)?),
    })
}

fn put_milestone(out: &mut impl Write, milestone: &Milestone) -> io::Result<()> {
    let Milestone { done, energy } = milestone;
    put_count(out, *done)?;
    let energies = [energy.initial, energy.last, energy.highest, energy.lowest];
    energies
        .into_iter()
        .try_for_each(|energy| put_number(out, energy))
}

fn take_milestone(from: &mut impl Read) -> io::Result<Milestone> {
    Ok(Milestone {
        done: take_count(from)?,
        energy: EnergyRange {
            initial: take_number(from)?,
            last: take_number(from)?,
            highest: take_number(from)?,
            lowest: take_number(from)?,
        },
    })
}

fn put_frames(out: &mut impl Write, frames: &[SeriesFrame]) -> io::Result<()> {
    put_count(out, frames.len())?;
    for SeriesFrame { time, file } in frames {
        put_number(out, *time)?;
        put_text(out, file)?;
    }
    Ok(())
}

fn take_frames(from: &mut impl Read) -> io::Result<Vec<SeriesFrame>> {
    let count = take_count(from)?;
    let mut frames = Vec::new();
    // Room is made as frames come: a count alone asks for nothing.
    for _ in 0..count {
        let time = take_number(from)?;
        let file = take_text(from)?;
        frames.push(SeriesFrame { time, file });
    }
    Ok(frames)
}

fn put_count(out: &mut impl Write, value: usize) -> io::Result<()> {
    out.write_all(&(value as u64).to_le_bytes())
}

fn take_count(from: &mut impl Read) -> io::Result<usize> {
    let mut bytes = [0; 8];
    from.read_exact(&mut bytes)?;
    let refused = |_| io::Error::new(io::ErrorKind::InvalidData, "a count is too large");
    usize::try_from(u64::from_le_bytes(bytes)).map_err(refused)
}

fn put_number(out: &mut impl Write, value: f64) -> io::Result<()> {
    out.write_all(&value.to_le_bytes())
}

fn take_number(from: &mut impl Read) -> io::Result<f64> {
    let mut bytes = [0; 8];
    from.read_exact(&mut bytes)?;
    Ok(f64::from_le_bytes(bytes))
}

fn put_text(out: &mut impl Write, text: &str) -> io::Result<()> {
    put_count(out, text.len())?;
    out.write_all(text.as_bytes())
}

/// Room is made as bytes come: a length alone asks for nothing.
fn take_text(from: &mut impl Read) -> io::Result<String> {
    let length = take_count(from)?;
    let mut text = String::new();
    match from.take(length as u64).read_to_string(&mut text)? {
        found if found == length => Ok(text),
        _ => Err(io::ErrorKind::UnexpectedEof.into()),
    }
}

#[cfg(test)]
mod tests;
