//! When the steps of a run begin and end.
//!
//! A fixed step is the same throughout; the last one is shorter where the end asks for it. An automatic step
//! is a share (`time.safety`) of the largest stable one, and looked at again as the run goes: waves get
//! faster where material stiffens, particles move, surfaces come to lie in other cells. Looked at is before
//! the steps with numbers that are multiples of [`LOOK`] (speeds) and [`LAYOUT`] (where the particles are in
//! the grid), so that the steps follow from the scene alone: not from the threads, the files that are written
//! or where the run was interrupted. It changes only when it has become too large, or too small by a quarter,
//! and is cut so that a whole number of equal steps leads to the end.

use super::error::RunError;
use super::loads::forcing;
use super::space::InSpace;
use crate::scene::{Scene, StepSize};
use materialpoint::stepper::{CriticalStep, Mechanism, Simulation};

/// Steps between two looks at the speeds of waves and particles.
const LOOK: usize = 16;
/// Steps between two looks at the layout, a multiple of [`LOOK`]. It takes two passes over the particles.
const LAYOUT: usize = 64;
/// The same where it takes some hundred sweeps over a sample of the particles.
const SAMPLED: usize = 2048;
/// A fixed step is looked at so many times less often: nothing follows from it but a warning.
const SELDOM: usize = 4;
/// An automatic step grows when it could by so much: each change costs a little accuracy, since velocities
/// live half a step early.
const GROWTH: f64 = 1.25;
/// Most steps of a run: years of computing.
const MOST_STEPS: f64 = 1e12;

/// What nothing limits.
const UNLIMITED: CriticalStep<f64> = CriticalStep {
    step: f64::INFINITY,
    mechanism: Mechanism::Wave,
};

/// The steps of a run, as far as they are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Steps in all, if they stay as they are.
    pub(super) steps: usize,
    /// Their size (s).
    pub(super) dt: f64,
    /// End of the run (s).
    pub(super) end: f64,
    /// First step of this size (from 0), and the time at which it begins (s).
    pub(super) since: (usize, f64),
    /// Size of the step before that (s); of the first one its own.
    pub(super) before: f64,
    /// Least and greatest size so far (s).
    pub(super) range: [f64; 2],
    /// Stiffness of the layout (1/m2), as it was last found.
    pub(super) stiffness: f64,
    /// Largest stable step, as it was last found; infinite where there is none.
    pub(super) limit: CriticalStep<f64>,
    /// Time (s) at which a fixed step was found to be too large, and the largest stable one then; infinite if
    /// it never was.
    pub(super) exceeded: (f64, CriticalStep<f64>),
}

impl Schedule {
    /// The steps of `scene` for a `simulation` that has taken none.
    ///
    /// # Errors
    /// If the step is automatic and nothing resists a motion, or the end is too far away.
    pub(super) fn new<const D: usize>(
        scene: &Scene,
        simulation: &mut dyn Simulation<D>,
    ) -> Result<Self, RunError>
    where
        Scene: InSpace<D>,
    {
        let end = scene.time.end;
        if let StepSize::Fixed(dt) = scene.time.step {
            let mut schedule = Self::fixed(dt, end);
            schedule.look(0, scene, simulation)?;
            return Ok(schedule);
        }
        let mut schedule = Self::fixed(f64::INFINITY, end);
        match schedule.find_limit(0, scene, simulation)? {
            None => Err(RunError::NoCriticalStep),
            Some(limit) => {
                schedule.divide(0, scene.safety() * limit.step)?;
                Ok(schedule)
            }
        }
    }

    /// Steps of `dt` (s) up to `end` (s).
    pub(super) fn fixed(dt: f64, end: f64) -> Self {
        Self {
            steps: steps_to(end, dt) as usize,
            dt,
            end,
            since: (0, 0.0),
            before: dt,
            range: [dt, dt],
            stiffness: 0.0,
            limit: UNLIMITED,
            exceeded: (f64::INFINITY, UNLIMITED),
        }
    }

    /// Whether `scene` may have come to these steps when `done` of them were taken.
    pub(super) fn makes_sense(&self, scene: &Scene, done: usize) -> bool {
        let (first, start) = self.since;
        let of_scene = match scene.time.step {
            StepSize::Fixed(dt) => self.dt.to_bits() == dt.to_bits() && first == 0 && start == 0.0,
            StepSize::Auto { .. } => self.dt > 0.0 && self.end == scene.time.end,
        };
        let inside = self.end.is_finite() && 0.0 <= start && start < self.end && first <= done;
        // Neither count is out of range once both tests are passed.
        let count = steps_to(self.end - start, self.dt);
        of_scene && inside && count <= MOST_STEPS && first.checked_add(count as usize) == Some(self.steps)
    }

    /// The same run with another end (s).
    pub(super) fn with_end(self, end: f64) -> Self {
        let (first, start) = self.since;
        Self {
            steps: first + steps_to(end - start, self.dt) as usize,
            end,
            ..self
        }
    }

    /// Looks before step `step` whether its size is still right; an automatic one is renewed.
    ///
    /// # Errors
    /// If the end has become too far away.
    pub(super) fn look<const D: usize>(
        &mut self,
        step: usize,
        scene: &Scene,
        simulation: &mut dyn Simulation<D>,
    ) -> Result<(), RunError>
    where
        Scene: InSpace<D>,
    {
        let fixed = matches!(scene.time.step, StepSize::Fixed(_));
        let seldom = if fixed { SELDOM } else { 1 };
        if !step.is_multiple_of(LOOK * seldom) {
            return Ok(());
        }
        let Some(limit) = self.find_limit(step / seldom, scene, simulation)? else {
            return Ok(());
        };
        if fixed {
            if self.dt > limit.step && self.exceeded.0.is_infinite() {
                self.exceeded = (self.time(step), limit);
            }
            return Ok(());
        }
        let allowed = scene.safety() * limit.step;
        // A limit that is no number is left to the step, which stops with the particle that caused it.
        let stays = self.dt <= allowed && allowed <= GROWTH * self.dt;
        if stays || !(allowed > 0.0 && allowed.is_finite()) {
            return Ok(());
        }
        self.divide(step, allowed)
    }

    /// Largest stable step now, with the layout of now or of a few steps ago.
    fn find_limit<const D: usize>(
        &mut self,
        step: usize,
        scene: &Scene,
        simulation: &mut dyn Simulation<D>,
    ) -> Result<Option<CriticalStep<f64>>, RunError>
    where
        Scene: InSpace<D>,
    {
        let every = match simulation.stiffness_is_bound() {
            true => LAYOUT,
            false => SAMPLED,
        };
        if step.is_multiple_of(every) {
            // Only which faces are held matters, not how they move.
            let stiffness = simulation.stiffness(&forcing(scene, 0.0, scene.time.end)?);
            self.stiffness = stiffness.unwrap_or(0.0);
        }
        let limit = simulation.largest_step(self.stiffness);
        // One that was found is kept for what is said of a run that stops.
        self.limit = limit.unwrap_or(self.limit);
        Ok(limit)
    }

    /// Cuts what is left after `step` steps into equal ones of at most `most` (s).
    fn divide(&mut self, step: usize, most: f64) -> Result<(), RunError> {
        let start = self.time(step);
        let rest = self.end - start;
        let count = steps_to(rest, most);
        if count > MOST_STEPS {
            return Err(RunError::TooManySteps {
                steps: count,
                dt: most,
            });
        }
        self.steps = step + count as usize;
        self.before = if step == 0 { rest / count } else { self.dt };
        self.dt = rest / count;
        self.since = (step, start);
        self.range = match step {
            0 => [self.dt; 2],
            _ => [self.range[0].min(self.dt), self.range[1].max(self.dt)],
        };
        Ok(())
    }

    /// Time (s) at which step `step` (from 0) begins, not before the last change.
    pub(super) fn time(&self, step: usize) -> f64 {
        let (first, start) = self.since;
        match step - first.min(step) {
            0 => start,
            taken => start + taken as f64 * self.dt,
        }
    }

    /// Size (s) of step `step` (from 0), not before the last change.
    pub(super) fn size(&self, step: usize) -> f64 {
        if step + 1 < self.steps {
            return self.dt;
        }
        let rest = self.end - self.time(step);
        // Round-off of the end must not change the last step.
        if (rest - self.dt).abs() <= 1e-6 * self.dt {
            self.dt
        } else {
            rest
        }
    }

    /// Time (s) over which the velocities are kicked in step `step` (from 0), not before the last change:
    /// from the middle of the step before to that of this one. The first kick is half a step if the
    /// velocities start at time zero (`half_kick`), and otherwise a whole one, as the papers have it; theirs
    /// is a shorter last step too.
    pub(super) fn kick(&self, step: usize, half_kick: bool) -> f64 {
        let changes = step > 0 && step == self.since.0;
        match (half_kick, step.checked_sub(1)) {
            _ if changes => (self.before + self.size(step)) / 2.0,
            (false, _) => self.size(step),
            (true, None) => self.size(step) / 2.0,
            // Equal steps give their size to the bit.
            (true, Some(before)) => (self.size(before) + self.size(step)) / 2.0,
        }
    }

    /// Time (s) at which the velocities live after `done` steps: the middle of the last one. At the start
    /// they are those of time zero, or of half a step before where the first kick is a whole step.
    pub(super) fn velocity_time(&self, done: usize, half_kick: bool) -> f64 {
        match done.checked_sub(1) {
            Some(last) => self.time_after(done) - self.size(last) / 2.0,
            None if half_kick => 0.0,
            None => -self.size(0) / 2.0,
        }
    }

    /// Time (s) after `done` steps.
    pub(super) fn time_after(&self, done: usize) -> f64 {
        match done == self.steps {
            true => self.end,
            false => self.time(done),
        }
    }
}

/// Steps of `dt` that lead over `rest`, at least one. A rest that is a whole number of steps but for
/// round-off takes exactly that many.
fn steps_to(rest: f64, dt: f64) -> f64 {
    let whole = (rest / dt).round();
    let steps = if (rest / dt - whole).abs() <= 1e-9 * whole {
        whole
    } else {
        (rest / dt).ceil()
    };
    steps.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::Schedule;

    #[test]
    fn whole_numbers_of_steps_survive_round_off_and_a_rest_shortens_the_last_step() {
        let whole = Schedule::fixed(1e-7, 1.9e-6);
        assert_eq!((whole.steps, whole.size(18)), (19, 1e-7));
        let rest = Schedule::fixed(0.3, 1.0);
        assert_eq!(rest.steps, 4);
        assert!((rest.size(3) - 0.1).abs() < 1e-15);
        assert!((rest.velocity_time(4, false) - 0.95).abs() < 1e-15);
    }

    #[test]
    fn velocities_live_in_the_middle_of_steps_and_kicks_lead_from_one_to_the_next() {
        let rest = Schedule::fixed(0.3, 1.0);
        let mut time = rest.velocity_time(0, true);
        assert_eq!(time, 0.0);
        for step in 0..rest.steps {
            time += rest.kick(step, true);
            assert!(
                (time - rest.velocity_time(step + 1, true)).abs() < 1e-15,
                "{step}"
            );
        }
        assert_eq!(rest.velocity_time(0, false), -0.15);
        assert_eq!([0, 1, 2].map(|step| rest.kick(step, false)), [0.3; 3]);
        assert_eq!([0, 1, 2].map(|step| rest.kick(step, true)), [0.15, 0.3, 0.3]);
    }

    #[test]
    fn steps_that_change_on_the_way_lead_to_the_very_end() {
        let most = |step: usize| 0.003 / (1.0 + (step / 16 * 16) as f64 / 1000.0);
        let mut schedule = Schedule::fixed(f64::INFINITY, 1.0);
        schedule.divide(0, most(0)).unwrap();
        let (mut time, mut step) = (0.0, 0);
        while step < schedule.steps {
            if step.is_multiple_of(16) && step > 0 {
                schedule.divide(step, most(step)).unwrap();
            }
            assert!((schedule.time(step) - time).abs() < 1e-12, "step {step}");
            let size = schedule.size(step);
            assert!(size <= most(step) * (1.0 + 1e-12), "step {step}: {size}");
            time += size;
            step += 1;
        }
        assert!((time - 1.0).abs() < 1e-12, "{time}");
        // The greatest was the first: 334 of at most 0.003.
        assert_eq!(schedule.range, [schedule.dt, 1.0 / 334.0]);
        let last = schedule.velocity_time(schedule.steps, true);
        assert!((last - (1.0 - schedule.dt / 2.0)).abs() < 1e-12);
        assert!(Schedule::fixed(1.0, 1.0).divide(0, 1e-13).is_err());
    }
}
