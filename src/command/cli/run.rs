//! `materialpoint run`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use materialpoint_command::output::Folder;
use materialpoint_command::run::{
    EnergyGain, InSpace, Outcome, Progress, RunError, Summary, resume_in, run_in, warnings,
};
use materialpoint_command::scene::{Scene, SceneError};
use materialpoint_command::study::{write_fields, write_maps};

use super::Shared;
use super::bar::bar;
use super::failure::Failure;
use super::pace::Pace;
use super::print::{print, print_json};

/// The scene in the file `name`, or the compiled-in one of that name.
pub(super) fn load(name: &str, set: &[String]) -> Result<Scene, SceneError> {
    let path = Path::new(name);
    match Scene::builtin(name) {
        Some(text) if !path.exists() => Scene::from_toml(text, set),
        _ => Scene::from_file(path, set),
    }
}

pub(super) fn run_scene(name: &str, resume: Option<&Path>, shared: &Shared) -> Result<(), Failure> {
    let scene = load(name, &shared.set)?;
    let folder = Folder::create(&shared.out)?;
    let progress_bar = bar(shared.quiet, 0, "steps");
    let mut pace = Pace::new();
    let mut progress = |progress: Progress| {
        progress_bar.set_length(progress.steps as u64);
        progress_bar.set_position(progress.step as u64);
        if pace.is_at_start() {
            // The time before the first step is none of the steps'.
            progress_bar.reset_eta();
        }
        if let Some(warning) = pace.warning(&progress, Instant::now()) {
            progress_bar.suspend(|| warn(&[warning]));
        }
    };
    let begin = Begin {
        scene: &scene,
        resume,
        folder: &folder,
    };
    let done = match scene.dimension() {
        1 => on_one_axis(&begin, &mut progress),
        2 => in_space::<2>(&begin, &mut progress),
        _ => in_space::<3>(&begin, &mut progress),
    };
    progress_bar.finish_and_clear();
    if let Err(Failure::Stopped(_)) = done {
        // What was said of the scene is not lost with the summary: it may be why.
        warn(&warnings(&scene)?);
    }
    let (summary, files) = done?;
    let gain = summary.energy_gain(&scene).filter(EnergyGain::is_large);
    match gain {
        // It is what the command ends with.
        Some(gain) => warn(
            summary
                .warnings
                .iter()
                .filter(|warning| **warning != gain.to_string()),
        ),
        None => warn(&summary.warnings),
    }
    match shared.json {
        true => print_json(&summary)?,
        false => print(&summary_text(&summary, &files))?,
    }
    gain.map_or(Ok(()), |gain| Err(Failure::Stopped(gain.to_string())))
}

/// What is run, from where, and where its files go.
struct Begin<'a> {
    scene: &'a Scene,
    resume: Option<&'a Path>,
    folder: &'a Folder,
}

impl Begin<'_> {
    fn run<const D: usize>(&self, progress: &mut dyn FnMut(Progress)) -> Result<Outcome<D>, RunError>
    where
        Scene: InSpace<D>,
    {
        match self.resume {
            None => run_in(self.scene, Some(self.folder), progress),
            Some(checkpoint) => resume_in(self.scene, checkpoint, Some(self.folder), progress),
        }
    }
}

type Done = Result<(Summary, Vec<PathBuf>), Failure>;

fn on_one_axis(begin: &Begin<'_>, progress: &mut dyn FnMut(Progress)) -> Done {
    let mut outcome = begin.run::<1>(progress)?;
    outcome.files.push(write_fields(&outcome, begin.folder)?);
    Ok((outcome.summary, outcome.files))
}

fn in_space<const D: usize>(begin: &Begin<'_>, progress: &mut dyn FnMut(Progress)) -> Done
where
    Scene: InSpace<D>,
{
    let mut outcome = begin.run::<D>(progress)?;
    outcome
        .files
        .push(write_maps(begin.scene, &outcome, begin.folder)?);
    Ok((outcome.summary, outcome.files))
}

/// Warnings go to standard error, so that standard output stays what was asked for.
pub(super) fn warn<'a>(warnings: impl IntoIterator<Item = &'a String>) {
    for warning in warnings {
        eprintln!("materialpoint: warning: {warning}");
    }
}

/// The summary for people.
fn summary_text(summary: &Summary, files: &[PathBuf]) -> String {
    let Summary {
        title,
        method,
        particles,
        cells,
        dofs,
        steps,
        time,
        velocity_time,
        time_step,
        time_step_range,
        wall_seconds,
        particle_steps_per_second,
        bytes_per_particle,
        grid_crossings,
        reduced_cells,
        virtual_cells,
        errors,
        conservation,
        energy,
        warnings: _,
        removed,
    } = summary;
    let mut lines = vec![title.clone()];
    lines.push(format!(
        "  method        {} (degree {}) + {}{}, {} velocity mass, {} strain, {}{}",
        method.basis,
        method.degree,
        method.reconstruction,
        match method.subpoints {
            1 => String::new(),
            n => format!(" at {n} sub-points of each particle"),
        },
        method.velocity_mass,
        method.strain,
        method.scalar,
        if method.phases == 1 { "" } else { ", two phases" }
    ));
    lines.push(format!(
        "  model         {particles} particles, {cells} cells, {dofs} DOFs"
    ));
    lines.push(format!(
        "  time          {steps} steps of {time_step:.3e} s{} to {time:.6} s; velocities are those of \
         {velocity_time:.6e} s",
        match time_step_range {
            None => String::new(),
            Some([least, most]) => format!(" on average ({least:.3e} to {most:.3e} s)"),
        }
    ));
    lines.push(format!(
        "  speed         {wall_seconds:.3} s, {:.2} million particle steps per second, {bytes_per_particle:.0} bytes per particle",
        particle_steps_per_second / 1e6
    ));
    let lent = match virtual_cells {
        0 => String::new(),
        n => format!(", {n} with virtual points"),
    };
    lines.push(format!(
        "  crossings     {grid_crossings} of cell edges; at most {reduced_cells} cells a step fitted with fewer functions{lent}"
    ));
    let width = errors.keys().map(|field| field.len()).fold(13, usize::max);
    for (field, norms) in errors {
        // Nothing is relative to a reference that is zero.
        let relative = match norms.relative_l2.is_finite() {
            true => format!("relative L2 {:.3e}, ", norms.relative_l2),
            false => String::new(),
        };
        lines.push(format!(
            "  {field:<width$} error: {relative}RMS {:.3e}, largest {:.3e}",
            norms.rms, norms.max
        ));
    }
    for (phase, errors) in conservation {
        let impulse = errors.impulse.map_or(String::new(), |error| {
            format!(", change against impulse {error:.1e}")
        });
        lines.push(format!(
            "  {phase:<width$} conservation error: mass {:.1e}, momentum {:.1e} ({:.1e} of sum m|v|){impulse}",
            errors.mass, errors.momentum, errors.momentum_scaled
        ));
    }
    let unit = match method.dimension {
        1 => "J/m2",
        2 => "J/m",
        _ => "J",
    };
    match (energy.lowest_ratio, energy.highest_ratio) {
        (Some(lowest), Some(highest)) => lines.push(format!(
            "  energy        {:.6e} {unit} at the end; {lowest:.6} to {highest:.6} of the initial on the way",
            energy.last
        )),
        _ => lines.push(format!(
            "  energy        {:.6e} {unit} at the end; none at the start",
            energy.last
        )),
    }
    if let (Some(work), Some(gain)) = (energy.wall_work, energy.wall_gain) {
        lines.push(format!(
            "  walls         did {work:.6e} {unit} of work on the bodies, at most {gain:.1e} {unit} against friction in a step"
        ));
    }
    if let (Some(first), Some(last)) = (removed.first(), removed.last()) {
        lines.push(match removed.len() {
            1 => format!("  removed       {first} of a former run"),
            n => format!("  removed       {n} files of a former run, {first} to {last}"),
        });
    }
    for file in files {
        lines.push(format!("  wrote         {}", file.display()));
    }
    lines.join("\n") + "\n"
}
