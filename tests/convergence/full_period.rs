//! Vibrating bar, small strain, one full period 2 H sqrt(rho/E) = 33.8 ms: measures the motion and not the
//! mapping alone.
//!
//! Steps of 1/8000 of the period, so that the time error stays below the spatial one; 12 particles per cell;
//! exact solution. After a whole period displacement and stress pass through zero: their errors are those of
//! the phase, second order for all nine methods. With 40 cells the particles next to the edges cross them (u
//! = 1.5 mm against 1.0 mm), and the linear functions, whose gradients jump there, lose the order; published
//! Taylor least squares soften that, the spline and the smooth gradients do not feel it. The velocity error
//! stays near 7e-4 m/s or above: at 0.5 % strain a small-strain law on particles that move is not the linear
//! equation any more.
//!
//! Expected orders: measured with this code, reported in `docs/verification/one-phase.md`.

use super::*;

/// Orders from 10 to 20 and from 20 to 40 cells, of the displacement and of the stress.
const ORDERS: [(Basis, ReconstructionKind, [f64; 2], [f64; 2]); 9] = [
    (LINEAR, SHEPARD, [1.99, 1.45], [1.99, -1.26]),
    (LINEAR, TAYLOR, [2.00, 1.75], [2.01, 0.81]),
    (LINEAR, SPLINE, [1.98, 1.98], [1.99, 1.98]),
    (DUAL_DOMAIN, SHEPARD, [1.99, 2.00], [1.98, 2.00]),
    (DUAL_DOMAIN, TAYLOR, [2.01, 2.00], [2.00, 1.97]),
    (DUAL_DOMAIN, SPLINE, [2.00, 2.00], [1.99, 2.00]),
    (BSPLINE, SHEPARD, [1.99, 1.99], [1.96, 1.78]),
    (BSPLINE, TAYLOR, [1.90, 1.95], [1.90, 1.87]),
    (BSPLINE, SPLINE, [1.90, 1.95], [1.90, 1.95]),
];

#[test]
fn nine_methods_keep_their_orders_over_a_period() {
    let period = 2.0 * (2e3_f64 / 7e6).sqrt();
    let time = [
        format!("time.end={period}"),
        format!("time.step={}", period / 8000.0),
    ];
    for (basis, reconstruction, displacement, stress) in ORDERS {
        let method = Method::new(basis, reconstruction);
        let runs = [10, 20, 40].map(|cells| {
            let cells = format!("grid.cells=[{cells}]");
            summary("vibrating-bar-small", method, &[&cells, &time[0], &time[1]])
        });
        for (field, expected) in [("displacement", displacement), ("stress", stress)] {
            for (pair, expected) in runs.windows(2).zip(expected) {
                let found = order(&pair[0], &pair[1], field);
                assert!(
                    (found - expected).abs() < 0.1,
                    "{method} {field}: {found:.2}, expected {expected}"
                );
            }
        }
    }
}

/// The scene for studies runs an eighth longer, so that errors can be relative to something. Errors: measured
/// with this code, in `docs/verification/speed-and-error.md`.
#[test]
fn the_scene_of_one_period_follows_nine_eighths_of_it() {
    let period = 2.0 * (2e3_f64 / 7e6).sqrt();
    for (cells, expected) in [(10, 6.90e-2), (20, 1.88e-2)] {
        let cells = format!("grid.cells=[{cells}]");
        let found = summary("vibrating-bar-period", Method::new(BSPLINE, TAYLOR), &[&cells]);
        assert_eq!(found.steps, 9000);
        assert!((found.time / period - 1.125).abs() < 1e-12, "{}", found.time);
        let error = found.errors["stress"].relative_l2;
        assert!((error / expected - 1.0).abs() < 0.05, "{cells}: {error:e}");
    }
}
