//! Running a scene.

mod checkpoint;
mod dispatch;
mod error;
mod fields;
mod frames;
mod history_law;
mod initial;
mod limits;
mod loads;
mod march;
mod method_warnings;
mod norms;
mod particle_table;
mod rate_law;
mod reference;
mod schedule;
mod space;
mod state;
mod summary;
mod surface;

pub use checkpoint::CheckpointError;
pub use error::RunError;
pub use fields::FieldValues;
pub use limits::mechanism;
pub use method_warnings::method_warnings;
pub use norms::{ErrorNorms, Exact};
pub use space::InSpace;
pub use summary::{ConservationSummary, EnergySummary, MethodSummary, Summary};

use std::path::{Path, PathBuf};

use checkpoint::Checkpoint;
use frames::Frames;
use loads::forcing;
use march::{ENERGY_SAMPLES, Journey, Milestone, march};
use schedule::Schedule;

use crate::output::Folder;
use crate::particles::Particles;
use crate::phase::PoreLiquid;
use crate::scene::Scene;
use crate::stepper::{CriticalStep, Simulation};

/// How far a run has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Steps taken.
    pub step: usize,
    /// Steps to take.
    pub steps: usize,
}

/// What a run in `D` dimensions leaves behind.
#[derive(Debug)]
pub struct Outcome<const D: usize = 1> {
    /// Figures of the run.
    pub summary: Summary,
    /// Particles at the end.
    pub particles: Particles<f64, D>,
    /// Their liquid; empty in one phase.
    pub liquid: Vec<PoreLiquid<f64, D>>,
    /// Reference at the particles; empty without one.
    pub exact: Exact,
    /// Files written.
    pub files: Vec<PathBuf>,
}

impl<const D: usize> Outcome<D> {
    /// Every field at the particles, with its reference.
    pub fn fields(&self) -> Vec<FieldValues> {
        fields::fields(&self.particles, &self.liquid, &self.exact)
    }

    /// The same one by one: of many particles there need not be all fields at a time.
    pub fn for_each_field(&self, f: impl FnMut(FieldValues)) {
        fields::for_each_field(&self.particles, &self.liquid, &self.exact, f);
    }
}

/// Runs a `scene` of one dimension, writing particles to `folder` if there is one, and calls `progress` now and then.
///
/// # Errors
/// See [`RunError`]. Files written before the error stay.
pub fn run(
    scene: &Scene,
    folder: Option<&Folder>,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, RunError> {
    run_in::<1>(scene, folder, progress)
}

/// [`run`] in `D` dimensions, which are those of the scene.
///
/// # Errors
/// See [`RunError`]. Files written before the error stay.
pub fn run_in<const D: usize>(
    scene: &Scene,
    folder: Option<&Folder>,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome<D>, RunError>
where
    Scene: InSpace<D>,
{
    run_from(scene, None, folder, progress)
}

/// Goes on with a run of `scene` where it was when the file `checkpoint` was written, and ends as the run would have that was
/// never interrupted: with the same numbers to the bit, and the same files if `folder` is the same.
///
/// The checkpoint must be of this scene; only title, output and, if the step is given as a number, the end may differ. A later
/// end makes the run longer; the range of the energy then knows the earlier part by the samples that were taken there. A
/// checkpoint of the last step leaves nothing to do but to write the files of the end. The speed in the summary is that of the
/// steps taken now.
///
/// # Errors
/// See [`RunError`]; [`CheckpointError`] says why the file does not serve. Files written before the error stay.
pub fn resume_in<const D: usize>(
    scene: &Scene,
    checkpoint: &Path,
    folder: Option<&Folder>,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome<D>, RunError>
where
    Scene: InSpace<D>,
{
    run_from(scene, Some(checkpoint), folder, progress)
}

fn run_from<const D: usize>(
    scene: &Scene,
    checkpoint: Option<&Path>,
    folder: Option<&Folder>,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome<D>, RunError>
where
    Scene: InSpace<D>,
{
    check_dimension::<D>(scene)?;
    // Before the run's own simulation is there: the critical step takes one as large.
    let schedule = Schedule::new(scene)?;
    let open = |path: &Path| Checkpoint::open(path, scene, &schedule);
    let checkpoint = checkpoint.map(open).transpose()?;
    let mut warnings = limits::warnings(scene, &schedule, || critical_step_in(scene))?;
    let mut simulation = scene.build(schedule.dt)?;
    let (from, written) = match checkpoint {
        Some(checkpoint) => checkpoint.restore(simulation.as_mut())?,
        None => (Milestone::default(), Vec::new()),
    };
    let mut frames = Frames::new(scene, folder, written);
    warnings.extend(frames.warning());
    let journey = Journey {
        scene,
        schedule: &schedule,
        samples: ENERGY_SAMPLES,
        from,
    };
    let march = march(&journey, simulation.as_mut(), &mut frames, progress)?;
    let mut summary = Summary::new(scene, simulation.as_ref(), &schedule, &march);
    summary.warnings = warnings;
    let (particles, liquid) = simulation.into_particles();
    frames.write(None, schedule.end, &particles, &liquid)?;
    let exact = scene.exact(&particles, &schedule)?;
    summary.errors = ErrorNorms::all(&particles, &liquid, &exact);
    let mut files = frames.files;
    files.extend(march.checkpoint);
    Ok(Outcome {
        summary,
        particles,
        liquid,
        exact,
        files,
    })
}

fn check_dimension<const D: usize>(scene: &Scene) -> Result<(), RunError> {
    match scene.dimension() {
        found if found == D => Ok(()),
        found => Err(RunError::Dimension { found, expected: D }),
    }
}

/// Calls a function of the dimension, `f::<D>(arguments)`, with that of the scene.
macro_rules! in_dimension {
    ($scene:expr, $f:ident($($argument:expr),* $(,)?)) => {
        match $scene.dimension() {
            1 => $f::<1>($($argument),*),
            2 => $f::<2>($($argument),*),
            _ => $f::<3>($($argument),*),
        }
    };
}
pub(crate) use in_dimension;

/// Time (s) that the steps of `scene` take, and nothing else: no file, no energy on the way, no errors.
///
/// # Errors
/// See [`RunError`].
pub fn step_loop_seconds(scene: &Scene) -> Result<f64, RunError> {
    in_dimension!(scene, step_loop_seconds_in(scene))
}

fn step_loop_seconds_in<const D: usize>(scene: &Scene) -> Result<f64, RunError>
where
    Scene: InSpace<D>,
{
    let schedule = Schedule::new(scene)?;
    let mut simulation = scene.build(schedule.dt)?;
    let mut frames = Frames::new(scene, None, Vec::new());
    let journey = Journey {
        scene,
        schedule: &schedule,
        samples: 1,
        from: Milestone::default(),
    };
    let march = march(&journey, simulation.as_mut(), &mut frames, &mut |_| {})?;
    Ok(march.wall.as_secs_f64())
}

/// Largest stable time step (s) of the scene's initial layout; `None` if nothing resists a motion.
///
/// # Errors
/// If the scene cannot be set up.
pub fn critical_step(scene: &Scene) -> Result<Option<CriticalStep<f64>>, RunError> {
    in_dimension!(scene, critical_step_in(scene))
}

fn critical_step_in<const D: usize>(scene: &Scene) -> Result<Option<CriticalStep<f64>>, RunError>
where
    Scene: InSpace<D>,
{
    // Only which faces are held matters, not how they move.
    Ok(scene.build(0.0)?.into_critical_step(&forcing(scene, 0.0, 1.0)?))
}

/// A freshly built simulation of a scene of one dimension, to look at or to step by hand.
///
/// # Errors
/// If the scene cannot be set up.
pub fn simulation(scene: &Scene) -> Result<Box<dyn Simulation<1>>, RunError> {
    simulation_in(scene)
}

/// [`simulation`] in `D` dimensions, which are those of the scene.
///
/// # Errors
/// If the scene cannot be set up.
pub fn simulation_in<const D: usize>(scene: &Scene) -> Result<Box<dyn Simulation<D>>, RunError>
where
    Scene: InSpace<D>,
{
    check_dimension::<D>(scene)?;
    scene.build(0.0)
}
