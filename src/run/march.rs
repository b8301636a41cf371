//! The step loop.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::Progress;
use super::checkpoint;
use super::critical_step_in;
use super::error::RunError;
use super::frames::{Frames, Moment};
use super::limits::remedy;
use super::loads::forcing;
use super::particle_fields::Snapshot;
use super::schedule::Schedule;
use super::space::InSpace;
use super::warnings;
use crate::scene::Scene;
use crate::stepper::Simulation;

/// Energy is sampled this often in a run: often enough to see it grow, seldom enough to cost nothing.
pub(super) const ENERGY_SAMPLES: usize = 1000;

/// A run to march through.
pub(super) struct Journey<'a> {
    pub(super) scene: &'a Scene,
    pub(super) schedule: &'a Schedule,
    /// How often the energy is sampled.
    pub(super) samples: usize,
    /// Where it begins.
    pub(super) from: Milestone,
}

/// How far a run is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Milestone {
    /// Steps taken.
    pub(super) done: usize,
    pub(super) energy: EnergyRange,
}

/// Figures gathered along the way.
#[derive(Clone, Debug, Default)]
pub(super) struct March {
    /// Time of the steps on the clock, and how many were taken in it: not those before a checkpoint.
    pub(super) wall: Duration,
    pub(super) steps: usize,
    pub(super) energy: EnergyRange,
    /// Where the last checkpoint is.
    pub(super) checkpoint: Option<PathBuf>,
}

/// Total energy at the start, at the end, and its range.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// Takes in an energy, which is finite.
    fn sample(&mut self, energy: f64) {
        if self.initial.is_nan() {
            self.initial = energy;
        }
        self.last = energy;
        self.highest = self.highest.max(energy);
        self.lowest = self.lowest.min(energy);
    }
}

/// What is to be done after a step.
struct Due {
    frame: bool,
    sample: bool,
    checkpoint: bool,
}

impl Journey<'_> {
    fn due(&self, done: usize) -> Due {
        let output = &self.scene.output;
        let steps = self.schedule.steps;
        let every = |period: usize| period > 0 && done.is_multiple_of(period);
        let frame = every(output.every) && done < steps;
        let sample_every = steps.div_ceil(self.samples.max(1)).max(1);
        Due {
            frame,
            sample: done.is_multiple_of(sample_every) || done == steps || frame,
            // It samples no energy: a run with checkpoints reports what one without them does.
            checkpoint: every(output.checkpoint_every),
        }
    }
}

/// Steps `simulation` to the end, writing particles and checkpoints when the scene asks for it, and sampling the energy.
pub(super) fn march<const D: usize>(
    journey: &Journey<'_>,
    simulation: &mut dyn Simulation<D>,
    frames: &mut Frames<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<March, RunError>
where
    Scene: InSpace<D>,
{
    let Journey {
        scene,
        schedule,
        from,
        ..
    } = journey;
    let steps = schedule.steps;
    let mut march = March {
        energy: from.energy,
        ..March::default()
    };
    // A resumed run has begun already; one that has nothing left to do may end earlier than it was to.
    if from.done == 0 || from.done == steps {
        start_energy(simulation, &mut march, from.done == steps)?;
    }
    if from.done == 0 && frames.begin_at_start() {
        write_frame(journey, 0, frames, simulation)?;
    }
    let driver = scene.driver()?;
    progress(Progress {
        step: from.done,
        steps,
    });
    let mut begun = Instant::now();
    for step in from.done..steps {
        let dt = schedule.size(step);
        let forcing = forcing(scene, schedule.time(step), dt)?;
        if let Some(driver) = &driver {
            simulation.set_body_forces(&|x| driver.body_force(x, schedule.time(step)));
        }
        let kick = schedule.kick(step, scene.time.half_kick);
        let done = step + 1;
        let due = journey.due(done);
        // The energy of a step is that at its start, the first one's that at the start of the run.
        let measured = match due.sample || step == 0 {
            true => simulation.step_and_measure(kick, dt, &forcing).map(Some),
            false => simulation.step_with_kick(kick, dt, &forcing).map(|()| None),
        };
        let energy = match measured {
            Ok(energy) => energy,
            Err(source) => {
                let (critical, remedy) = limit::<D>(scene);
                // Strains of an unstable step say nothing of the scene.
                let stable = critical.is_none_or(|limit| dt <= limit);
                let strained = match stable {
                    true => warnings::small_strain(scene, &simulation.particles(), schedule.dt)?,
                    false => None,
                };
                return Err(RunError::Stopped {
                    source,
                    dt,
                    critical,
                    remedy,
                    note: strained.map_or_else(String::new, |warning| format!("; {warning}")),
                });
            }
        };
        march.steps += 1;
        if let Some(energy) = energy {
            take_energy(scene, energy.total(), &mut march, (done, dt))?;
        }
        if due.sample || due.checkpoint {
            // The clock runs for the step loop only.
            march.wall += begun.elapsed();
            if due.checkpoint {
                refuse_no_energy(scene, simulation.energy().total(), (done, dt))?;
            }
            if due.frame && frames.are_wanted() {
                write_frame(journey, done, frames, simulation)?;
            }
            if due.checkpoint {
                let energy = march.energy;
                let milestone = Milestone { done, energy };
                march.checkpoint = checkpoint::write((scene, schedule), &milestone, frames, simulation)?;
            }
            progress(Progress { step: done, steps });
            begun = Instant::now();
        }
    }
    Ok(march)
}

fn write_frame<const D: usize>(
    journey: &Journey<'_>,
    done: usize,
    frames: &mut Frames<'_>,
    simulation: &dyn Simulation<D>,
) -> Result<(), RunError> {
    let snapshot = Snapshot {
        particles: &simulation.particles(),
        liquid: &simulation.liquid(),
        law: &simulation.material_fields(),
    };
    frames.write(Moment::after(journey.scene, journey.schedule, done), &snapshot)
}

/// Refuses a start whose energy is no number; if no step follows, it is the run's.
fn start_energy<const D: usize>(
    simulation: &dyn Simulation<D>,
    march: &mut March,
    is_end: bool,
) -> Result<(), RunError> {
    let value = simulation.energy().total();
    if !value.is_finite() {
        return Err(RunError::NoEnergyAtStart { value });
    }
    if is_end && march.energy.initial.is_nan() {
        march.energy.sample(value);
    }
    Ok(())
}

/// Takes in a sample of the energy.
fn take_energy<const D: usize>(
    scene: &Scene,
    value: f64,
    march: &mut March,
    at: (usize, f64),
) -> Result<(), RunError>
where
    Scene: InSpace<D>,
{
    refuse_no_energy(scene, value, at)?;
    march.energy.sample(value);
    Ok(())
}

/// Refuses an energy that is no number: of such a state nothing good comes.
fn refuse_no_energy<const D: usize>(
    scene: &Scene,
    value: f64,
    (step, dt): (usize, f64),
) -> Result<(), RunError>
where
    Scene: InSpace<D>,
{
    if value.is_finite() {
        return Ok(());
    }
    let (critical, remedy) = limit::<D>(scene);
    Err(RunError::NoEnergy {
        step,
        value,
        dt,
        critical,
        remedy,
    })
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
