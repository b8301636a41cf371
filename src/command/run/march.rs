//! The step loop.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::Progress;
use super::checkpoint;
use super::error::RunError;
use super::frames::{Frames, Moment};
use super::limits::advice;
use super::loads::forcing;
use super::particle_fields::Snapshot;
use super::schedule::Schedule;
use super::space::InSpace;
use super::warnings;
use crate::scene::Scene;
use materialpoint::error::StepError;
use materialpoint::stepper::Simulation;

/// How often a run says how far it is.
const REPORTS: usize = 1000;

/// How often the energy of so many particles is sampled in a run: often enough to see it grow, seldom enough
/// to cost nothing.
///
/// Along one axis a sample takes as long as two steps. A thousand of them are a hundredth of a second for
/// two thousand particles; for more there are fewer, so that they remain that, and at least twenty.
pub(super) fn energy_samples(particles: usize) -> usize {
    (2_000_000 / particles.max(1)).clamp(20, 1000)
}

/// A run to march through.
pub(super) struct RunPlan<'a> {
    pub(super) scene: &'a Scene,
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
    report: bool,
    sample: bool,
    checkpoint: bool,
}

impl RunPlan<'_> {
    fn due(&self, done: usize, steps: usize) -> Due {
        let output = &self.scene.output;
        let every = |period: usize| period > 0 && done.is_multiple_of(period);
        let frame = every(output.every) && done < steps;
        let is_one_of = |many: usize| every(steps.div_ceil(many.max(1))) || done == steps || frame;
        Due {
            frame,
            report: is_one_of(REPORTS),
            sample: is_one_of(self.samples),
            // It samples no energy: a run with checkpoints reports what one without them does.
            checkpoint: every(output.checkpoint_every),
        }
    }
}

/// Steps `simulation` to the end, writing particles and checkpoints when the scene asks for it, and sampling
/// the energy. Steps that are renewed change `schedule`.
pub(super) fn march<const D: usize>(
    plan: &RunPlan<'_>,
    schedule: &mut Schedule,
    simulation: &mut dyn Simulation<D>,
    frames: &mut Frames<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<March, RunError>
where
    Scene: InSpace<D>,
{
    let RunPlan { scene, from, .. } = plan;
    let mut march = March {
        energy: from.energy,
        ..March::default()
    };
    // A resumed run has begun already; one that has nothing left to do may end earlier than it was to.
    if from.done == 0 || from.done == schedule.steps {
        start_energy(simulation, &mut march, from.done == schedule.steps)?;
    }
    if from.done == 0 && frames.begin_at_start() {
        write_frame((scene, schedule), 0, frames, simulation)?;
    }
    let driver = scene.driver()?;
    let mut tell = |step, steps, dt| progress(Progress { step, steps, dt });
    tell(from.done, schedule.steps, schedule.dt);
    let mut begun = Instant::now();
    let mut step = from.done;
    while step < schedule.steps {
        if step > 0 {
            schedule.look(step, scene, simulation)?;
        }
        let dt = schedule.size(step);
        let forcing = forcing(scene, schedule.time(step), dt)?;
        if let Some(driver) = &driver {
            simulation.set_body_forces(&|x| driver.body_force(x, schedule.time(step)));
        }
        let kick = schedule.kick(step, scene.time.half_kick);
        let done = step + 1;
        let due = plan.due(done, schedule.steps);
        // The energy of a step is that at its start, the first one's that at the start of the run.
        let measured = match due.sample || step == 0 {
            true => simulation.step_and_measure(kick, dt, &forcing).map(Some),
            false => simulation.step_with_kick(kick, dt, &forcing).map(|()| None),
        };
        let energy = measured.or_else(|fault| Err(stopped((scene, schedule), simulation, fault)?))?;
        march.steps += 1;
        if let Some(energy) = energy {
            refuse_no_energy((scene, schedule), energy.total(), done)?;
            march.energy.sample(energy.total());
        }
        if due.report || due.sample || due.checkpoint {
            // The clock runs for the step loop only.
            march.wall += begun.elapsed();
            if due.checkpoint || due.frame || done == schedule.steps {
                refuse_no_energy((scene, schedule), simulation.energy().total(), done)?;
            }
            if due.frame && frames.are_wanted() {
                write_frame((scene, schedule), done, frames, simulation)?;
            }
            if due.checkpoint {
                let energy = march.energy;
                let milestone = Milestone { done, energy };
                march.checkpoint = checkpoint::write((scene, schedule), &milestone, frames, simulation)?;
            }
            tell(done, schedule.steps, dt);
            begun = Instant::now();
        } else if march.steps.is_power_of_two() {
            // A run of very many steps says soon how long it will take.
            tell(done, schedule.steps, dt);
        }
        step = done;
    }
    Ok(march)
}

/// The error of a run that stopped with a `fault` of its step.
fn stopped<const D: usize>(
    (scene, schedule): (&Scene, &Schedule),
    simulation: &dyn Simulation<D>,
    source: StepError,
) -> Result<RunError, RunError>
where
    Scene: InSpace<D>,
{
    let mut advice = advice(scene, schedule, Some(&source));
    // Strains of an unstable step say nothing of the scene.
    if schedule.dt <= schedule.limit.step
        && let Some(warning) = warnings::small_strain(scene, &simulation.particles(), schedule.dt)?
    {
        advice = format!("{advice}; {warning}");
    }
    Ok(RunError::Stopped { source, advice })
}

fn write_frame<const D: usize>(
    (scene, schedule): (&Scene, &Schedule),
    done: usize,
    frames: &mut Frames<'_>,
    simulation: &dyn Simulation<D>,
) -> Result<(), RunError> {
    let snapshot = Snapshot {
        particles: &simulation.particles(),
        liquid: &simulation.liquid(),
        law: &simulation.material_fields(),
    };
    frames.write(Moment::after(scene, schedule, done), &snapshot)
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

/// Refuses an energy that is no number: of such a state nothing good comes.
fn refuse_no_energy((scene, schedule): (&Scene, &Schedule), value: f64, step: usize) -> Result<(), RunError> {
    if value.is_finite() {
        return Ok(());
    }
    let advice = advice(scene, schedule, None);
    Err(RunError::NoEnergy { step, value, advice })
}

#[cfg(test)]
mod tests {
    use super::energy_samples;
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
    fn samples_of_the_energy_grow_fewer_with_the_particles() {
        assert_eq!(
            [0, 1, 2000, 20_000, 100_000, usize::MAX].map(energy_samples),
            [1000, 1000, 1000, 100, 20, 20]
        );
    }

    #[test]
    fn a_run_whose_energy_is_no_number_is_not_done() {
        assert!(run_with("body.0.stress=\"0.99\"").unwrap().is_finite());
        // Hill's law has no meaning beyond its modulus, and says so itself.
        let start = run_with("body.0.stress=\"1.01\"").unwrap_err();
        assert!(
            matches!(start, RunError::InitialStress { body: 0, .. }),
            "{start}"
        );
        // One step strains the particles by 1.5: the stress jumps beyond the modulus.
        let later = run_with("body.0.velocity=[\"12*(x-1)\"]").unwrap_err();
        assert!(matches!(later, RunError::Stopped { .. }), "{later}");
        // In small strain nothing but the energy notices that numbers have become infinite.
        let fast = "body.0.velocity=[\"1e200*(x-1)\"]";
        let scene = Scene::from_toml(BAR, &["material.strain=small".to_owned(), fast.to_owned()]).unwrap();
        let start = run(&scene, None, &mut |_| {}).map(|_| ()).unwrap_err();
        assert!(matches!(start, RunError::NoEnergyAtStart { .. }), "{start}");
        let fast = "body.0.velocity=[\"1e154*(x-1)\"]";
        let scene = Scene::from_toml(BAR, &["material.strain=small".to_owned(), fast.to_owned()]).unwrap();
        let later = run(&scene, None, &mut |_| {}).map(|_| ());
        assert!(
            matches!(later, Err(RunError::NoEnergy { .. } | RunError::Stopped { .. })),
            "{later:?}"
        );
    }

    #[test]
    fn a_ratio_to_next_to_nothing_is_left_out() {
        let set = [
            "body.0.velocity=[\"1e-320\"]".to_owned(),
            "time.end=1".to_owned(),
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
