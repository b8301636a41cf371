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

    /// Time (s) at which the velocity lives at the end of the run: the middle of the last step.
    pub(super) fn velocity_time(&self) -> f64 {
        self.end - self.size(self.steps - 1) / 2.0
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
        assert!((rest.velocity_time() - 0.95).abs() < 1e-15);
    }
}
