//! The critical time step: the eigenvalue estimate against the running scheme.
//!
//! The small bar with a tiny amplitude (no particle crosses), 20 cells, 12 particles per cell, 3000 steps: at
//! 0.97 of the estimate the energy stays below twice the initial, at 1.05 of it the run blows up or leaves
//! the grid. All methods, and sub-points.

use super::*;
use materialpoint_command::run::critical_step;

fn scene(method: Method, step: f64) -> Scene {
    let set = [
        "grid.cells=[20]".to_owned(),
        "body.0.velocity=[\"1e-9*sin(pi*x)\"]".to_owned(),
        "reference.vibrating-bar.velocity=1e-9".to_owned(),
        format!("time.step={step:e}"),
        format!("time.end={:e}", 3000.0 * step),
    ];
    let scene = Scene::from_toml(Scene::builtin("vibrating-bar-small").unwrap(), &set).unwrap();
    scene.with_method(method)
}

#[test]
fn the_estimate_separates_stable_from_unstable_runs() {
    for method in Method::ALL.into_iter().chain([Method::sub_points(4)]) {
        let critical = critical_step(&scene(method, 1e-7)).unwrap().unwrap().step;
        let highest = |share: f64| match run(&scene(method, share * critical), None, &mut |_| {}) {
            Ok(outcome) => outcome.summary.energy.highest_ratio.unwrap(),
            Err(_) => f64::INFINITY,
        };
        let (below, above) = (highest(0.97), highest(1.05));
        assert!(below < 2.0, "{method}: {below:e} at 0.97 of {critical:e} s");
        assert!(above > 1e3, "{method}: {above:e} at 1.05 of {critical:e} s");
    }
}
