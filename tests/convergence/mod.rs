//! Errors and orders against exact and converged solutions, from both sides: the tables of the method's page.

mod column;
mod consolidation;
mod critical_step;
mod full_period;
mod large_bar;
mod precision;
mod relaxed;
mod small_bar;
mod sub_points;

use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint_command::run::{Summary, run};
use materialpoint_command::scene::Scene;

pub const LINEAR: Basis = Basis::Linear;
pub const DUAL_DOMAIN: Basis = Basis::DualDomain;
pub const BSPLINE: Basis = Basis::BSpline { degree: 2 };
pub const SHEPARD: ReconstructionKind = ReconstructionKind::Shepard;
pub const TAYLOR: ReconstructionKind = ReconstructionKind::Taylor;
pub const SPLINE: ReconstructionKind = ReconstructionKind::Spline;

/// Runs a compiled-in scene with another method.
pub fn summary(scene: &str, method: Method, set: &[&str]) -> Summary {
    let set: Vec<String> = set.iter().map(ToString::to_string).collect();
    let scene = Scene::from_toml(Scene::builtin(scene).unwrap(), &set).unwrap();
    run(&scene.with_method(method), None, &mut |_| {})
        .unwrap()
        .summary
}

/// Whether `found` is within the share `tolerance` of `expected`.
#[track_caller]
pub fn assert_close(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() <= tolerance,
        "{what}: found {found:.4e}, expected {expected:.4e} within {} %",
        100.0 * tolerance
    );
}

/// Observed order of a field's RMS error between two runs with twice the cells.
pub fn order(coarse: &Summary, fine: &Summary, field: &str) -> f64 {
    (coarse.errors[field].rms / fine.errors[field].rms).log2()
}
