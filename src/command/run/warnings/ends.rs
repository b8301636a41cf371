//! Tractions that act nowhere, or where they are perhaps not meant to.

use super::super::dispatch::grid;
use super::super::error::RunError;
use super::super::initial::fill;
use super::super::surface::{acts_at, ends, rows};
use crate::scene::{Boundary, BoundaryKind, Scene};
use materialpoint::grid::Face;

pub(super) fn warnings<const D: usize>(scene: &Scene) -> Result<Vec<String>, RunError> {
    let mut found = Vec::new();
    for (index, boundary) in scene.boundaries.iter().enumerate() {
        // Whole boxes have no hole, and a load that is not told where to act acts on all of them.
        let shaped = scene.bodies.iter().any(|body| body.inside.is_some());
        let loads = matches!(boundary.kind, BoundaryKind::Traction(_));
        if loads && (shaped || boundary.inside.is_some()) {
            found.extend(of_traction::<D>(scene, index, boundary)?);
        }
    }
    Ok(found)
}

fn of_traction<const D: usize>(
    scene: &Scene,
    index: usize,
    boundary: &Boundary,
) -> Result<Option<String>, RunError> {
    let (grid, face) = (grid::<f64, D>(scene)?, boundary.face);
    let (mut all, mut loaded, mut holes) = (0, 0, 0);
    for body in &scene.bodies {
        let filling = fill(scene, body, &grid)?;
        let found = ends(&filling, face);
        all += found.len();
        holes += found.len().saturating_sub(rows(&filling, face));
        for end in found {
            loaded += usize::from(is_loaded(scene, face, &filling, end.particle)?);
        }
    }
    let problem = match &boundary.inside {
        Some(inside) if loaded == 0 => Some(format!(
            "{} is positive at none of the {all} particles of the surfaces that look towards {face}: the \
             traction acts nowhere",
            inside.origin()
        )),
        None if holes > 0 => Some(format!(
            "boundary.{index}.traction acts on every surface that looks towards {face}, also on {holes} \
             particles at holes and notches before the last ones of their rows; say by \
             boundary.{index}.inside where it is to act if that is not meant"
        )),
        _ => None,
    };
    Ok(problem)
}

fn is_loaded<const D: usize>(
    scene: &Scene,
    face: Face,
    filling: &super::super::initial::Filling<D>,
    particle: usize,
) -> Result<bool, RunError> {
    match filling.particles.position.get(particle) {
        Some(x) => acts_at(scene, face, x),
        None => Ok(false),
    }
}
