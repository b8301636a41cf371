//! The step loop.

use std::time::{Duration, Instant};

use super::Progress;
use super::critical_step_in;
use super::error::RunError;
use super::frames::Frames;
use super::limits::remedy;
use super::loads::forcing;
use super::schedule::Schedule;
use super::space::InSpace;
use crate::scene::Scene;
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
    /// The energy is the error if it is not finite.
    fn sample(&mut self, energy: f64) -> Result<(), f64> {
        if !energy.is_finite() {
            return Err(energy);
        }
        if self.initial.is_nan() {
            self.initial = energy;
        }
        self.last = energy;
        self.highest = self.highest.max(energy);
        self.lowest = self.lowest.min(energy);
        Ok(())
    }
}

/// Steps `simulation` to the end, writing particles when the scene asks for it, and sampling the energy `samples` times.
pub(super) fn march<const D: usize>(
    scene: &Scene,
    simulation: &mut dyn Simulation<D>,
    schedule: &Schedule,
    samples: usize,
    frames: &mut Frames<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<March, RunError>
where
    Scene: InSpace<D>,
{
    let mut march = March::default();
    let start = march.energy.sample(simulation.energy().total());
    start.map_err(|value| RunError::NoEnergyAtStart { value })?;
    if frames.begin_at_start() {
        frames.write(Some(0), 0.0, &simulation.particles(), &simulation.liquid())?;
    }
    let steps = schedule.steps;
    let driver = scene.driver()?;
    let sample_every = steps.div_ceil(samples.max(1)).max(1);
    let mut begun = Instant::now();
    for step in 0..steps {
        let dt = schedule.size(step);
        let forcing = forcing(scene, schedule.time(step), dt)?;
        if let Some(driver) = &driver {
            simulation.set_body_forces(&|x| driver.body_force(x, schedule.time(step)));
        }
        if let Err(source) = simulation.step(dt, &forcing) {
            let (critical, remedy) = limit::<D>(scene);
            return Err(RunError::Stopped {
                source,
                dt,
                critical,
                remedy,
            });
        }
        let done = step + 1;
        let writes = scene.output.every > 0 && done % scene.output.every == 0 && done < steps;
        if done % sample_every == 0 || done == steps || writes {
            // The clock runs for the step loop only.
            march.wall += begun.elapsed();
            if let Err(value) = march.energy.sample(simulation.energy().total()) {
                let (critical, remedy) = limit::<D>(scene);
                return Err(RunError::NoEnergy {
                    step: done,
                    value,
                    dt,
                    critical,
                    remedy,
                });
            }
            if writes && frames.are_wanted() {
                let (particles, liquid) = (simulation.particles(), simulation.liquid());
                frames.write(Some(done), schedule.time(done), &particles, &liquid)?;
            }
            progress(Progress { step: done, steps });
            begun = Instant::now();
        }
    }
    Ok(march)
}

/// Largest stable step (s) of the initial layout, if it can be found, and what helps against a larger one.
fn limit<const D: usize>(scene: &Scene) -> (Option<f64>, &'static str)
where
    Scene: InSpace<D>,
{
    match critical_step_in::<D>(scene).ok().flatten() {
        Some(limit) => (Some(limit.step), remedy(limit.mechanism)),
        None => (None, ""),
    }
}

#[cfg(test)]
mod tests {
    use crate::run::{RunError, run};
    use crate::scene::Scene;

    /// Two cells of a material whose stress stays below its modulus.
    const BAR: &str = r#"
        title = "Bar"
        [grid]
        min = [0]
        max = [2]
        cells = [2]
        [time]
        step = 0.5
        end = 0.5
        [method]
        basis = "linear"
        reconstruction = "shepard"
        [material]
        strain = "large"
        law.linear-elastic = { youngs_modulus = 1 }
        density = 1
        [[body]]
        min = [0.5]
        max = [1.5]
        particles_per_cell = [2]
    "#;

    fn run_with(set: &str) -> Result<f64, RunError> {
        let scene = Scene::from_toml(BAR, &[set.to_owned()]).unwrap();
        run(&scene, None, &mut |_| {}).map(|outcome| outcome.summary.energy.last)
    }

    #[test]
    fn a_run_whose_energy_is_no_number_is_not_done() {
        assert!(run_with("body.0.stress=\"0.99\"").unwrap().is_finite());
        let start = run_with("body.0.stress=\"1.01\"").unwrap_err();
        assert!(
            matches!(start, RunError::NoEnergyAtStart { value } if value.is_nan()),
            "{start}"
        );
        // One step strains the particles by 1.5: the stress jumps beyond the modulus.
        let later = run_with("body.0.velocity=[\"12*(x-1)\"]").unwrap_err();
        assert!(matches!(later, RunError::NoEnergy { step: 1, .. }), "{later}");
    }

    #[test]
    fn a_ratio_to_next_to_nothing_is_left_out() {
        let set = [
            "body.0.velocity=[\"1e-160\"]".to_owned(),
            "load.body_force=[\"1\"]".to_owned(),
        ];
        let scene = Scene::from_toml(BAR, &set).unwrap();
        let energy = run(&scene, None, &mut |_| {}).unwrap().summary.energy;
        assert!(
            energy.initial > 0.0 && energy.highest_ratio.is_none(),
            "{energy:?}"
        );
    }
}
