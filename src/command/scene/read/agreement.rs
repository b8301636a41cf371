//! Whether the scene is the problem that its reference solves: errors against the solution of another problem
//! would mean nothing.

mod space;
mod two_phase;

use std::f64::consts::PI;

use crate::scene::{Against, Body, BoundaryKind, Law, ReferenceSpec, Scene, SceneError};
use materialpoint::grid::{Face, Side};
use materialpoint::reference::{StaticColumn, Strain};

/// Relative difference up to which two ways of writing the same load or velocity agree.
const TOLERANCE: f64 = 1e-6;

const BASE: Face = Face {
    axis: 0,
    side: Side::Min,
};
const TOP: Face = Face {
    axis: 0,
    side: Side::Max,
};

pub(super) fn check(scene: &Scene) -> Result<(), SceneError> {
    check_dimension(scene)?;
    check_phases(scene)?;
    match scene.reference {
        None => Ok(()),
        Some(ReferenceSpec::VibratingBar { velocity }) => bar(scene, velocity),
        Some(ReferenceSpec::ColumnCompaction {
            body_force,
            ramp,
            against,
        }) => column(scene, body_force, ramp, against),
        Some(ReferenceSpec::Consolidation { load, start }) => two_phase::consolidation(scene, load, start),
        Some(ReferenceSpec::XieLeo { load }) => two_phase::xie_leo(scene, load),
        Some(ReferenceSpec::StandingWave { velocity, mode }) => {
            two_phase::standing_wave(scene, velocity, mode)
        }
        Some(ReferenceSpec::SelfWeight) => two_phase::self_weight(scene),
        Some(ReferenceSpec::Manufactured { amplitude }) => space::manufactured(scene, amplitude),
        Some(ReferenceSpec::Vortex { inner, outer, .. }) => space::vortex(scene, inner, outer),
    }
}

fn check_dimension(scene: &Scene) -> Result<(), SceneError> {
    let found = scene.dimension();
    match scene.reference {
        Some(reference) if !reference.knows_dimension(found) => Err(refuse(
            "grid.cells",
            &format!("{:?}", scene.grid.cells),
            &format!(
                "reference.{} is a solution in another number of dimensions",
                reference.name()
            ),
        )),
        _ => Ok(()),
    }
}

fn check_phases(scene: &Scene) -> Result<(), SceneError> {
    let Some(reference) = scene.reference else {
        return Ok(());
    };
    let (needed, found) = (reference.phases(), scene.material.phases.count());
    if needed == found {
        return Ok(());
    }
    let problem = format!(
        "reference.{} is a solution for {needed} of them; expected material.phases = {needed}",
        reference.name()
    );
    Err(refuse("material.phases", &found.to_string(), &problem))
}

fn bar(scene: &Scene, velocity: f64) -> Result<(), SceneError> {
    let refuse = |problem: &str| {
        refuse(
            "reference.vibrating-bar",
            &format!("{{ velocity = {velocity:?} }}"),
            problem,
        )
    };
    let body = the_body(scene).ok_or_else(|| refuse("it needs exactly one [[body]], without inside"))?;
    if !(is_fixed(scene, BASE) && is_fixed(scene, TOP)) {
        return Err(refuse("it needs fixed = true at x-min and at x-max"));
    }
    if !(touches(scene, body, Side::Min) && touches(scene, body, Side::Max)) {
        return Err(refuse("it needs a body that reaches from grid.min to grid.max"));
    }
    if scene.body_force.is_some() || body.stress.is_some() {
        return Err(refuse("it needs a bar without load.body_force and body.0.stress"));
    }
    let (start, length) = extent(body);
    for part in [0.0, 0.2, 0.5, 0.7, 1.0] {
        let expected = velocity * (PI * part).sin();
        let found = initial_velocity(body, start + part * length)?;
        if (found - expected).abs() > TOLERANCE * velocity.abs() {
            return Err(refuse(&format!(
                "it needs body.0.velocity = velocity*sin(pi*X/length), {expected:.4e} m/s at X = {:.4e} m, \
                 found {found:.4e}",
                part * length
            )));
        }
    }
    Ok(())
}

fn column(scene: &Scene, body_force: f64, ramp: f64, against: Against) -> Result<(), SceneError> {
    let shown = format!("{{ body_force = {body_force:?}, ramp = {ramp:?} }}");
    let refuse = |problem: &str| refuse("reference.column-compaction", &shown, problem);
    let body = the_body(scene).ok_or_else(|| refuse("it needs exactly one [[body]], without inside"))?;
    if !is_fixed(scene, BASE) || scene.boundaries.len() > 1 {
        return Err(refuse(
            "it needs fixed = true at x-min and no [[boundary]] at x-max",
        ));
    }
    if !touches(scene, body, Side::Min) {
        return Err(refuse(
            "it needs a body that stands on x-min: body.0.min = grid.min",
        ));
    }
    if body.velocity.is_some() || body.stress.is_some() {
        return Err(refuse(
            "it needs a column at rest, without body.0.velocity and body.0.stress",
        ));
    }
    for part in [0.0, 0.2, 0.5, 0.7, 1.0] {
        let time = part * scene.time.end;
        let expected = body_force * (time / ramp).min(1.0);
        let found = match scene.body_force.as_ref().and_then(|force| force.first()) {
            Some(force) => force.eval_time(time)?,
            None => 0.0,
        };
        if (found - expected).abs() > TOLERANCE * body_force.abs() {
            return Err(refuse(&format!(
                "it needs load.body_force = body_force*min(t/ramp, 1), {expected:.4e} N/kg at t = {time:.4e} s, found \
                 {found:.4e}"
            )));
        }
    }
    match against {
        Against::Static => static_column(scene, body, body_force).map_err(|problem| refuse(&problem)),
        Against::Dynamic => Ok(()),
    }
}

fn static_column(scene: &Scene, body: &Body, body_force: f64) -> Result<(), String> {
    let (strain, youngs_modulus) = match scene.material.law {
        Law::LinearElastic { youngs_modulus, .. } => (Strain::Small, youngs_modulus),
        Law::Hill { youngs_modulus, .. } => (Strain::Large, youngs_modulus),
        Law::NeoHookean { .. } | Law::Logarithmic { .. } | Law::InSpace(_) => {
            return Err(
                "against = \"static\" knows linear-elastic only; expected against = \"dynamic\"".into(),
            );
        }
    };
    let (_, height) = extent(body);
    StaticColumn::new(
        height,
        scene.material.solid_density(),
        youngs_modulus,
        body_force,
        strain,
    )
    .map(drop)
    .map_err(|error| format!("{error}; expected a smaller body_force or a stiffer law"))
}

fn refuse(key: &str, value: &str, problem: &str) -> SceneError {
    SceneError::Conflict {
        key: key.into(),
        value: value.into(),
        problem: problem.into(),
    }
}

/// The only body, if it is the whole of its box.
fn the_body(scene: &Scene) -> Option<&Body> {
    match scene.bodies.as_slice() {
        [body] if body.inside.is_none() => Some(body),
        _ => None,
    }
}

fn is_fixed(scene: &Scene, face: Face) -> bool {
    let mut there = scene.boundaries.iter().filter(|boundary| boundary.face == face);
    there.any(|boundary| matches!(boundary.kind, BoundaryKind::Fixed))
}

fn touches(scene: &Scene, body: &Body, side: Side) -> bool {
    match side {
        Side::Min => body.min == scene.grid.min,
        Side::Max => body.max == scene.grid.max,
    }
}

/// Lower end and length (m) of a body in one dimension.
fn extent(body: &Body) -> (f64, f64) {
    let first = |values: &[f64]| values.first().copied().unwrap_or(f64::NAN);
    (first(&body.min), first(&body.max) - first(&body.min))
}

fn initial_velocity(body: &Body, x: f64) -> Result<f64, SceneError> {
    match body.velocity.as_ref().and_then(|velocity| velocity.first()) {
        Some(velocity) => Ok(velocity.eval_at(&[x])?),
        None => Ok(0.0),
    }
}
