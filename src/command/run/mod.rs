//! Running a scene.

mod checkpoint;
mod dispatch;
mod error;
mod fields;
mod frames;
mod initial;
mod invariants;
mod limits;
mod loads;
mod march;
mod method_warnings;
mod norms;
mod particle_cloud;
mod particle_fields;
mod particle_table;
mod reference;
mod schedule;
mod space;
mod state;
mod summary;
mod surface;
mod warnings;

pub use checkpoint::CheckpointError;
pub use error::RunError;
pub use fields::FieldValues;
pub use invariants::Invariants;
pub use limits::{EnergyGain, mechanism};
pub use norms::{ErrorNorms, Exact};
pub use space::InSpace;
pub use summary::{ConservationSummary, EnergySummary, MethodSummary, Summary};

use std::path::{Path, PathBuf};

use checkpoint::Checkpoint;
use frames::{Frames, Moment};
use loads::forcing;
use march::{Milestone, RunPlan, energy_samples, march};
use particle_fields::Snapshot;
use schedule::Schedule;

use crate::output::Folder;
use crate::scene::Scene;
use materialpoint::particles::Particles;
use materialpoint::phase::PoreLiquid;
use materialpoint::stepper::{CriticalStep, MaterialFields, Simulation};

/// How far a run has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Steps taken.
    pub step: usize,
    /// Steps to take, if they stay as they are: those of `step = "auto"` may change.
    pub steps: usize,
    /// Size (s) of the last step taken, or of the first one.
    pub dt: f64,
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
    /// What the law knows of them besides the stress.
    pub law: MaterialFields,
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

    /// Mean and von Mises stress of the particles, with the stress off the plane; none where the law does not
    /// know that, nor along one axis.
    pub fn invariants(&self) -> impl Iterator<Item = Invariants> {
        particle_fields::invariants(&self.particles.stress, &self.law)
    }
}

/// Runs a `scene` of one dimension, writing particles to `folder` if there is one, and calls `progress` now
/// and then.
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

/// Goes on with a run of `scene` where it was when the file `checkpoint` was written, and ends as the run
/// would have that was never interrupted: with the same numbers to the bit, and the same files if `folder` is
/// the same.
///
/// The checkpoint must be of this scene; only title, output and, if the step is given as a number, the end
/// may differ. A later end makes the run longer; the range of the energy then knows the earlier part by the
/// samples that were taken there. A checkpoint of the last step leaves nothing to do but to write the files
/// of the end. The speed in the summary is that of the steps taken now.
///
/// # Errors
/// See [`RunError`]; [`CheckpointError`] says why the file does not serve. Files written before the error
/// stay.
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
    let open = |path: &Path| Checkpoint::open(path, scene);
    let (mut schedule, mut simulation, from, written);
    let checkpoint = checkpoint.map(open).transpose()?;
    let resumed = checkpoint.is_some();
    match checkpoint {
        Some(checkpoint) => {
            schedule = checkpoint.schedule();
            simulation = scene.build(schedule.dt)?;
            (from, written) = checkpoint.restore(simulation.as_mut())?;
        }
        None => {
            (schedule, simulation) = begin(scene)?;
            (from, written) = (Milestone::default(), Vec::new());
        }
    }
    let mut frames = Frames::new(scene, folder, written);
    if frames.are_wanted() {
        frames.bodies = initial::body_sizes::<D>(scene)?;
    }
    let removed = frames.clear(resumed);
    let missing = frames.warning();
    let plan = RunPlan {
        scene,
        samples: energy_samples(simulation.particle_count()),
        from,
    };
    let march = march(&plan, &mut schedule, simulation.as_mut(), &mut frames, progress)?;
    let mut summary = Summary::new(scene, simulation.as_ref(), &schedule, &march);
    summary.warnings = limits::warnings(scene, &schedule, summary.energy_gain(scene));
    summary.warnings.extend(warnings::warnings::<D>(scene)?);
    summary.warnings.extend(missing);
    let unsolved = simulation.diagnostics().unsolved_contacts;
    summary
        .warnings
        .extend(limits::unsolved_contacts(scene, unsolved));
    summary.removed = removed;
    let law = simulation.material_fields();
    let (particles, liquid) = simulation.into_particles();
    let snapshot = Snapshot {
        particles: &particles,
        liquid: &liquid,
        law: &law,
    };
    frames.write(Moment::end(scene, &schedule), &snapshot)?;
    let exact = scene.exact(&particles, &schedule)?;
    let strained = warnings::small_strain(scene, &particles, schedule.dt)?;
    summary.warnings.extend(strained);
    summary.errors = ErrorNorms::all(&particles, &liquid, &exact);
    let mut files = frames.files;
    files.extend(march.checkpoint);
    Ok(Outcome {
        summary,
        particles,
        liquid,
        law,
        exact,
        files,
    })
}

/// The steps of a run from its start, and the simulation that takes them.
fn begin<const D: usize>(scene: &Scene) -> Result<(Schedule, Box<dyn Simulation<D>>), RunError>
where
    Scene: InSpace<D>,
{
    let mut simulation = scene.build(0.0)?;
    let schedule = Schedule::new(scene, simulation.as_mut())?;
    // Velocities of a driven run start half a step early.
    let simulation = match scene.driver()? {
        Some(_) => {
            drop(simulation);
            scene.build(schedule.dt)?
        }
        None => simulation,
    };
    Ok((schedule, simulation))
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
    let (mut schedule, mut simulation) = begin(scene)?;
    let mut frames = Frames::new(scene, None, Vec::new());
    let plan = RunPlan {
        scene,
        samples: 1,
        from: Milestone::default(),
    };
    let march = march(
        &plan,
        &mut schedule,
        simulation.as_mut(),
        &mut frames,
        &mut |_| {},
    )?;
    Ok(march.wall.as_secs_f64())
}

/// What a user should know of a scene before it runs, besides its step; a run says it too.
///
/// # Errors
/// See [`RunError`].
pub fn warnings(scene: &Scene) -> Result<Vec<String>, RunError> {
    let mut found = limits::of_method(scene);
    found.extend(in_dimension!(scene, warnings_in(scene))?);
    Ok(found)
}

fn warnings_in<const D: usize>(scene: &Scene) -> Result<Vec<String>, RunError>
where
    Scene: InSpace<D>,
{
    warnings::warnings::<D>(scene)
}

/// A stable step, and how far that is sure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableStep {
    /// The step.
    pub limit: CriticalStep<f64>,
    /// Whether it is proved for the layout; otherwise it was found by iteration on a sample of the particles.
    pub proved: bool,
}

/// A step (s) that is stable in the scene's initial layout with the particles' own speeds, by
/// [`Stepper::stiffness`](materialpoint::stepper::Stepper::stiffness): what an automatic step takes its share
/// of. `None` if nothing resists a motion.
///
/// # Errors
/// If the scene cannot be set up.
pub fn stable_step(scene: &Scene) -> Result<Option<StableStep>, RunError> {
    in_dimension!(scene, stable_step_in(scene))
}

fn stable_step_in<const D: usize>(scene: &Scene) -> Result<Option<StableStep>, RunError>
where
    Scene: InSpace<D>,
{
    let mut simulation = scene.build(0.0)?;
    let proved = simulation.stiffness_is_bound();
    let stiffness = simulation.stiffness(&forcing(scene, 0.0, scene.time.end)?);
    let limit = stiffness.and_then(|stiffness| simulation.largest_step(stiffness));
    Ok(limit.map(|limit| StableStep { limit, proved }))
}

/// Largest stable time step (s) of the scene's initial layout, by power iteration on all particles; `None` if
/// nothing resists a motion.
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
    Ok(scene
        .build(0.0)?
        .into_critical_step(&forcing(scene, 0.0, scene.time.end)?))
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
