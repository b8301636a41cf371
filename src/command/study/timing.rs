//! Times of the runs of a study.
//!
//! The runs take turns: a pass times every run that still needs it once. A machine that is busy for a while
//! then slows all methods, not the one whose turn it was.

use super::{Plan, StudyError};
use crate::run::step_loop_seconds;
use crate::scene::Scene;
use materialpoint::method::Method;

/// A run is not timed more often than this (or [`Plan::repeat`]), however short it is.
const MOST_TIMINGS: usize = 200;

/// One run of the plan and how long its step loop took (s), each time.
pub(super) struct Timing {
    pub(super) method: Method,
    pub(super) cells: usize,
    pub(super) scene: Scene,
    /// Empty for a run that stopped: it is not run again.
    pub(super) times: Vec<f64>,
}

impl Timing {
    fn wants_more(&self, plan: &Plan) -> bool {
        let done = self.times.len();
        // Not the sum: one time in which the machine was busy elsewhere would end it early.
        let short = median(&self.times) * (done as f64) < plan.least_seconds;
        done > 0 && (done < plan.repeat || short && done < MOST_TIMINGS)
    }

    fn again(&mut self) -> Result<(), StudyError> {
        let seconds = step_loop_seconds(&self.scene).map_err(|source| StudyError::Run {
            method: self.method,
            cells: self.cells,
            source: Box::new(source),
        })?;
        self.times.push(seconds);
        Ok(())
    }
}

/// Times in turns until the plan is content; `progress` is called before each pass with its number, from 2.
pub(super) fn complete(
    timings: &mut [Timing],
    plan: &Plan,
    progress: &mut dyn FnMut(usize),
) -> Result<(), StudyError> {
    let mut pass = 2;
    while timings.iter().any(|timing| timing.wants_more(plan)) {
        progress(pass);
        timings
            .iter_mut()
            .filter(|timing| timing.wants_more(plan))
            .try_for_each(Timing::again)?;
        pass += 1;
    }
    Ok(())
}

/// Not a number for no times.
pub(super) fn median(times: &[f64]) -> f64 {
    let mut sorted = times.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |i: usize| sorted.get(i).copied().unwrap_or(f64::NAN);
    let middle = sorted.len() / 2;
    if sorted.len() % 2 == 1 || sorted.is_empty() {
        return at(middle);
    }
    (at(middle - 1) + at(middle)) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_lies_between() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&[]).is_nan());
    }

    fn timing(times: &[f64]) -> Timing {
        let text = Scene::builtin("vibrating-bar-small").unwrap_or_default();
        Timing {
            method: Method::NINE[0],
            cells: 5,
            scene: Scene::from_toml(text, &["grid.cells=[5]".into()]).unwrap(),
            times: times.to_vec(),
        }
    }

    #[test]
    fn short_runs_are_timed_until_they_can_be_trusted_and_stopped_ones_never_again() {
        let plan = Plan {
            methods: Vec::new(),
            cells: Vec::new(),
            repeat: 3,
            least_seconds: 0.1,
        };
        assert!(timing(&[1.0, 1.0]).wants_more(&plan), "fewer than asked");
        assert!(!timing(&[1.0, 1.0, 1.0]).wants_more(&plan));
        assert!(timing(&[1e-3; 50]).wants_more(&plan), "half of the time");
        assert!(!timing(&[1e-3; 101]).wants_more(&plan));
        assert!(!timing(&[1e-9; MOST_TIMINGS]).wants_more(&plan));
        assert!(
            timing(&[1e-3, 1e-3, 1e-3, 5.0]).wants_more(&plan),
            "one of them is an accident"
        );
        assert!(!timing(&[]).wants_more(&plan));
    }

    #[test]
    fn passes_go_on_until_every_run_has_its_times() {
        let plan = Plan {
            methods: Vec::new(),
            cells: Vec::new(),
            repeat: 4,
            least_seconds: 0.0,
        };
        let mut timings = [timing(&[1.0]), timing(&[]), timing(&[1.0; 3])];
        let mut passes = Vec::new();
        complete(&mut timings, &plan, &mut |pass| passes.push(pass)).unwrap();
        assert_eq!(passes, [2, 3, 4]);
        assert_eq!(timings.map(|timing| timing.times.len()), [4, 0, 4]);
    }
}
