//! How long a run will take, said soon after it began.

use std::time::{Duration, Instant};

use materialpoint_command::run::Progress;

/// Steps that take this long show how fast the rest will be.
const ENOUGH: Duration = Duration::from_millis(500);
/// A run that takes longer (s) is told of, once.
const LONG: f64 = 3600.0;

/// Watches the first steps of a run.
pub(super) struct Pace {
    /// When the first step began, and its number.
    begun: Option<(Instant, usize)>,
    told: bool,
}

impl Pace {
    pub(super) fn new() -> Self {
        Self {
            begun: None,
            told: false,
        }
    }

    /// Whether no step has begun yet.
    pub(super) fn is_at_start(&self) -> bool {
        self.begun.is_none()
    }

    /// What the user should know of a run that will take very long; once.
    pub(super) fn warning(&mut self, progress: &Progress, now: Instant) -> Option<String> {
        let (begun, first) = *self.begun.get_or_insert((now, progress.step));
        let (spent, taken) = (now - begun, progress.step - first);
        if self.told || taken == 0 || spent < ENOUGH {
            return None;
        }
        self.told = true;
        let left = progress.steps.saturating_sub(progress.step);
        let seconds = spent.as_secs_f64() / taken as f64 * left as f64;
        (seconds > LONG).then(|| {
            format!(
                "{:.1e} steps of {:.3e} s are to be taken, which at the speed of the first {taken} takes {}; fewer take larger \
                 cells, a softer material, a larger time.step or an earlier time.end",
                progress.steps as f64,
                progress.dt,
                in_words(seconds)
            )
        })
    }
}

/// A time (s) beyond an hour.
fn in_words(seconds: f64) -> String {
    let (hours, days) = (seconds / 3600.0, seconds / 86400.0);
    match days {
        _ if days < 2.0 => format!("{hours:.1} hours"),
        _ if days < 730.0 => format!("{days:.0} days"),
        _ => format!("{:.1e} years", days / 365.25),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_of_very_many_steps_is_told_of_once_and_a_short_one_never() {
        let start = Instant::now();
        let at = |seconds: f64| start + Duration::from_secs_f64(seconds);
        let progress = |step, steps| Progress {
            step,
            steps,
            dt: 2.3e-10,
        };
        let mut pace = Pace::new();
        assert_eq!(pace.warning(&progress(0, 438_000_000), start), None);
        assert!(!pace.is_at_start());
        assert_eq!(pace.warning(&progress(512, 438_000_000), at(0.1)), None);
        // 4.38e8 steps at 1 ms: 5.07 days.
        let warning = pace.warning(&progress(1024, 438_000_000), at(1.024)).unwrap();
        assert!(
            ["4.4e8 steps of 2.300e-10 s", "the first 1024", "5 days"]
                .iter()
                .all(|part| warning.contains(part)),
            "{warning}"
        );
        assert_eq!(pace.warning(&progress(2048, 438_000_000), at(2.048)), None);
        let mut short = Pace::new();
        assert_eq!(short.warning(&progress(0, 3000), start), None);
        assert_eq!(short.warning(&progress(1024, 3000), at(1.024)), None);
        assert_eq!(in_words(5400.0), "1.5 hours");
        assert_eq!(in_words(3.2e9), "1.0e2 years");
    }
}
