//! Faces of the grid that cannot do what is asked of them.

use super::super::dispatch::grid;
use super::super::error::RunError;
use super::super::initial::keep;
use super::super::space::InSpace;
use super::{over_time, range};
use crate::scene::{Body, BoundaryKind, Expression, Scene};
use materialpoint::grid::{Face, Grid, Side};

pub(super) fn warnings<const D: usize>(scene: &Scene) -> Result<Vec<String>, RunError>
where
    Scene: InSpace<D>,
{
    let grid = grid(scene)?;
    let mut found = Vec::new();
    for face in Face::all::<D>() {
        found.extend(travels(scene, &grid, face)?);
        for (index, body) in scene.bodies.iter().enumerate() {
            if let Some(load) = load_into(scene, body, &grid, face)? {
                found.push(format!(
                    "body.{index} touches {face}, nothing holds it there, and {load} leads it out of the \
                     grid; expected a [[boundary]] \
                     with face = \"{face}\" and fixed, roller or friction, or a grid with room there"
                ));
            }
        }
    }
    Ok(found)
}

/// Direction out of the grid.
fn outwards(face: Face) -> f64 {
    match face.side {
        Side::Min => -1.0,
        Side::Max => 1.0,
    }
}

/// A face that is told a velocity holds the grid's end, which stays where it is: material that it would have
/// pushed further than a cell is beyond its reach, and material that it pulls out leaves the grid.
fn travels<const D: usize>(
    scene: &Scene,
    grid: &Grid<f64, D>,
    face: Face,
) -> Result<Option<String>, RunError> {
    let mut there = scene.boundaries.iter().filter(|boundary| boundary.face == face);
    let Some(normal) = there.find_map(|boundary| match &boundary.kind {
        BoundaryKind::Velocity(velocity)
        | BoundaryKind::Frictional {
            velocity: Some(velocity),
            ..
        } => velocity.get(face.axis),
        _ => None,
    }) else {
        return Ok(None);
    };
    let way = way(scene, normal)?;
    let cell = grid.cell_size()[face.axis];
    let [inwards, out] = match face.side {
        Side::Min => [way[1], -way[0]],
        Side::Max => [-way[0], way[1]],
    };
    let touched = scene.bodies.iter().any(|body| touches(scene, body, face));
    let problem = if inwards > cell {
        format!(
            "it would come in by {inwards:.3e} m, and material further than a cell, {cell:.3e} m, is beyond its \
             reach"
        )
    } else if touched && out > cell / 2.0 {
        format!("it would go out by {out:.3e} m, and what follows it leaves the grid")
    } else {
        return Ok(None);
    };
    Ok(Some(format!(
        "{}: the velocity holds at the grid's face, which stays where it is; {problem}. Walls that travel \
         are not there yet; move the body \
         instead, or load it by a traction",
        normal.origin()
    )))
}

/// Lowest and highest of the way (m) that the velocity leads, by the trapezoidal rule.
fn way(scene: &Scene, velocity: &Expression) -> Result<[f64; 2], RunError> {
    let step = scene.time.end / super::TIMES as f64;
    let (mut place, mut range, mut before) = (0.0_f64, [0.0_f64, 0.0_f64], None);
    for value in over_time(scene, velocity) {
        let value = value?;
        if let Some(before) = before {
            place += step * (before + value) / 2.0;
        }
        before = Some(value);
        range = [range[0].min(place), range[1].max(place)];
    }
    Ok(range)
}

/// Whether the body's box ends at the face.
fn touches(scene: &Scene, body: &Body, face: Face) -> bool {
    let same = |a: &[f64], b: &[f64]| a.get(face.axis) == b.get(face.axis);
    match face.side {
        Side::Min => same(&body.min, &scene.grid.min),
        Side::Max => same(&body.max, &scene.grid.max),
    }
}

/// What leads the body into a face that it touches and that does not hold it, by key and value.
fn load_into<const D: usize>(
    scene: &Scene,
    body: &Body,
    grid: &Grid<f64, D>,
    face: Face,
) -> Result<Option<String>, RunError>
where
    Scene: InSpace<D>,
{
    let mut there = scene.boundaries.iter().filter(|boundary| boundary.face == face);
    let stops = |kind: &BoundaryKind| !matches!(kind, BoundaryKind::Free | BoundaryKind::Traction(_));
    if there.any(|boundary| stops(&boundary.kind)) || !touches(scene, body, face) {
        return Ok(None);
    }
    // A reference that drives the run decides by itself.
    if scene.driver()?.is_some() {
        return Ok(None);
    }
    let (lattice, kept) = keep(body, grid)?;
    let upwards = face.side == Side::Max;
    let mut last = kept
        .iter()
        .filter(|&&k| lattice.neighbour(k, face.axis, upwards).is_none())
        .peekable();
    // The shape may end before its box does.
    if last.peek().is_none() {
        return Ok(None);
    }
    let leads_out = |expression: &Expression| -> Result<bool, RunError> {
        let [low, high] = range(scene, expression)?;
        Ok(outwards(face) * high > 0.0 || outwards(face) * low > 0.0)
    };
    let force = scene.body_force.iter().filter_map(|force| force.get(face.axis));
    let tractions = scene
        .boundaries
        .iter()
        .filter_map(|boundary| match &boundary.kind {
            BoundaryKind::Traction(traction) => traction.get(face.axis),
            _ => None,
        });
    for load in force.chain(tractions) {
        if leads_out(load)? {
            return Ok(Some(load.origin().to_owned()));
        }
    }
    let Some(velocity) = body
        .velocity
        .as_ref()
        .and_then(|velocity| velocity.get(face.axis))
    else {
        return Ok(None);
    };
    for &k in last {
        if outwards(face) * velocity.eval_at(lattice.position(k).as_slice())? > 0.0 {
            return Ok(Some(format!("its velocity ({})", velocity.origin())));
        }
    }
    Ok(None)
}
