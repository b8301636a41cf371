//! The surfaces of a scene's bodies that the stepper must know.

use std::ops::Range;

use super::initial::first;
use crate::grid::{Face, Side};
use crate::particles::Particles;
use crate::scene::{Body, Boundary, BoundaryKind, Scene};
use crate::stepper::SurfacePoint;

/// The surfaces of `body`, whose particles are those in `range`: in one phase those that bear a traction; in two every end at
/// which a load, a pressure outside or the solid's skin acts on the liquid, that is, all but the held and sealed ones.
pub(super) fn surfaces(
    scene: &Scene,
    body: &Body,
    particles: &Particles<f64, 1>,
    range: Range<usize>,
) -> Vec<SurfacePoint<f64>> {
    let faces = Face::all::<1>().filter(|&face| is_needed(scene, body, face));
    let points = faces.filter_map(|face| {
        let particle = outermost(particles, range.clone(), face)?;
        Some(SurfacePoint {
            particle,
            face,
            area: 1.0,
            reach: reach(body, particles, particle, face),
        })
    });
    points.collect()
}

fn is_needed(scene: &Scene, body: &Body, face: Face) -> bool {
    if touches_another(scene, body, face) {
        return false;
    }
    let boundary = scene.boundaries.iter().find(|boundary| boundary.face == face);
    if scene.material.phases.count() == 1 {
        return boundary.is_some_and(|b| matches!(b.kind, BoundaryKind::Traction(_)));
    }
    let sealed_wall = |boundary: &Boundary| boundary.is_held() && !boundary.is_open();
    let at_face = match face.side {
        Side::Min => body.min == scene.grid.min,
        Side::Max => body.max == scene.grid.max,
    };
    !(at_face && boundary.is_some_and(sealed_wall))
}

fn touches_another(scene: &Scene, body: &Body, face: Face) -> bool {
    scene.bodies.iter().any(|other| match face.side {
        Side::Min => other.max == body.min,
        Side::Max => other.min == body.max,
    })
}

/// Distance of the body's end from the particle, in lengths of the particle.
fn reach(body: &Body, particles: &Particles<f64, 1>, particle: usize, face: Face) -> f64 {
    if body.jitter == 0.0 {
        return 0.5;
    }
    let (x, volume) = (particles.position[particle][0], particles.volume[particle]);
    let distance = match face.side {
        Side::Min => x - first(&body.min),
        Side::Max => first(&body.max) - x,
    };
    // Round-off must not put the surface inside the particle.
    (distance / volume).max(0.0)
}

fn outermost(particles: &Particles<f64, 1>, range: Range<usize>, face: Face) -> Option<usize> {
    let position = |p: &usize| particles.position[*p][0];
    let by_position = |a: &usize, b: &usize| position(a).total_cmp(&position(b));
    match face.side {
        Side::Min => range.min_by(by_position),
        Side::Max => range.max_by(by_position),
    }
}
