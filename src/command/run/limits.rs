//! What limits the time step, in words, and what is to be warned of.

use std::fmt;

use super::method_warnings::method_warnings;
use super::schedule::Schedule;
use crate::scene::{
    Boundary, BoundaryKind, Expression, Method, Phases, PoreBoundary, ReconstructionKind, Scene, StepSize,
};
use materialpoint::error::StepError;
use materialpoint::grid::{Face, Side};
use materialpoint::stepper::Mechanism;

/// The mechanism that limits the step of a scene.
pub fn mechanism(scene: &Scene, mechanism: Mechanism) -> String {
    let wave = match (mechanism, scene.material.phases) {
        (Mechanism::Drag, _) => return "the drag between solid and liquid (explicit)".to_owned(),
        (Mechanism::Diffusion, _) => return "diffusion from particle to particle (explicit)".to_owned(),
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
fn remedy(mechanism: Mechanism) -> &'static str {
    match mechanism {
        Mechanism::Wave | Mechanism::Diffusion => "",
        Mechanism::Drag => ", or material.drag = \"implicit\", which the drag does not limit",
    }
}

/// What a user should know of a run although it was done.
pub(super) fn warnings(scene: &Scene, schedule: &Schedule, gain: Option<EnergyGain>) -> Vec<String> {
    let all = [
        step_warning(scene, schedule),
        gain.map(|gain| gain.to_string()),
        period_warning("every", scene.output.every, schedule.steps),
        period_warning("checkpoint_every", scene.output.checkpoint_every, schedule.steps),
    ];
    let mut found = method_warnings(scene);
    found.extend(all.into_iter().flatten());
    found
}

/// Steps in which a wall's impulses were not found to the last digit.
pub(super) fn unsolved_contacts(scene: &Scene, steps: usize) -> Option<String> {
    let or = match scene.method.reconstruction {
        ReconstructionKind::Shepard => "",
        _ => ", or method.reconstruction = \"shepard\"",
    };
    (steps > 0).then(|| {
        format!(
            "in {steps} steps the impulses of walls that rub were not found within their tolerance: look at energy.wall_gain \
             and the velocities at these walls; take a smaller time.safety or time.step{or}"
        )
    })
}

/// A fixed step that was, or became, too large.
fn step_warning(scene: &Scene, schedule: &Schedule) -> Option<String> {
    let (when, limit) = schedule.exceeded;
    let since = match when {
        0.0 => "from the start on".to_owned(),
        _ => format!("from {when:.6} s on"),
    };
    when.is_finite().then(|| {
        format!(
            "time.step = {:.3e} s is above the largest stable step {since}, {:.3e} s {} with the speed that the particles have \
             then, limited by {}; take a smaller one or \"auto\"{}",
            schedule.dt,
            limit.step,
            found_by(scene),
            mechanism(scene, limit.mechanism),
            remedy(limit.mechanism)
        )
    })
}

/// How the largest stable step of a run is found: plain MPM has a bound, which the limit itself is above.
fn found_by(scene: &Scene) -> &'static str {
    let Method {
        reconstruction,
        subpoints,
        ..
    } = scene.method;
    match reconstruction == ReconstructionKind::Shepard && subpoints == 1 {
        true => "by a bound",
        false => "by a sample of the particles",
    }
}

fn period_warning(key: &str, period: usize, steps: usize) -> Option<String> {
    (period > steps).then(|| {
        format!("output.{key} = {period} is more than the {steps} steps of the run: nothing was written before its end")
    })
}

/// Energy that rose although nothing gives any: there is no load, and what holds the bodies is at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyGain {
    /// Highest energy over that of the start.
    pub ratio: f64,
}

impl EnergyGain {
    /// Ratio up to which a gain is that of the method's finite steps and cells.
    pub const SMALL: f64 = 1.01;
    /// Ratio beyond which the result is none.
    pub const LARGE: f64 = 1.1;

    /// If nothing of `scene` gives energy and `ratio` is no small one.
    pub(super) fn of(scene: &Scene, ratio: f64) -> Option<Self> {
        (ratio > Self::SMALL && gives_no_energy(scene)).then_some(Self { ratio })
    }

    /// Whether the result is none.
    pub fn is_large(&self) -> bool {
        self.ratio > Self::LARGE
    }
}

impl fmt::Display for EnergyGain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let worth = match self.is_large() {
            true => "this is no result",
            false => "take the result with care",
        };
        write!(
            f,
            "the energy rose to {:.3} of that at the start although nothing loads the bodies: {worth}; take a smaller time.step or \
             time.safety, then smoother functions (method.basis = \"bspline\"), or relaxed-taylor in place of taylor",
            self.ratio
        )
    }
}

fn gives_no_energy(scene: &Scene) -> bool {
    let at_rest = |boundary: &Boundary| {
        let kind = match &boundary.kind {
            BoundaryKind::Free
            | BoundaryKind::Fixed
            | BoundaryKind::Roller
            | BoundaryKind::Frictional { velocity: None, .. } => true,
            BoundaryKind::Frictional {
                velocity: Some(values),
                ..
            }
            | BoundaryKind::Velocity(values)
            | BoundaryKind::Traction(values) => values.iter().all(Expression::is_zero),
        };
        let pores = match &boundary.pores {
            PoreBoundary::Sealed | PoreBoundary::Drained => true,
            PoreBoundary::Pressure(pressure) => pressure.is_zero(),
        };
        kind && pores
    };
    let driven = scene
        .reference
        .is_some_and(|reference| reference.gives_initial_state());
    // A load of zero, which somebody may have left there, loads nothing.
    let loaded = scene.body_force.iter().flatten().any(|force| !force.is_zero());
    !driven && !loaded && scene.boundaries.iter().all(at_rest)
}

/// What to do about a run that stopped, by `fault` if that is known: the end of a sentence.
pub(super) fn advice(scene: &Scene, schedule: &Schedule, fault: Option<&StepError>) -> String {
    let (dt, limit) = (schedule.dt, schedule.limit.step);
    let unstable = dt > limit;
    let step = match scene.time.step {
        StepSize::Fixed(_) if unstable => format!(
            "the run is unstable: time.step = {dt:.3e} s is above the largest stable step, {limit:.3e} s, so take a smaller one or \
             \"auto\"{}",
            remedy(schedule.limit.mechanism)
        ),
        StepSize::Fixed(_) => {
            format!(
                "take a smaller time.step than {dt:.3e} s, which is within the largest stable step, {limit:.3e} s"
            )
        }
        StepSize::Auto { .. } => format!(
            "take a smaller time.safety than {:?} (the step was {dt:.3e} s, the largest stable step {limit:.3e} s)",
            scene.safety()
        ),
    };
    let place = match fault {
        Some(StepError::LeftGrid { position, .. }) => face_left(scene, position),
        _ => None,
    };
    match place {
        Some(place) => format!("{step}; {place}"),
        None if unstable => step,
        None => format!("{step}; if that does not help look at the loads, the grid's extent and the method"),
    }
}

/// The face through which a particle left to `position` (m), if nothing holds it there.
fn face_left(scene: &Scene, position: &[f64]) -> Option<String> {
    let (axis, side) = position.iter().enumerate().find_map(|(axis, &x)| {
        let (min, max) = (scene.grid.min.get(axis)?, scene.grid.max.get(axis)?);
        match () {
            () if x < *min => Some((axis, Side::Min)),
            () if x > *max => Some((axis, Side::Max)),
            () => None,
        }
    })?;
    let face = Face { axis, side };
    let there = scene.boundaries.iter().find(|boundary| boundary.face == face);
    let what = match there.map(|boundary| &boundary.kind) {
        None => "there is no [[boundary]] at",
        Some(BoundaryKind::Free | BoundaryKind::Traction(_)) => "the [[boundary]] holds nothing at",
        Some(_) => return None,
    };
    Some(format!(
        "{what} {face}, through which it left: give that face fixed, roller or friction, or make the grid reach further"
    ))
}

/// Warnings of the method alone.
pub(super) fn of_method(scene: &Scene) -> Vec<String> {
    method_warnings(scene)
}

#[cfg(test)]
mod tests {
    use super::gives_no_energy;
    use crate::scene::Scene;

    const BAR: &str = r#"
title = "Bar"
grid = { min = [0], max = [2], cells = [4] }
time = { step = 1e-3, end = 0.1 }
method = { basis = "linear", reconstruction = "shepard" }
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 1e6 }
density = 1000
[[body]]
min = [0]
max = [1]
particles_per_cell = [2]
[[boundary]]
face = "x-min"
roller = true
"#;

    #[test]
    fn a_load_of_zero_loads_nothing() {
        let quiet = |set: &str| gives_no_energy(&Scene::from_toml(BAR, &[set.to_owned()]).unwrap());
        for still in ["load={body_force=[\"0\"]}", "load={body_force=[\"-2*0\"]}"] {
            assert!(quiet(still), "{still}");
        }
        for loaded in ["load={body_force=[\"1\"]}", "load={body_force=[\"0*t\"]}"] {
            assert!(!quiet(loaded), "{loaded}");
        }
        let moving = |velocity: &str| format!("boundary=[{{face=\"x-min\", velocity=[\"{velocity}\"]}}]");
        assert!(quiet(&moving("0")) && !quiet(&moving("1")));
    }
}
