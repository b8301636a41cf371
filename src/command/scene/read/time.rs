//! `[time]`

use super::{Item, Section};
use crate::scene::{SceneError, StepSize, TimeSpec};

/// Most steps of a run: years of computing.
const MOST_STEPS: f64 = 1e12;

pub(super) fn read(section: Section<'_>) -> Result<TimeSpec, SceneError> {
    let section = section.allow(&["step", "safety", "end", "half_kick"], &[])?;
    let step = step(&section)?;
    let end_item = section.required("end", "the end of the run, a positive number (s)")?;
    let end = end_item.positive("s")?;
    if let StepSize::Fixed(step) = step {
        check_steps(&end_item, step, end)?;
    }
    let half_kick = match section.optional("half_kick") {
        Some(item) => item.flag("true or false (the default): whether the first kick is half a step")?,
        None => false,
    };
    Ok(TimeSpec { step, end, half_kick })
}

fn step(section: &Section<'_>) -> Result<StepSize, SceneError> {
    let expected = "a positive number (s) or \"auto\"";
    let item = section.required("step", expected)?;
    let safety = section.optional("safety");
    match item.as_text() {
        Some("auto") => Ok(StepSize::Auto {
            safety: safety.map(|item| self::safety(&item)).transpose()?,
        }),
        Some(_) => Err(item.not_allowed(expected)),
        None => {
            let step = item.number_where(expected, |step| step > 0.0)?;
            match safety {
                Some(safety) => Err(safety.conflict("it goes with time.step = \"auto\" only; leave it out")),
                None => Ok(StepSize::Fixed(step)),
            }
        }
    }
}

fn safety(item: &Item<'_>) -> Result<f64, SceneError> {
    item.number_where(
        "a fraction of the critical step, above 0 and at most 1",
        |fraction| fraction > 0.0 && fraction <= 1.0,
    )
}

fn check_steps(end_item: &Item<'_>, step: f64, end: f64) -> Result<(), SceneError> {
    if end < step {
        return Err(end_item.conflict(&format!(
            "it lies before the end of the first step; expected at least time.step = {step:?} s"
        )));
    }
    if end / step > MOST_STEPS {
        return Err(end_item.conflict(&format!(
            "with time.step = {step:?} s it takes {:e} steps; expected at most {MOST_STEPS:e}",
            end / step
        )));
    }
    Ok(())
}
