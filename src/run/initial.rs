//! Particles of a scene at time zero.

use nalgebra::SVector;

use super::error::RunError;
use super::state::{InitialState, set};
use super::surface::surfaces;
use crate::grid::Grid;
use crate::particles::{Particles, lattice_points};
use crate::phase::PoreLiquid;
use crate::scene::{Body, Scene};
use crate::stepper::SurfacePoint;

/// Particles, their liquid, and the surfaces that the stepper must know.
#[derive(Default)]
pub(super) struct Initial {
    pub(super) particles: Particles<f64, 1>,
    /// In two phases one for each particle.
    pub(super) liquid: Vec<PoreLiquid<f64, 1>>,
    pub(super) surface: Vec<SurfacePoint<f64>>,
}

/// Fills the bodies, gives the particles their initial values and finds the surfaces.
pub(super) fn initial(scene: &Scene, grid: &Grid<f64, 1>) -> Result<Initial, RunError> {
    let mut all = Initial::default();
    for body in &scene.bodies {
        let first = all.particles.len();
        let (particles, liquid) = fill(scene, body, grid)?;
        append(&mut all.particles, particles);
        move_to(&mut all.liquid, liquid);
        let range = first..all.particles.len();
        all.surface.extend(surfaces(scene, body, &all.particles, range));
    }
    Ok(all)
}

fn fill(
    scene: &Scene,
    body: &Body,
    grid: &Grid<f64, 1>,
) -> Result<(Particles<f64, 1>, Vec<PoreLiquid<f64, 1>>), RunError> {
    let (min, max) = (first(&body.min), first(&body.max));
    let per_cell = body.particles_per_cell.first().copied().unwrap_or(1);
    let mut random = fastrand::Rng::with_seed(body.seed);
    let points = lattice_points(grid, &SVector::from([min]), &SVector::from([max]), [per_cell]);
    let points = points.map(|(mut x, spacing)| {
        // Within its own sub-interval, so that particles keep their order and the body its volume.
        x[0] += body.jitter * spacing * (random.f64() - 0.5);
        (x, spacing)
    });
    let mut particles = Particles::from_points(points, scene.material.solid_density());
    let flows = scene.material.phases.count() == 2;
    let mut liquid = Vec::with_capacity(if flows { particles.len() } else { 0 });
    let state = InitialState::new(scene, body, grid)?;
    for p in 0..particles.len() {
        let values = state.at(particles.position[p][0])?;
        set(&mut particles, p, &values);
        if flows {
            liquid.push(values.liquid());
        }
    }
    Ok((particles, liquid))
}

pub(super) fn first(values: &[f64]) -> f64 {
    values.first().copied().unwrap_or(f64::NAN)
}

fn append(all: &mut Particles<f64, 1>, more: Particles<f64, 1>) {
    move_to(&mut all.initial_position, more.initial_position);
    move_to(&mut all.position, more.position);
    move_to(&mut all.displacement, more.displacement);
    move_to(&mut all.velocity, more.velocity);
    move_to(&mut all.stress, more.stress);
    move_to(&mut all.mass, more.mass);
    move_to(&mut all.volume, more.volume);
    all.state.extend(more.state);
    all.phase.extend(more.phase);
}

/// Appends without a copy of the first body's values, and without room to spare.
fn move_to<A>(all: &mut Vec<A>, more: Vec<A>) {
    if all.is_empty() {
        *all = more;
    } else {
        all.reserve_exact(more.len());
        all.extend(more);
    }
}
