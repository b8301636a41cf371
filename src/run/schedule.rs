//! When the steps of a run begin and end.

use super::critical_step_in;
use super::error::RunError;
use super::space::InSpace;
use crate::scene::{Scene, StepSize};

/// Steps of one size; the last one is shorter where the end asks for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    pub(super) steps: usize,
    pub(super) dt: f64,
    pub(super) end: f64,
}

impl Schedule {
    pub(super) fn new<const D: usize>(scene: &Scene) -> Result<Self, RunError>
    where
        Scene: InSpace<D>,
    {
        let end = scene.time.end;
        match scene.time.step {
            StepSize::Fixed(dt) => Ok(Self::fixed(dt, end)),
            StepSize::Auto { safety } => {
                let critical = critical_step_in::<D>(scene)?
                    .ok_or(RunError::NoCriticalStep)?
                    .step;
                let steps = (end / (safety * critical)).ceil().max(1.0);
                Ok(Self {
                    steps: steps as usize,
                    dt: end / steps,
                    end,
                })
            }
        }
    }

    fn fixed(dt: f64, end: f64) -> Self {
        // An end that is a whole number of steps but for round-off takes exactly that many.
        let whole = (end / dt).round();
        let steps = if (end / dt - whole).abs() <= 1e-9 * whole {
            whole
        } else {
            (end / dt).ceil()
        };
        Self {
            steps: steps.max(1.0) as usize,
            dt,
            end,
        }
    }

    /// Time (s) at which step `step` (from 0) begins.
    pub(super) fn time(&self, step: usize) -> f64 {
        step as f64 * self.dt
    }

    /// Size (s) of step `step` (from 0).
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

    /// Time (s) over which the velocities are kicked in step `step` (from 0): from the middle of the step
    /// before to that of this one if they start at time zero (`half_kick`), and otherwise the whole step, as
    /// the papers have it.
    pub(super) fn kick(&self, step: usize, half_kick: bool) -> f64 {
        match (half_kick, step.checked_sub(1)) {
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
}
