//! Source: Galilei. Goal: a body without stress that moves or falls freely stays as it is, wherever it lies
//! in its cells, in two and three dimensions. Parameters: a box whose sides fit no cell, particles moved at
//! random, crosses a cell and a half on a slant; the same under a body force. Expected: equal velocities map
//! to equal velocities where mass and momentum are both sums over the particles (Shepard, relaxed TLS), and
//! cause no strain: exact to round-off. Published TLS fits mass and momentum by the same functions, also
//! beyond the body's sides, where it knows no surface beyond one dimension: as exact, since its densities are
//! positive.

use materialpoint::error::StepError;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint_command::run::InSpace;
use materialpoint_command::scene::Scene;
use nalgebra::SVector;

use super::scene;
use super::watch::watch;
use ReconstructionKind::{RelaxedTaylor, Shepard, Taylor};

const BASES: [Basis; 3] = [Basis::Linear, Basis::DualDomain, Basis::BSpline { degree: 2 }];

const FLIGHT: &str = r#"
title = "Flight"
[grid]
min = [0, 0]
max = [1, 1]
cells = [8, 8]
[time]
step = 2.5e-3
end = 0.5
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 10, poissons_ratio = 0.3 }
density = 2
[[body]]
min = [0.15, 0.31]
max = [0.53, 0.62]
particles_per_cell = [3, 3]
jitter = 0.5
seed = 4
velocity = ["0.4", "-0.3"]
[output]
particles = "none"
"#;

const IN_SPACE: [&str; 3] = [
    "grid={min=[0, 0, 0], max=[1, 1, 1], cells=[6, 6, 6]}",
    "body=[{min=[0.17, 0.37, 0.36], max=[0.55, 0.74, 0.66], particles_per_cell=[2, 2, 2], jitter=0.5, velocity=[\"0.4\", \"-0.3\", \"0.2\"]}]",
    "time.step=5e-3",
];

/// Largest departures of velocity and stress from what is exact, over the speed and the modulus, of all
/// particles and times.
fn departures<const D: usize>(scene: &Scene, velocity: SVector<f64, D>) -> Result<[f64; 2], StepError>
where
    Scene: InSpace<D>,
{
    let mut worst = [0.0_f64; 2];
    let force = scene.body_force.as_ref().map_or(SVector::zeros(), |force| {
        SVector::from_fn(|axis, _| force[axis].eval_time(0.0).unwrap())
    });
    watch::<D>(scene, |time, simulation| {
        let particles = simulation.particles();
        let exact = velocity + force * time;
        for (v, stress) in particles.velocity.iter().zip(&particles.stress) {
            worst[0] = worst[0].max((v - exact).norm() / velocity.norm());
            worst[1] = worst[1].max(stress.norm() / 10.0);
        }
    })?;
    Ok(worst)
}

fn flights(reconstruction: ReconstructionKind, set: [&str; 2]) -> Vec<(Method, Result<[f64; 2], StepError>)> {
    let mut found = Vec::new();
    for basis in BASES {
        let method = Method::new(basis, reconstruction);
        let plane = scene(FLIGHT, &[set[0]]).with_method(method);
        found.push((method, departures::<2>(&plane, SVector::from([0.4, -0.3]))));
        let space = scene(FLIGHT, &[&IN_SPACE[..], &[set[1]]].concat()).with_method(method);
        found.push((method, departures::<3>(&space, SVector::from([0.4, -0.3, 0.2]))));
    }
    found
}

const FREE: [&str; 2] = ["load={}", "load={}"];
const FALLING: [&str; 2] = [
    "load={body_force=[\"0.1\", \"-0.3\"]}",
    "load={body_force=[\"0.1\", \"-0.3\", \"-0.4\"]}",
];

fn is_exact(found: &Result<[f64; 2], StepError>) -> bool {
    matches!(found, Ok([velocity, stress]) if *velocity < 1e-13 && *stress < 1e-13)
}

/// Measured: 1.4e-14 at most, in the plane and in space.
#[test]
fn particle_sums_move_and_fall_exactly() {
    for (method, found) in [FREE, FALLING].into_iter().flat_map(|set| flights(Shepard, set)) {
        assert!(is_exact(&found), "{method}: {found:?}");
    }
}

/// Measured: 6e-14 at most.
#[test]
fn relaxed_taylor_moves_exactly() {
    for (method, found) in flights(RelaxedTaylor, FREE) {
        assert!(is_exact(&found), "{method}: {found:?}");
    }
}

#[test]
fn relaxed_taylor_falls_exactly_in_the_plane() {
    for basis in BASES {
        let scene = scene(FLIGHT, &[FALLING[0]]).with_method(Method::new(basis, RelaxedTaylor));
        let found = departures::<2>(&scene, SVector::from([0.4, -0.3]));
        assert!(is_exact(&found), "{basis:?}: {found:?}");
    }
}

/// Measured: 3e-15 at most. With densities that may be negative it lost 1.6e-4 (linear), 4.6e-5 (dual domain)
/// and 7e-6 (B-splines) of the speed in the plane: the matrix of the masses was not positive.
#[test]
fn published_taylor_moves_exactly() {
    for (method, found) in flights(Taylor, FREE) {
        assert!(is_exact(&found), "{method}: {found:?}");
    }
}
