//! The compacting column: height 50 m, density 1 kg/m3, Young's modulus 1e6 Pa, body force -200 N/kg after
//! 0.5 s.

use std::f64::consts::PI;

use super::super::super::{Hill, Linear, StaticColumn, Strain};
use super::*;

const HEIGHT: f64 = 50.0;
const MODULUS: f64 = 1e6;
const FORCE: f64 = -200.0;
const RAMP: f64 = 0.5;

/// Stress, Pa, of the linear column by its eigenfunctions: `rho b(t) (H - X)` at rest, less the oscillation
/// `sum_k E b_k' k_k sin(w_k t) / w_k^3 cos(k_k X)` that each start of a ramp (at 0, and of the opposite one
/// at its end) sets off; `k_k = (k - 1/2) pi / H`, `w_k = c k_k`, `b_k' = 2 b' / (H k_k)`.
fn series_stress(x: f64, time: f64) -> f64 {
    let rate = FORCE / RAMP;
    let speed = MODULUS.sqrt();
    let ramp_from = |since: f64| {
        if since <= 0.0 {
            return 0.0;
        }
        let oscillation: f64 = (1..5_000)
            .map(|k| {
                let number = (f64::from(k) - 0.5) * PI / HEIGHT;
                let frequency = speed * number;
                2.0 * rate / HEIGHT * (frequency * since).sin() / frequency.powi(3) * (number * x).cos()
            })
            .sum();
        rate * since * (HEIGHT - x) - MODULUS * oscillation
    };
    ramp_from(time) - ramp_from(time - RAMP)
}

fn linear_column() -> LagrangianBar<Linear> {
    LagrangianBar::column(
        HEIGHT,
        1.0,
        FORCE,
        RAMP,
        Linear {
            youngs_modulus: MODULUS,
        },
    )
    .unwrap()
}

/// A column of a quarter of the default elements: an error of 5e-7, in a sixteenth of the time.
fn hill_column() -> LagrangianBar<Hill> {
    let column = LagrangianBar::column(
        HEIGHT,
        1.0,
        FORCE,
        RAMP,
        Hill {
            youngs_modulus: MODULUS,
        },
    )
    .unwrap();
    column
        .with_resolution(Resolution {
            elements: 8,
            degree: 8,
        })
        .unwrap()
}

/// Relative L2 difference to the series at 101 points.
fn series_error(column: &mut LagrangianBar<Linear>, time: f64) -> f64 {
    let exact: Vec<State> = (0..=100)
        .map(|i| series_stress(HEIGHT * f64::from(i) / 100.0, time))
        .map(|stress| State {
            displacement: 0.0,
            velocity: 0.0,
            stress,
        })
        .collect();
    relative_l2(&sample(column, HEIGHT, time), &exact, |s| s.stress)
}

/// During the ramp, at its end and after it.
#[test]
fn linear_column_follows_its_eigenfunctions() {
    let mut column = linear_column();
    for time in [0.037, 0.21, 0.5, 0.68] {
        let error = series_error(&mut column, time);
        assert!(error < 2e-6, "{error:e} at {time}");
    }
}

/// The kink of the ramp leaves a jump in the stress's second derivative, which a polynomial meets with order
/// 2.5.
#[test]
fn kink_limits_the_order() {
    let errors = [5, 10, 20].map(|elements| {
        let mut column = linear_column()
            .with_resolution(Resolution { elements, degree: 8 })
            .unwrap();
        series_error(&mut column, 0.21)
    });
    let order = (errors[0] / errors[2]).log2() / 2.0;
    assert!((2.0..3.0).contains(&order), "{order}: {errors:?}");
}

#[test]
fn ramp_end_is_a_step_boundary() {
    let mut through = hill_column();
    through.advance(0.6).unwrap();
    let mut stopping = hill_column();
    stopping.advance(RAMP).unwrap();
    stopping.advance(0.6).unwrap();
    assert_eq!(through.at(20.0), stopping.at(20.0));
}

/// Measured by an independent prototype: 3.6e-3, because five half periods cancel the vibration to first
/// order only.
#[test]
fn residual_vibration_of_the_benchmark() {
    let mut rest = StaticColumn::new(HEIGHT, 1.0, MODULUS, FORCE, Strain::Large).unwrap();
    let dynamic = sample(&mut hill_column(), HEIGHT, 0.5);
    let difference = relative_l2(&dynamic, &sample(&mut rest, HEIGHT, 0.5), |s| s.stress);
    assert!((difference / 3.6e-3 - 1.0).abs() < 0.1, "{difference:e}");
}

/// The settlement of the moving column at 0.5 s; at rest it is 0.2483 m.
#[test]
fn top_settles_as_measured() {
    let mut column = hill_column();
    column.advance(0.5).unwrap();
    let top = column.at(HEIGHT).displacement;
    assert!((top + 0.249).abs() < 5e-4, "{top}");
}

/// A load that grows slowly leads to the static column: the amplitude falls with the ramp.
#[test]
fn slow_load_leads_to_rest() {
    let mut rest = StaticColumn::new(HEIGHT, 1.0, MODULUS, FORCE, Strain::Large).unwrap();
    let still = sample(&mut rest, HEIGHT, 0.0);
    let difference = |ramp| {
        let law = Hill {
            youngs_modulus: MODULUS,
        };
        let column = LagrangianBar::column(HEIGHT, 1.0, FORCE, ramp, law).unwrap();
        let mut column = column
            .with_resolution(Resolution {
                elements: 8,
                degree: 6,
            })
            .unwrap();
        let states = sample(&mut column, HEIGHT, ramp);
        relative_l2(&states, &still, |s| s.displacement)
    };
    let (fast, slow) = (difference(0.23), difference(2.3));
    assert!(slow < 1e-2 && slow < 0.2 * fast, "{slow:e} {fast:e}");
}

#[test]
fn ends_obey_their_conditions() {
    let states = sample(&mut hill_column(), HEIGHT, 0.3);
    let (base, top) = (states[0], states[100]);
    assert_eq!((base.displacement, base.velocity), (0.0, 0.0));
    assert!(top.stress.abs() < 1e-2, "{top:?}");
    assert!(base.stress < -1e3 && top.displacement < -0.05, "{base:?} {top:?}");
}

/// Where the kink limits the order, too, the estimate lies above the error, and not idly far.
#[test]
fn estimate_bounds_the_error_of_the_column() {
    let estimate = hill_column().error_estimate(0.5).unwrap();
    let fine = Resolution {
        elements: 24,
        degree: 8,
    };
    let mut fine = hill_column().with_resolution(fine).unwrap();
    let fine = sample(&mut fine, HEIGHT, 0.5);
    let error = relative_l2(&sample(&mut hill_column(), HEIGHT, 0.5), &fine, |s| s.stress);
    assert!(error < 2e-6, "{error:e}");
    assert!(
        estimate > error && estimate < 50.0 * error,
        "{estimate:e} {error:e}"
    );
}
