//! References in two and three dimensions.

use super::refuse;
use crate::grid::{Face, Side};
use crate::scene::{BoundaryKind, Law, Scene, SceneError};

pub(super) fn manufactured(scene: &Scene, amplitude: f64) -> Result<(), SceneError> {
    let shown = format!("{{ amplitude = {amplitude:?} }}");
    let refuse = |problem: &str| Err(refuse("reference.manufactured", &shown, problem));
    if !matches!(scene.material.law, Law::NeoHookean { .. }) {
        return refuse("it needs material.law.neo-hookean");
    }
    let [body] = scene.bodies.as_slice() else {
        return refuse("it needs exactly one [[body]]");
    };
    if body.min != scene.grid.min || body.max != scene.grid.max || body.inside.is_some() {
        return refuse("it needs a body that fills the grid");
    }
    if body.velocity.is_some() || body.stress.is_some() || scene.body_force.is_some() {
        return refuse(
            "it gives initial state and body force; expected a scene without body.0.velocity, body.0.stress and \
             load.body_force",
        );
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
