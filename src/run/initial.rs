//! Particles of a scene at time zero.

use nalgebra::SVector;

use super::error::RunError;
use crate::grid::{Face, Grid, Side};
use crate::particles::{Particles, lattice};
use crate::scene::{Body, BoundaryKind, Scene};
use crate::stepper::SurfacePoint;

/// Particles and loaded surfaces.
pub(super) struct Initial {
    pub(super) particles: Particles<f64, 1>,
    pub(super) surface: Vec<SurfacePoint<f64>>,
}

/// Fills the bodies, gives the particles their initial values and finds the loaded surfaces.
pub(super) fn initial(scene: &Scene, grid: &Grid<f64, 1>) -> Result<Initial, RunError> {
    let mut particles = Particles::default();
    let mut surface = Vec::new();
    for body in &scene.bodies {
        let first = particles.len();
        let filled = fill(scene, body, grid)?;
        append(&mut particles, filled);
        let range = first..particles.len();
        for face in loaded_faces(scene, body) {
            if let Some(particle) = outermost(&particles, range.clone(), face) {
                surface.push(SurfacePoint {
                    particle,
                    face,
                    area: 1.0,
                    reach: 0.5,
                });
            }
        }
    }
    Ok(Initial { particles, surface })
}

fn fill(scene: &Scene, body: &Body, grid: &Grid<f64, 1>) -> Result<Particles<f64, 1>, RunError> {
    let (min, max) = (first(&body.min), first(&body.max));
    let per_cell = body.particles_per_cell.first().copied().unwrap_or(1);
    let mut points = lattice(grid, &SVector::from([min]), &SVector::from([max]), [per_cell]);
    let mut random = fastrand::Rng::with_seed(body.seed);
    for (x, spacing) in &mut points {
        // Within its own sub-interval, so that particles keep their order and the body its volume.
        x[0] += body.jitter * *spacing * (random.f64() - 0.5);
    }
    let mut particles: Particles<f64, 1> = Particles::at_rest(&points, scene.material.density);
    for p in 0..particles.len() {
        let x = [particles.position[p][0]];
        if let Some(velocity) = body.velocity.as_ref().and_then(|v| v.first()) {
            particles.velocity[p][0] = velocity.eval_at(&x)?;
        }
        if let Some(stress) = &body.stress {
            particles.stress[p][(0, 0)] = stress.eval_at(&x)?;
        }
    }
    Ok(particles)
}

fn first(values: &[f64]) -> f64 {
    values.first().copied().unwrap_or(f64::NAN)
}

fn append(all: &mut Particles<f64, 1>, more: Particles<f64, 1>) {
    all.initial_position.extend(more.initial_position);
    all.position.extend(more.position);
    all.displacement.extend(more.displacement);
    all.velocity.extend(more.velocity);
    all.stress.extend(more.stress);
    all.mass.extend(more.mass);
    all.volume.extend(more.volume);
    all.state.extend(more.state);
    all.phase.extend(more.phase);
}

/// Faces with a traction that the body looks at freely: no other body touches it on that side.
fn loaded_faces<'a>(scene: &'a Scene, body: &'a Body) -> impl Iterator<Item = Face> + 'a {
    let tractions = scene
        .boundaries
        .iter()
        .filter(|b| matches!(b.kind, BoundaryKind::Traction(_)));
    tractions.map(|b| b.face).filter(move |face| {
        !scene.bodies.iter().any(|other| match face.side {
            Side::Min => other.max == body.min,
            Side::Max => other.min == body.max,
        })
    })
}

fn outermost(particles: &Particles<f64, 1>, range: std::ops::Range<usize>, face: Face) -> Option<usize> {
    let position = |p: &usize| particles.position[*p][0];
    let by_position = |a: &usize, b: &usize| position(a).total_cmp(&position(b));
    match face.side {
        Side::Min => range.min_by(by_position),
        Side::Max => range.max_by(by_position),
    }
}
