//! Source: method page, section 9; Steffen, Wallstedt, Guilkey, Kirby & Berzins (2008). Goal: the stepper of
//! one dimension is right in two and three, at finite strain with particles that cross cells. Parameters: the
//! compiled-in scene `manufactured`; 8 and 16 cells a side in 2-D, 4 and 8 in 3-D, 3 particles per cell and
//! axis. Expected: relative L2 errors of the stress as measured, within 10 %, none above a prototype's (8, 16
//! cells): linear Shepard .22 .43, linear TLS .087 .043, B-spline Shepard .15 .073, B-spline TLS .078 .032,
//! linear relaxed .064 .029, B-spline relaxed .0083 .0075; mass and momentum at round-off.

use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint_command::run::{InSpace, Summary, run_in};
use materialpoint_command::scene::Scene;

use super::scene;

const LINEAR: Basis = Basis::Linear;
const DUAL_DOMAIN: Basis = Basis::DualDomain;
const BSPLINE: Basis = Basis::BSpline { degree: 2 };
use ReconstructionKind::{RelaxedTaylor, Shepard, Taylor};

fn summary<const D: usize>(text: &str, method: Method, cells: usize, set: &[&str]) -> Summary
where
    Scene: InSpace<D>,
{
    let step = format!("time.step={:?}", 0.125 / cells as f64 / 100.0);
    let set = [set, &[&step]].concat();
    let scene = scene(text, &set).with_method(method).with_cells(cells);
    let summary = run_in::<D>(&scene, None, &mut |_| {}).unwrap().summary;
    let kept = &summary.conservation["solid"];
    assert!(
        kept.mass < 5e-13 && kept.momentum_scaled < 1e-13,
        "{method} {kept:?}"
    );
    summary
}

fn plane(basis: Basis, reconstruction: ReconstructionKind, cells: usize, set: &[&str]) -> f64 {
    let text = Scene::builtin("manufactured").unwrap();
    let method = Method::new(basis, reconstruction);
    summary::<2>(text, method, cells, set).errors["stress"].relative_l2
}

fn check(basis: Basis, reconstruction: ReconstructionKind, expected: [f64; 2]) {
    check_with(basis, reconstruction, &[], expected);
}

#[track_caller]
fn check_with(basis: Basis, reconstruction: ReconstructionKind, set: &[&str], expected: [f64; 2]) {
    let found = [8, 16].map(|cells| plane(basis, reconstruction, cells, set));
    for (found, expected) in found.into_iter().zip(expected) {
        assert!(
            (found / expected - 1.0).abs() < 0.1,
            "{found:.3e}, expected {expected:.3e}"
        );
    }
}

#[test]
fn shepard_stalls_or_diverges_where_particles_cross() {
    check(LINEAR, Shepard, [2.19e-1, 4.30e-1]);
    check(DUAL_DOMAIN, Shepard, [1.32e-1, 3.85e-2]);
    check(BSPLINE, Shepard, [1.48e-1, 7.26e-2]);
}

#[test]
fn taylor_converges_at_first_order() {
    check(LINEAR, Taylor, [8.50e-2, 3.98e-2]);
    check(DUAL_DOMAIN, Taylor, [7.10e-2, 2.43e-2]);
    check(BSPLINE, Taylor, [7.65e-2, 2.81e-2]);
}

#[test]
fn relaxed_taylor_is_the_most_accurate_with_every_basis() {
    check(LINEAR, RelaxedTaylor, [3.82e-2, 1.55e-2]);
    check(DUAL_DOMAIN, RelaxedTaylor, [2.48e-2, 8.85e-3]);
    check(BSPLINE, RelaxedTaylor, [4.54e-3, 1.28e-3]);
}

/// Fits of irregular layouts that kept every function with 2 % left did not converge, or the run stopped.
#[test]
fn jittered_particles_converge_too() {
    let jitter = ["body.0.jitter=0.6"];
    check_with(LINEAR, Taylor, &jitter, [9.65e-2, 4.84e-2]);
    check_with(BSPLINE, Taylor, &jitter, [9.10e-2, 4.22e-2]);
    check_with(LINEAR, RelaxedTaylor, &jitter, [5.00e-2, 1.53e-2]);
    // 1.89e-2 before cells in which particles see no squares were tied.
    check_with(BSPLINE, RelaxedTaylor, &jitter, [1.17e-2, 5.70e-3]);
    // On 32 cells the error with 2 % was 0.27.
    assert!(plane(LINEAR, Taylor, 32, &jitter) < 4e-2);
}

/// Measured from 8 to 16 cells 1.83, from 16 to 32 cells 1.61; a prototype stalled at 7e-3.
#[test]
fn relaxed_taylor_with_b_splines_does_not_stall() {
    let (coarse, fine) = (
        plane(BSPLINE, RelaxedTaylor, 16, &[]),
        plane(BSPLINE, RelaxedTaylor, 32, &[]),
    );
    let order = (coarse / fine).log2();
    assert!((1.5..1.9).contains(&order), "{order}");
}

#[test]
fn three_dimensions_converge_too() {
    let text = Scene::builtin("manufactured").unwrap();
    let set = [
        "grid={min=[0,0,0], max=[1,1,1], cells=[4,4,4]}",
        "body=[{min=[0,0,0], max=[1,1,1], particles_per_cell=[3,3,3]}]",
        "boundary=[{face=\"x-min\", roller=true}, {face=\"x-max\", roller=true}, {face=\"y-min\", roller=true}, {face=\"y-max\", roller=true}, {face=\"z-min\", roller=true}, {face=\"z-max\", roller=true}]",
    ];
    let error = |method, cells| summary::<3>(text, method, cells, &set).errors["stress"].relative_l2;
    let method = |reconstruction| Method::new(BSPLINE, reconstruction);
    let (coarse, fine) = (error(method(Taylor), 4), error(method(Taylor), 8));
    let order = (coarse / fine).log2();
    assert!(order > 0.7 && order < 4.0, "{order}");
    assert!(error(method(RelaxedTaylor), 4) < coarse);
}
