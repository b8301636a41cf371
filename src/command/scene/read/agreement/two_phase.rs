//! The references of two phases.

use super::{BASE, TOLERANCE, TOP, is_fixed, refuse, the_body, touches};
use crate::scene::{Body, Boundary, BoundaryKind, Law, Phases, PoreBoundary, Scene, SceneError};
use materialpoint::grid::{Face, Side};

/// Parts of the run at which loads are compared.
const PARTS: [f64; 5] = [0.0, 0.2, 0.5, 0.7, 1.0];

pub(super) fn consolidation(scene: &Scene, load: f64, start: f64) -> Result<(), SceneError> {
    let shown = format!("{{ load = {load:?}, start = {start:?} }}");
    let refuse = |problem: &str| refuse("reference.consolidation", &shown, problem);
    if scene.material.law.large_strain() && start != 0.0 {
        return Err(refuse(
            "at large strain the solution starts at time 0; expected start = 0, or material.strain = \"small\"",
        ));
    }
    layer(scene, load).map_err(|problem| problem.unless(refuse))
}

pub(super) fn xie_leo(scene: &Scene, load: f64) -> Result<(), SceneError> {
    let refuse = |problem: &str| refuse("reference.xie-leo", &format!("{{ load = {load:?} }}"), problem);
    if !matches!(scene.material.law, Law::Logarithmic { .. }) {
        return Err(refuse(
            "it needs stress E ln J: material.law.logarithmic with material.strain = \"large\"",
        ));
    }
    if !matches!(scene.material.phases, Phases::Two(soil) if soil.permeability_exponent == 2.0) {
        return Err(refuse(
            "it needs k = k0 lambda^2: material.permeability_exponent = 2",
        ));
    }
    layer(scene, load).map_err(|problem| problem.unless(refuse))
}

pub(super) fn standing_wave(scene: &Scene, velocity: f64, mode: usize) -> Result<(), SceneError> {
    let shown = format!("{{ velocity = {velocity:?}, mode = {mode} }}");
    let refuse = |problem: &str| refuse("reference.standing-wave", &shown, problem);
    let check = || {
        small_strain(scene)?;
        let body = one_body(scene)?;
        if ![BASE, TOP]
            .iter()
            .all(|&face| is_fixed(scene, face) && !is_open(scene, face))
        {
            return Err(
                "it needs fixed = true at x-min and at x-max, and neither drained nor pore_pressure".into(),
            );
        }
        if !(touches(scene, body, Side::Min) && touches(scene, body, Side::Max)) {
            return Err("it needs a body that reaches from grid.min to grid.max".into());
        }
        no_body_force(scene)?;
        no_initial_state(body)
    };
    check().map_err(|problem: Problem| problem.unless(refuse))
}

pub(super) fn self_weight(scene: &Scene) -> Result<(), SceneError> {
    let refuse = |problem: &str| refuse("reference.self-weight", "{}", problem);
    let check = || {
        small_strain(scene)?;
        let body = one_body(scene)?;
        standing(scene, body)?;
        let top = drained_top(scene)?;
        if top.is_some_and(|top| !matches!(top.kind, BoundaryKind::Free)) {
            return Err("it needs a top that is drained and free, without traction".into());
        }
        no_initial_state(body)?;
        let Phases::Two(soil) = scene.material.phases else {
            return Ok(());
        };
        let found = body_force(scene, scene.time.end)?;
        if (found + soil.gravity).abs() > TOLERANCE * soil.gravity {
            return Err(Problem::Words(format!(
                "it needs load.body_force = -gravity, {:.4e} N/kg, at time.end, found {found:.4e}",
                -soil.gravity
            )));
        }
        Ok(())
    };
    check().map_err(|problem: Problem| problem.unless(refuse))
}

/// What does not agree, in words, or an expression without a value.
enum Problem {
    Words(String),
    Scene(SceneError),
}

impl Problem {
    fn unless(self, refuse: impl Fn(&str) -> SceneError) -> SceneError {
        match self {
            Self::Words(words) => refuse(&words),
            Self::Scene(error) => error,
        }
    }
}

impl From<&str> for Problem {
    fn from(words: &str) -> Self {
        Self::Words(words.into())
    }
}

/// A layer on a fixed, sealed base with a constant load on its drained top, whose state the reference gives.
fn layer(scene: &Scene, load: f64) -> Result<(), Problem> {
    let body = one_body(scene)?;
    standing(scene, body)?;
    let top = drained_top(scene)?;
    if top.is_some_and(|top| top.inside.is_some()) {
        return Err("it needs its load on all of x-max; expected no inside beside traction".into());
    }
    for part in PARTS {
        let time = part * scene.time.end;
        let found = match top.map(|top| &top.kind) {
            Some(BoundaryKind::Traction(traction)) => value_at(traction.first(), time)?,
            _ => 0.0,
        };
        if (found - load).abs() > TOLERANCE * load.abs() {
            return Err(Problem::Words(format!(
                "it needs a [[boundary]] at x-max with traction = load, {load:.4e} Pa at t = {time:.4e} s, found \
                 {found:.4e}"
            )));
        }
    }
    no_body_force(scene)?;
    no_initial_state(body)
}

fn small_strain(scene: &Scene) -> Result<(), Problem> {
    if scene.material.law.large_strain() {
        return Err("it is a solution of small strain; expected material.strain = \"small\"".into());
    }
    Ok(())
}

fn one_body(scene: &Scene) -> Result<&Body, Problem> {
    the_body(scene).ok_or_else(|| "it needs exactly one [[body]], without inside".into())
}

fn standing(scene: &Scene, body: &Body) -> Result<(), Problem> {
    if !is_fixed(scene, BASE) || is_open(scene, BASE) {
        return Err("it needs fixed = true at x-min, and neither drained nor pore_pressure there".into());
    }
    if !touches(scene, body, Side::Min) {
        return Err("it needs a body that stands on x-min: body.0.min = grid.min".into());
    }
    Ok(())
}

/// The boundary at the top, where the liquid leaves into the open.
fn drained_top(scene: &Scene) -> Result<Option<&Boundary>, Problem> {
    let top = boundary(scene, TOP);
    match top.map(|top| &top.pores) {
        Some(PoreBoundary::Drained) => Ok(top),
        _ => Err("it needs a [[boundary]] at x-max with drained = true".into()),
    }
}

fn no_body_force(scene: &Scene) -> Result<(), Problem> {
    for part in PARTS {
        if body_force(scene, part * scene.time.end)? != 0.0 {
            return Err("it is a solution without weight; expected no load.body_force".into());
        }
    }
    Ok(())
}

fn no_initial_state(body: &Body) -> Result<(), Problem> {
    let vectors = body.velocity.is_some() || body.liquid_velocity.is_some();
    if vectors || body.stress.is_some() || body.pore_pressure.is_some() {
        return Err(
            "it gives the initial state; expected a body without velocity, stress, liquid_velocity and pore_pressure"
                .into(),
        );
    }
    Ok(())
}

fn boundary(scene: &Scene, face: Face) -> Option<&Boundary> {
    scene.boundaries.iter().find(|boundary| boundary.face == face)
}

fn is_open(scene: &Scene, face: Face) -> bool {
    boundary(scene, face).is_some_and(Boundary::is_open)
}

fn body_force(scene: &Scene, time: f64) -> Result<f64, Problem> {
    value_at(scene.body_force.as_ref().and_then(|force| force.first()), time)
}

fn value_at(expression: Option<&crate::scene::Expression>, time: f64) -> Result<f64, Problem> {
    match expression {
        Some(expression) => expression
            .eval_time(time)
            .map_err(|error| Problem::Scene(error.into())),
        None => Ok(0.0),
    }
}
