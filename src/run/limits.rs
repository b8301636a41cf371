//! What limits the time step, in words, and what is to be warned of.

use super::error::RunError;
use super::method_warnings::method_warnings;
use super::schedule::Schedule;
use crate::scene::{Phases, ReconstructionKind, Scene, StepSize};
use crate::stepper::{CriticalStep, Mechanism};

/// The mechanism that limits the step of a scene.
pub fn mechanism(scene: &Scene, mechanism: Mechanism) -> String {
    let wave = match (mechanism, scene.material.phases) {
        (Mechanism::Drag, _) => return "the drag between solid and liquid (explicit)".to_owned(),
        (Mechanism::Wave, Phases::One { .. }) => "an elastic wave",
        (Mechanism::Wave, Phases::Two(_)) => "a compression wave of solid and liquid",
    };
    let method = &scene.method;
    let masses = match method.reconstruction {
        ReconstructionKind::RelaxedTaylor => "consistent mass in velocity and acceleration".to_owned(),
        _ => format!(
            "{} mass in the velocity, lumped in the acceleration",
            method.velocity_mass.name()
        ),
    };
    let force = match method.subpoints {
        1 => String::new(),
        n => format!("force at {n} sub-points of each particle, "),
    };
    format!(
        "{wave} crossing a cell: {} basis, {force}{masses}",
        method.basis.name()
    )
}

/// What helps besides a smaller step: the end of a sentence.
pub(super) fn remedy(mechanism: Mechanism) -> &'static str {
    match mechanism {
        Mechanism::Wave => "",
        Mechanism::Drag => ", or material.drag = \"implicit\", which the drag does not limit",
    }
}

/// What a user should know of a run although it may be done.
pub(super) fn warnings(
    scene: &Scene,
    schedule: &Schedule,
    critical: impl FnOnce() -> Result<Option<CriticalStep<f64>>, RunError>,
) -> Result<Vec<String>, RunError> {
    let mut warnings: Vec<String> = method_warnings(scene);
    // "auto" stays below by itself.
    if let StepSize::Fixed(_) = scene.time.step
        && let Some(limit) = critical()?
        && schedule.dt > limit.step
    {
        warnings.push(format!(
            "time.step = {:.3e} s is above the largest stable step, {:.3e} s, limited by {}; take a smaller one or \"auto\"{}",
            schedule.dt,
            limit.step,
            mechanism(scene, limit.mechanism),
            remedy(limit.mechanism)
        ));
    }
    Ok(warnings)
}
