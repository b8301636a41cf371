//! Particles of a scene at time zero.

use nalgebra::SVector;

use super::dispatch::{grid, per_axis};
use super::error::RunError;
use super::space::InSpace;
use super::state::set;
use super::surface::surfaces;
use crate::scene::{Body, Scene};
use materialpoint::grid::Grid;
use materialpoint::particles::{Lattice, Particles};
use materialpoint::phase::PoreLiquid;
use materialpoint::stepper::SurfacePoint;

/// Particles, their liquid, and the surfaces that the stepper must know.
#[derive(Default)]
pub(super) struct Initial<const D: usize> {
    pub(super) particles: Particles<f64, D>,
    /// In two phases one for each particle.
    pub(super) liquid: Vec<PoreLiquid<f64, D>>,
    pub(super) surface: Vec<SurfacePoint<f64>>,
    /// Number of the first particle of each body.
    pub(super) first_particles: Vec<usize>,
}

/// The particles of one body, and where each is in its lattice.
pub(super) struct Filling<const D: usize> {
    pub(super) lattice: Lattice<f64, D>,
    /// Particles of the lattice that are kept, ascending.
    pub(super) kept: Vec<usize>,
    pub(super) particles: Particles<f64, D>,
}

/// Fills the bodies, gives the particles their initial values and finds the surfaces; the run takes steps of
/// `dt` (s).
pub(super) fn initial<const D: usize>(
    scene: &Scene,
    grid: &Grid<f64, D>,
    dt: f64,
) -> Result<Initial<D>, RunError>
where
    Scene: InSpace<D>,
{
    let mut all = Initial::default();
    for (index, body) in scene.bodies.iter().enumerate() {
        let mut filling = fill(scene, body, grid)?;
        if filling.kept.is_empty() {
            return Err(RunError::EmptyBody { index });
        }
        let state = scene.initial_state(body, grid, dt)?;
        let flows = scene.material.phases.count() == 2;
        let mut liquid = Vec::with_capacity(if flows { filling.kept.len() } else { 0 });
        for p in 0..filling.kept.len() {
            let values = state(&filling.particles.position[p])?;
            set(&mut filling.particles, p, &values);
            if flows {
                liquid.push(values.liquid());
            }
        }
        all.surface
            .extend(surfaces(scene, body, &filling, all.particles.len())?);
        all.first_particles.push(all.particles.len());
        append(&mut all.particles, filling.particles);
        move_to(&mut all.liquid, liquid);
    }
    Ok(all)
}

/// How many particles each body has.
pub(super) fn body_sizes<const D: usize>(scene: &Scene) -> Result<Vec<usize>, RunError> {
    let grid = grid(scene)?;
    let size = |body| keep::<D>(body, &grid).map(|(_, kept)| kept.len());
    scene.bodies.iter().map(size).collect()
}

/// The lattice of a body, and its particles that are kept, ascending.
pub(super) fn keep<const D: usize>(
    body: &Body,
    grid: &Grid<f64, D>,
) -> Result<(Lattice<f64, D>, Vec<usize>), RunError> {
    let corner = |values: &[f64]| SVector::from(per_axis(values, f64::NAN));
    let (min, max) = (corner(&body.min), corner(&body.max));
    let lattice = Lattice::new(grid, &min, &max, per_axis(&body.particles_per_cell, 1));
    let mut kept = Vec::with_capacity(lattice.len());
    for k in 0..lattice.len() {
        let inside = match &body.inside {
            Some(expression) => expression.eval_at(lattice.position(k).as_slice())? > 0.0,
            None => true,
        };
        if inside {
            kept.push(k);
        }
    }
    Ok((lattice, kept))
}

/// The particles of a body before they are given their initial values.
pub(super) fn fill<const D: usize>(
    scene: &Scene,
    body: &Body,
    grid: &Grid<f64, D>,
) -> Result<Filling<D>, RunError> {
    let (lattice, kept) = keep(body, grid)?;
    let mut random = fastrand::Rng::with_seed(body.seed);
    let (spacing, volume) = (lattice.spacing(), lattice.volume());
    let points = kept.iter().map(|&k| {
        // Within its own sub-box, so that particles keep their order and the body its volume.
        let shift = spacing.map(|spacing| body.jitter * spacing * (random.f64() - 0.5));
        (lattice.position(k) + shift, volume)
    });
    let particles = Particles::from_points(points, scene.material.solid_density());
    Ok(Filling {
        lattice,
        kept,
        particles,
    })
}

fn append<const D: usize>(all: &mut Particles<f64, D>, more: Particles<f64, D>) {
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
