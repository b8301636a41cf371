//! What the tests of several solutions share.

/// Central difference of sixth order.
pub(super) fn derivative(f: impl Fn(f64) -> f64, x: f64, step: f64) -> f64 {
    let difference = |k: f64| f(x + k * step) - f(x - k * step);
    (45.0 * difference(1.0) - 9.0 * difference(2.0) + difference(3.0)) / (60.0 * step)
}

#[track_caller]
pub(super) fn assert_close(a: f64, b: f64, tolerance: f64) {
    assert!(
        (a - b).abs() <= tolerance,
        "{a:e} against {b:e}, tolerance {tolerance:e}"
    );
}
