//! Any bytes as a scene: it is read or refused, and a small one runs a few steps, without a panic.

#![no_main]

use libfuzzer_sys::fuzz_target;
use materialpoint_command::run::run;
use materialpoint_command::scene::{Body, Scene, StepSize};

/// Most cells, and most particles if the bodies fill the grid: more would only be slow.
const MOST: usize = 2000;
const MOST_STEPS: f64 = 20.0;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(mut scene) = Scene::from_toml(text, &[]) else { return };
    if !is_small(&scene) {
        return;
    }
    // Automatic steps may be of any number: they are replaced.
    let step = match scene.time.step {
        StepSize::Fixed(step) => step,
        StepSize::Auto { .. } => scene.time.end / MOST_STEPS,
    };
    scene.time.step = StepSize::Fixed(step);
    scene.time.end = scene.time.end.min(MOST_STEPS * step);
    if let Ok(outcome) = run(&scene, None, &mut |_| {}) {
        assert!(outcome.summary.energy.last.is_finite(), "{:?}", outcome.summary);
    }
});

/// References are converged solutions, which take seconds.
fn is_small(scene: &Scene) -> bool {
    let cells: usize = scene.grid.cells.iter().product();
    let per_cell = |body: &Body| body.particles_per_cell.iter().product::<usize>();
    let most_per_cell = scene.bodies.iter().map(per_cell).max().unwrap_or(0);
    scene.reference.is_none() && cells <= MOST && cells.saturating_mul(most_per_cell) <= MOST
}
