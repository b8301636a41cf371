//! Running a scene.

mod dispatch;
mod error;
mod fields;
mod initial;
mod limits;
mod loads;
mod march;
mod norms;
mod particle_table;
mod rate_law;
mod reference;
mod schedule;
mod state;
mod summary;
mod surface;

pub use error::RunError;
pub use fields::FieldValues;
pub use limits::mechanism;
pub use norms::{ErrorNorms, Exact};
pub use summary::{ConservationSummary, EnergySummary, MethodSummary, Summary};

use std::path::PathBuf;

use dispatch::build;
use loads::forcing;
use march::march;
use particle_table::particle_table;
use schedule::Schedule;

use crate::output::Folder;
use crate::particles::Particles;
use crate::phase::PoreLiquid;
use crate::scene::{ParticleOutput, Scene};
use crate::stepper::{CriticalStep, Simulation};

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
    /// Their liquid; empty in one phase.
    pub liquid: Vec<PoreLiquid<f64, 1>>,
    /// Reference at the particles; empty without one.
    pub exact: Exact,
    /// Files written.
    pub files: Vec<PathBuf>,
}

impl Outcome {
    /// Every field at the particles, with its reference.
    pub fn fields(&self) -> Vec<FieldValues> {
        fields::fields(&self.particles, &self.liquid, &self.exact)
    }
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
    let critical = || Ok(simulation.critical_step(&forcing(scene, 0.0, 1.0)?));
    let warnings = limits::warnings(scene, &schedule, critical)?;
    let mut files = Vec::new();
    let march = march(
        scene,
        simulation.as_mut(),
        &schedule,
        folder,
        &mut files,
        progress,
    )?;
    if let (ParticleOutput::Csv, Some(folder)) = (scene.output.particles, folder) {
        files.push(particle_table(scene, simulation.as_ref()).write_csv(folder, "particles.csv")?);
    }
    let (particles, liquid) = (simulation.particles(), simulation.liquid());
    let exact = Exact::of(scene, &particles, &schedule)?;
    let norms = ErrorNorms::all(&fields::fields(&particles, &liquid, &exact));
    let mut summary = Summary::new(scene, simulation.as_ref(), &schedule, march, norms);
    summary.warnings = warnings;
    Ok(Outcome {
        summary,
        particles,
        liquid,
        exact,
        files,
    })
}

/// Largest stable time step (s) of the scene's initial layout; `None` if nothing resists a motion.
///
/// # Errors
/// If the scene cannot be set up.
pub fn critical_step(scene: &Scene) -> Result<Option<CriticalStep<f64>>, RunError> {
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
