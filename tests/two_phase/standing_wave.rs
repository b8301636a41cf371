//! A standing compression wave in a saturated column against the exact eigenvalues.
//!
//! Source: the 4x4 system of one spatial mode, `reference::two_phase::StandingWave`. The column of 1 m (Table
//! 6 of report 18-2) is fixed and impermeable at its base, free and drained at its top, and swings in its
//! first mode, a quarter of a wave: half of the wave between two walls 2 m apart. Started from the
//! eigenvector of the weakly damped pair.
//!
//! Expected: fourth order for B-splines with relaxed TLS, 2e-6 with 20 cells; second order in h for all
//! others and every permeability, frequency error at most 2e-3 with 20 cells. With lumped masses and linear
//! functions the error is (kappa h)^2 / 24 from the stiffness and (kappa h)^2 / 12 from the mapping of the
//! velocity, 7.7e-4 together; the consistent velocity mass has no such part.

use std::f64::consts::PI;

use materialpoint::mass::VelocityMass;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::phase::Drag;
use materialpoint::reference::two_phase::{StandingWave, TwoPhaseReference};

use super::column::{Column, drained, table_6};

/// Stiffness and mass are of one energy there.
const BSPLINE_RELAXED: Method = Method::new(Basis::BSpline { degree: 2 }, ReconstructionKind::RelaxedTaylor);

/// Samples in a period.
const SAMPLES: usize = 40;

/// Angular frequency and damping rate by the recurrence `y_(n+2) = a y_(n+1) + b y_n` in the least-squares
/// sense.
fn frequency_and_damping(samples: &[f64], dt: f64) -> (f64, f64) {
    let (mut s11, mut s12, mut s22, mut r1, mut r2) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for y in samples.windows(3) {
        s11 += y[1] * y[1];
        s12 += y[1] * y[0];
        s22 += y[0] * y[0];
        r1 += y[2] * y[1];
        r2 += y[2] * y[0];
    }
    let determinant = s11 * s22 - s12 * s12;
    let (a, b) = (
        (r1 * s22 - r2 * s12) / determinant,
        (r2 * s11 - r1 * s12) / determinant,
    );
    let radius = (-b).sqrt();
    ((a / (2.0 * radius)).acos() / dt, -radius.ln() / dt)
}

/// Relative error of the frequency and error of the damping rate over the frequency.
fn errors(method: Method, permeability: f64, cells: usize) -> (f64, f64) {
    let (soil, law) = table_6(permeability);
    let column = Column {
        cells,
        per_cell: 8,
        soil,
        law,
        drag: Drag::Implicit,
        mass: VelocityMass::Consistent,
        surface: true,
    };
    let exact = StandingWave::new(2.0, 1e7, soil, 1, 1e-6).unwrap();
    let (omega, damping) = exact.fast_wave();
    let mut simulation = column.build(method, |x| exact.at(x));
    // The drag's error in time is of first order: a step that shrinks with h squared leaves the error in
    // space.
    let every = cells * cells / 10;
    let dt = 2.0 * PI / omega / (SAMPLES * every) as f64;
    let x0: Vec<f64> = simulation.particles().position.iter().map(|x| x[0]).collect();
    let mut samples = Vec::new();
    for step in 1..=2 * SAMPLES * every {
        simulation.step(dt, &drained()).unwrap();
        if step % every == 0 {
            let particles = simulation.particles();
            let parts = particles.velocity.iter().zip(&x0);
            samples.push(parts.map(|(v, x)| v[0] * (0.5 * PI * x).sin()).sum());
        }
    }
    let (found, decay) = frequency_and_damping(&samples, dt * every as f64);
    ((found / omega - 1.0).abs(), (decay - damping).abs() / omega)
}

#[test]
fn frequency_and_damping_converge_to_the_exact_eigenvalues() {
    for permeability in [1e-9, 1e-6, 1e-4, 1e-3, 1e-2] {
        for method in Method::ALL {
            let [coarse, middle, fine] = [10, 20, 40].map(|cells| errors(method, permeability, cells));
            let orders = [(coarse.0 / middle.0).log2(), (middle.0 / fine.0).log2()];
            println!(
                "{method:<22} k = {permeability:.0e}: frequency {:.2e} {:.2e} {:.2e}, orders {:.2} {:.2}; damping {:.1e} {:.1e} {:.1e}",
                coarse.0, middle.0, fine.0, orders[0], orders[1], coarse.1, middle.1, fine.1
            );
            assert!(middle.0 <= 2e-3, "{method} k = {permeability}: {}", middle.0);
            assert!(fine.1 < 2e-4, "{method} k = {permeability}: damping {}", fine.1);
            if method == BSPLINE_RELAXED {
                // What is left with a strong drag; else the drag's error in time is.
                let bound = if permeability < 1e-5 { 2e-6 } else { 2e-4 };
                assert!(middle.0 < bound, "k = {permeability}: {}", middle.0);
                continue;
            }
            assert!(
                orders.iter().all(|order| (1.8..2.3).contains(order)),
                "{method} k = {permeability}: {orders:?}"
            );
        }
    }
}
