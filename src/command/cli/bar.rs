//! The progress bar on standard error.

use std::fmt::Write;
use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// A bar of `length`; hidden if `quiet` or if standard error is no terminal.
pub(super) fn bar(quiet: bool, length: u64, unit: &str) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr());
    let template = format!("{{bar:40}} {{pos}}/{{len}} {unit}, {{left}} {{msg}}");
    // The template is ours; should it ever be wrong, the default style still shows progress.
    if let Ok(style) = ProgressStyle::with_template(&template) {
        bar.set_style(
            style.with_key("left", |state: &ProgressState, out: &mut dyn Write| {
                // What cannot be written to the terminal is no reason to stop.
                let _ = out.write_str(&left(state.per_sec(), state.eta()));
            }),
        );
    }
    bar
}

/// How long it will take, once something is done and has taken time.
fn left(per_second: f64, eta: Duration) -> String {
    match per_second > 0.0 {
        true => format!("{} left", HumanDuration(eta)),
        false => "getting ready".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_said_of_the_time_left_before_a_step_is_done() {
        assert_eq!(left(0.0, Duration::ZERO), "getting ready");
        assert_eq!(left(2.0, Duration::from_secs(5)), "5 seconds left");
    }
}
