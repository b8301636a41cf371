//! Running a scene.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use thiserror::Error;

use super::dispatch::build;
use super::loads::forcing;
use super::norms::{ErrorNorms, Exact};
use super::particle_table::particle_table;
use super::schedule::Schedule;
use super::summary::Summary;
use super::{ExpressionError, ParticleOutput, Scene};
use crate::error::{GridError, SetupError, StepError};
use crate::method::Method;
use crate::output::{Folder, OutputError};
use crate::particles::Particles;
use crate::reference::ReferenceError;
use crate::stepper::Simulation;

/// Energy is sampled this often in a run: often enough to see it grow, seldom enough to cost nothing.
const ENERGY_SAMPLES: usize = 1000;

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
    /// No such combination of basis and reconstruction.
    #[error("method {0} does not exist")]
    NoSuchMethod(Method),
    /// `step = "auto"` on particles that nothing resists.
    #[error(
        "time.step = \"auto\": nothing resists a motion of these particles, so no step is critical; give a number"
    )]
    NoCriticalStep,
    /// The run stopped on the way.
    #[error("{source}; {}", advice(*dt, *critical))]
    Stopped {
        /// What happened, at which step, to which particle.
        source: StepError,
        /// Time step of the run (s).
        dt: f64,
        /// Largest stable step of the initial layout (s), if it could be found.
        critical: Option<f64>,
    },
}

fn advice(dt: f64, critical: Option<f64>) -> String {
    match critical {
        Some(limit) if dt > limit => format!(
            "the run is unstable: time.step = {dt:.3e} s is above the largest stable step, {limit:.3e} s, so take a smaller one or \"auto\""
        ),
        Some(limit) => format!(
            "time.step = {dt:.3e} s is within the largest stable step of the initial layout, {limit:.3e} s, so look at the loads, the grid's extent and the method"
        ),
        None => format!("time.step = {dt:.3e} s; look at the loads and the grid's extent"),
    }
}

/// How far a run has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Steps taken.
    pub step: usize,
    /// Steps to take.
    pub steps: usize,
}

/// What a run leaves behind.
#[derive(Debug)]
pub struct Outcome {
    /// Figures of the run.
    pub summary: Summary,
    /// Particles at the end.
    pub particles: Particles<f64, 1>,
    /// Reference at the particles: displacement (m), velocity (m/s), stress (Pa); empty without one.
    pub exact: Exact,
    /// Files written.
    pub files: Vec<PathBuf>,
}

/// Runs `scene`, writing particles to `folder` if there is one, and calls `progress` now and then.
///
/// # Errors
/// See [`RunError`]. Files written before the error stay.
pub fn run(
    scene: &Scene,
    folder: Option<&Folder>,
    progress: &mut dyn FnMut(Progress),
) -> Result<Outcome, RunError> {
    let mut simulation = build(scene)?;
    let schedule = Schedule::new(scene, simulation.as_ref())?;
    let mut files = Vec::new();
    let march = march(
        scene,
        simulation.as_mut(),
        &schedule,
        folder,
        &mut files,
        progress,
    )?;
    let particles = simulation.particles();
    if let (ParticleOutput::Csv, Some(folder)) = (scene.output.particles, folder) {
        files.push(particle_table(&particles).write_csv(folder, "particles.csv")?);
    }
    let exact = Exact::of(scene, &particles, &schedule)?;
    let norms = ErrorNorms::all(&particles, &exact);
    let summary = Summary::new(scene, simulation.as_ref(), &schedule, march, norms);
    Ok(Outcome {
        summary,
        particles,
        exact,
        files,
    })
}

/// Largest stable time step (s) of the scene's initial layout; `None` if nothing resists a motion.
///
/// # Errors
/// If the scene cannot be set up.
pub fn critical_step(scene: &Scene) -> Result<Option<f64>, RunError> {
    let simulation = build(scene)?;
    // Only which faces are held matters, not how they move.
    Ok(simulation.critical_step(&forcing(scene, 0.0, 1.0)?))
}

/// A freshly built simulation of the scene, to look at or to step by hand.
///
/// # Errors
/// If the scene cannot be set up.
pub fn simulation(scene: &Scene) -> Result<Box<dyn Simulation<1>>, RunError> {
    build(scene)
}

/// Figures gathered along the way.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct March {
    pub(super) wall: Duration,
    pub(super) energy: EnergyRange,
}

/// Total energy at the start, at the end, and its range.
#[derive(Clone, Copy, Debug)]
pub(super) struct EnergyRange {
    pub(super) initial: f64,
    pub(super) last: f64,
    pub(super) highest: f64,
    pub(super) lowest: f64,
}

impl Default for EnergyRange {
    fn default() -> Self {
        Self {
            initial: f64::NAN,
            last: f64::NAN,
            highest: f64::NEG_INFINITY,
            lowest: f64::INFINITY,
        }
    }
}

impl EnergyRange {
    fn sample(&mut self, energy: f64) {
        if self.initial.is_nan() {
            self.initial = energy;
        }
        self.last = energy;
        self.highest = self.highest.max(energy);
        self.lowest = self.lowest.min(energy);
    }
}

fn march(
    scene: &Scene,
    simulation: &mut dyn Simulation<1>,
    schedule: &Schedule,
    folder: Option<&Folder>,
    files: &mut Vec<PathBuf>,
    progress: &mut dyn FnMut(Progress),
) -> Result<March, RunError> {
    let mut march = March::default();
    march.energy.sample(simulation.energy().total());
    let steps = schedule.steps;
    let sample_every = steps.div_ceil(ENERGY_SAMPLES).max(1);
    let mut begun = Instant::now();
    for step in 0..steps {
        let dt = schedule.size(step);
        let forcing = forcing(scene, schedule.time(step), dt)?;
        if let Err(source) = simulation.step(dt, &forcing) {
            let critical = critical_step(scene).ok().flatten();
            return Err(RunError::Stopped { source, dt, critical });
        }
        let done = step + 1;
        let writes = scene.output.every > 0 && done % scene.output.every == 0 && done < steps;
        if done % sample_every == 0 || done == steps || writes {
            // The clock runs for the step loop only.
            march.wall += begun.elapsed();
            march.energy.sample(simulation.energy().total());
            if let (true, ParticleOutput::Csv, Some(folder)) = (writes, scene.output.particles, folder) {
                let name = format!("particles-{done:08}.csv");
                let table = particle_table(&simulation.particles());
                files.push(table.write_csv(folder, &name)?);
            }
            progress(Progress { step: done, steps });
            begun = Instant::now();
        }
    }
    Ok(march)
}
