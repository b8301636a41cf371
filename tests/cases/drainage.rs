//! Source: Terzaghi (1943), with the liquid's storage (Biot 1941).
//! Goal: a layer between smooth walls, in the plane, drains as the series says; units and signs are those of
//! the documentation.
//! Parameters: 1 m deep, E = 10 MPa, nu = 0.3, n = 0.4, K_w = 20 MPa, k = 1e-4 m/s (hydraulic), loaded by 10
//! kPa and started undrained, 20 cells; to T = c_v t / H^2 = 0.1.
//! Expected: p0 = -q Q / (Q + M) with Q = K_w / n, c_v = k / (rho_w g) / (1 / M + n / K_w) = 0.10811 m2/s; at
//! the base 0.94931 p0 within 0.5 %, the whole curve within 2.5 % with linear functions and 1 % with the
//! others, the total stress -q everywhere. Measured: base 0.9970 to 0.9984, curve 2.0, 0.93 and 0.23 %, total
//! stress 0.9957 to 1.0000.

use std::f64::consts::PI;

use super::{BASES, largest, root_mean_square, solved_by};

const LAYER: &str = include_str!("drained-layer.toml");

/// Pressure over the first one, at a depth and a time factor.
fn series(depth: f64, time_factor: f64) -> f64 {
    let terms = (0..50).map(|m| {
        let k = f64::from(2 * m + 1) * PI / 2.0;
        2.0 / k * (k * depth).sin() * (-k * k * time_factor).exp()
    });
    terms.sum()
}

#[test]
fn a_layer_drains_as_terzaghi_says() {
    let (load, end) = (1e4_f64, 0.924_942_857_1_f64);
    let modulus = 1e7 * 0.7 / (1.3 * 0.4);
    let storage = 2e7 / 0.4;
    let first = -load * storage / (storage + modulus);
    let consolidation = 1e-4 / (1e3 * 9.81) / (1.0 / modulus + 1.0 / storage);
    let time_factor: f64 = consolidation * end;
    assert!((time_factor - 0.1).abs() < 1e-6 && (series(1.0, 0.1) - 0.94931).abs() < 1e-5);
    for (basis, limit) in BASES.into_iter().zip([0.025, 0.01, 0.01]) {
        let outcome = solved_by(LAYER, [basis, "shepard"], &[]);
        let exact: Vec<f64> = outcome
            .particles
            .initial_position
            .iter()
            .map(|x| first * series(1.0 - x[1], time_factor))
            .collect();
        let pressures = || outcome.liquid.iter().map(|liquid| liquid.pressure);
        let off = root_mean_square(pressures().zip(&exact).map(|(found, exact)| found - exact));
        let off = off / root_mean_square(exact.iter().copied());
        assert!(off < limit, "{basis}: {off}");
        let base = pressures()
            .zip(&exact)
            .zip(&outcome.particles.initial_position)
            .filter(|(_, x)| x[1] < 0.025)
            .map(|((found, exact), _)| found / exact - 1.0);
        let off = largest(base);
        assert!(off < 5e-3, "{basis}: base {off}");
        let totals = outcome.particles.stress.iter().zip(pressures());
        let off = largest(totals.map(|(stress, pressure)| (stress[(1, 1)] + pressure) / load + 1.0));
        assert!(off < 5e-3, "{basis}: total stress {off}");
    }
}
