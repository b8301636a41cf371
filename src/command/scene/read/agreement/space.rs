//! References in two and three dimensions.

use std::f64::consts::TAU;

use super::refuse;
use crate::scene::{Body, BoundaryKind, Law, Scene, SceneError};
use materialpoint::grid::{Face, Side};

/// The body of a reference that drives it from its initial state on, or what is in the way.
fn driven_body(scene: &Scene) -> Result<&Body, &'static str> {
    if !matches!(scene.material.law, Law::NeoHookean { .. }) {
        return Err("it needs material.law.neo-hookean");
    }
    let [body] = scene.bodies.as_slice() else {
        return Err("it needs exactly one [[body]]");
    };
    if body.velocity.is_some() || body.stress.is_some() || scene.body_force.is_some() {
        return Err(
            "it gives initial state and body force; expected a scene without body.0.velocity, body.0.stress and \
             load.body_force",
        );
    }
    Ok(body)
}

/// Places at which the ring is looked for: along the radius, and around.
const PLACES: [usize; 2] = [20, 40];

pub(super) fn vortex(scene: &Scene, inner: f64, outer: f64) -> Result<(), SceneError> {
    let shown = format!("{{ inner = {inner:?}, outer = {outer:?}, ... }}");
    let refuse = |problem: &str| Err(refuse("reference.vortex", &shown, problem));
    let body = match driven_body(scene) {
        Ok(body) => body,
        Err(problem) => return refuse(problem),
    };
    let at_rest = |kind: &BoundaryKind| matches!(kind, BoundaryKind::Fixed | BoundaryKind::Roller);
    if let Some(boundary) = scene.boundaries.iter().find(|b| !at_rest(&b.kind)) {
        let face = boundary.face;
        return refuse(&format!(
            "nothing moves outside of the ring; expected fixed or roller at {face} or no [[boundary]] there"
        ));
    }
    let corners = scene.grid.min.iter().zip(&scene.grid.max);
    let centre: Vec<f64> = corners.map(|(min, max)| (min + max) / 2.0).collect();
    for k in 0..PLACES[0] * PLACES[1] {
        let part = ((k / PLACES[1]) as f64 + 0.5) / PLACES[0] as f64;
        let (sin, cos) = (TAU * (k % PLACES[1]) as f64 / PLACES[1] as f64).sin_cos();
        let radius = inner + (outer - inner) * part;
        let mut point = centre.clone();
        for (x, direction) in point.iter_mut().zip([cos, sin]) {
            *x += radius * direction;
        }
        if !body.holds(&point)? {
            return refuse(&format!(
                "it needs a body that holds the ring about the middle of the grid; at {point:.3?} there is none"
            ));
        }
    }
    Ok(())
}

pub(super) fn manufactured(scene: &Scene, amplitude: f64) -> Result<(), SceneError> {
    let shown = format!("{{ amplitude = {amplitude:?} }}");
    let refuse = |problem: &str| Err(refuse("reference.manufactured", &shown, problem));
    let body = match driven_body(scene) {
        Ok(body) => body,
        Err(problem) => return refuse(problem),
    };
    if body.min != scene.grid.min || body.max != scene.grid.max || body.inside.is_some() {
        return refuse("it needs a body that fills the grid");
    }
    let is_roller = |face: Face| {
        let mut boundaries = scene.boundaries.iter();
        boundaries.any(|b| b.face == face && matches!(b.kind, BoundaryKind::Roller))
    };
    let mut faces =
        (0..scene.dimension()).flat_map(|axis| [Side::Min, Side::Max].map(|side| Face { axis, side }));
    match faces.find(|&face| !is_roller(face)) {
        None => Ok(()),
        Some(face) => refuse(&format!("it needs roller = true at every face, also at {face}")),
    }
}
