//! Source: Bishop & Morgenstern (1960), factor of safety 1.380; Griffiths & Lane (1999), example 1: 1.4 by
//! finite elements. Goal: Drucker-Prager clay under gravity stands as long as limit equilibrium says, and
//! slides beyond. Parameters: the compiled-in scene `slope` with its strength over a factor F; 880 particles,
//! gravity within 1 s, 4 s. Expected: F = 1.3 moves by millimetres; what F = 1.45 and 1.6 slide, less than
//! linear creep, extrapolates to nothing at 1.40 (with cells half as large at 1.37).

use materialpoint_command::run::run_in;
use materialpoint_command::scene::Scene;

use super::scene;

/// Largest displacement (m) with the strength over `factor`.
fn slides(factor: f64) -> f64 {
    let angle = (20_f64.to_radians().tan() / factor).atan().to_degrees();
    let set = [
        format!("material.law.drucker-prager.cohesion={:?}", 1e4 / factor),
        format!("material.law.drucker-prager.friction_angle={angle:?}"),
    ];
    let scene = scene(
        Scene::builtin("slope").unwrap(),
        &set.each_ref().map(String::as_str),
    );
    let outcome = run_in::<2>(&scene, None, &mut |_| {}).unwrap();
    let moved = outcome.particles.displacement.iter().map(|u| u.norm());
    moved.fold(0.0, f64::max)
}

#[test]
fn a_slope_fails_at_the_factor_of_safety_of_limit_equilibrium() {
    let stands = slides(1.3);
    assert!(stands < 0.015, "{stands}");
    let [less, more] = [1.45, 1.6].map(slides);
    let safety = 1.45 - less * 0.15 / (more - less);
    assert!((1.36..1.43).contains(&safety), "{safety}: {less}, {more}");
}
