//! Source: Cook (1974); the value of the static solution from refined finite elements, 23.96 for plane stress
//! with E = 1, nu = 1/3, load 1. Goal: bending and shear of a body whose sides cut through cells, against a
//! published number. Parameters: the compiled-in scene `cooks-membrane`; plane strain with nu' = nu/(1 + nu)
//! and E' = E (1 - nu'^2) has the same equations in the plane; a hundredth of the load, so that the geometry
//! stays linear; applied slowly, averaged over the second half. Expected: 0.2396 m at the middle of the
//! loaded side. Measured over it with 13, 26 and 52 cells: linear 0.995 1.001 1.005, dual domain 1.030 1.013
//! 1.007, B-splines 1.024 1.011 1.005: first order, as the sides are where particles' volumes end.

use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::stepper::Simulation;
use materialpoint_command::scene::Scene;
use nalgebra::{Matrix3, Vector3};

use super::scene;
use super::watch::watch;

/// Rise of the middle of the loaded side, by a linear fit of the particles near it, over the published one.
fn rise(simulation: &dyn Simulation<2>, cell: f64) -> f64 {
    let particles = simulation.particles();
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (x, u) in particles.initial_position.iter().zip(&particles.displacement) {
        let (x, y) = (x[0] - 48.0, x[1] - 52.0);
        if x > -1.5 * cell && y.abs() < 1.5 * cell {
            let row = Vector3::new(1.0, x, y);
            matrix += row * row.transpose();
            right += row * u[1];
        }
    }
    matrix.try_inverse().unwrap().row(0).transpose().dot(&right) / 0.2396
}

/// Mean rise over the second half of the run.
fn mean_rise(method: Method, cells: usize) -> f64 {
    let refine = cells as f64 / 13.0;
    let step = format!("time.step={:?}", 1.0 / refine);
    let scene = scene(Scene::builtin("cooks-membrane").unwrap(), &[&step]);
    let scene = scene.with_method(method).with_cells(cells);
    let (mut sum, mut count, mut n) = (0.0, 0, 0);
    let (cell, half) = (4.0 / refine, scene.time.end / 2.0);
    watch::<2>(&scene, |time, simulation| {
        n += 1;
        if time > half && n % 10 == 0 {
            sum += rise(simulation, cell);
            count += 1;
        }
    })
    .unwrap();
    sum / f64::from(count)
}
const BASES: [Basis; 3] = [Basis::Linear, Basis::DualDomain, Basis::BSpline { degree: 2 }];

fn check(cells: usize, expected: [f64; 3]) {
    for (basis, expected) in BASES.into_iter().zip(expected) {
        let found = mean_rise(Method::new(basis, ReconstructionKind::Shepard), cells);
        assert!(
            (found - expected).abs() < 2e-3,
            "{basis:?}: {found:.4}, expected {expected}"
        );
    }
}

#[test]
fn the_corner_rises_as_published() {
    check(13, [0.995, 1.030, 1.024]);
    check(26, [1.001, 1.013, 1.011]);
}

#[test]
#[ignore = "20 s: cargo test --release the_error_of_the_rise_halves -- --ignored"]
fn the_error_of_the_rise_halves_with_the_cells() {
    check(52, [1.005, 1.007, 1.005]);
}

/// It stays within 2 %, and nearer to 1 than particle sums with dual domain and B-splines. With a rate per
/// time towards the fits with the neighbours it crept under the lasting load (0.977, 0.973, 1.006).
#[test]
fn relaxed_taylor_bears_slanted_free_sides() {
    for (basis, expected) in BASES.into_iter().zip([0.982, 1.004, 1.000]) {
        let found = mean_rise(Method::new(basis, ReconstructionKind::RelaxedTaylor), 13);
        assert!((found - expected).abs() < 3e-3, "{basis:?}: {found:.4}");
    }
}
