//! The step loop.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::Progress;
use super::critical_step;
use super::error::RunError;
use super::limits::remedy;
use super::loads::forcing;
use super::particle_table::particle_table;
use super::schedule::Schedule;
use crate::output::Folder;
use crate::scene::{ParticleOutput, Scene};
use crate::stepper::Simulation;

/// Energy is sampled this often in a run: often enough to see it grow, seldom enough to cost nothing.
pub(super) const ENERGY_SAMPLES: usize = 1000;

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

/// Steps `simulation` to the end, writing particles when the scene asks for it, and sampling the energy `samples` times.
pub(super) fn march(
    scene: &Scene,
    simulation: &mut dyn Simulation<1>,
    schedule: &Schedule,
    samples: usize,
    folder: Option<&Folder>,
    files: &mut Vec<PathBuf>,
    progress: &mut dyn FnMut(Progress),
) -> Result<March, RunError> {
    let mut march = March::default();
    march.energy.sample(simulation.energy().total());
    let steps = schedule.steps;
    let sample_every = steps.div_ceil(samples.max(1)).max(1);
    let mut begun = Instant::now();
    for step in 0..steps {
        let dt = schedule.size(step);
        let forcing = forcing(scene, schedule.time(step), dt)?;
        if let Err(source) = simulation.step(dt, &forcing) {
            let limit = critical_step(scene).ok().flatten();
            return Err(RunError::Stopped {
                source,
                dt,
                critical: limit.map(|limit| limit.step),
                remedy: limit.map_or("", |limit| remedy(limit.mechanism)),
            });
        }
        let done = step + 1;
        let writes = scene.output.every > 0 && done % scene.output.every == 0 && done < steps;
        if done % sample_every == 0 || done == steps || writes {
            // The clock runs for the step loop only.
            march.wall += begun.elapsed();
            march.energy.sample(simulation.energy().total());
            if let (true, ParticleOutput::Csv, Some(folder)) = (writes, scene.output.particles, folder) {
                let name = format!("particles-{done:08}.csv");
                let table = particle_table(scene, &simulation.particles(), &simulation.liquid());
                files.push(table.write_csv(folder, &name)?);
            }
            progress(Progress { step: done, steps });
            begun = Instant::now();
        }
    }
    Ok(march)
}
