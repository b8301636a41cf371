//! The vibrating bar: length 1 m, density 2e3 kg/m3.

use std::f64::consts::PI;

use super::super::super::{Hill, Linear, NeoHookean, VibratingBar};
use super::*;

const HILL: Hill = Hill { youngs_modulus: 4e4 };

fn hill_bar(velocity: f64, elements: usize, degree: usize) -> LagrangianBar<Hill> {
    let bar = LagrangianBar::vibrating_bar(1.0, 2e3, velocity, HILL).unwrap();
    bar.with_resolution(Resolution { elements, degree }).unwrap()
}

/// Goal: all three fields of the closed form, over a full period, at quarters that are not special.
#[test]
fn linear_law_reproduces_the_exact_bar() {
    let mut exact = VibratingBar::new(1.0, 2e3, 7e6, 0.28).unwrap();
    let law = Linear { youngs_modulus: 7e6 };
    let mut bar = LagrangianBar::vibrating_bar(1.0, 2e3, 0.28, law).unwrap();
    for part in [0.1, 0.3, 0.6, 0.9, 1.1] {
        let time = part * exact.period();
        let (a, b) = (sample(&mut bar, 1.0, time), sample(&mut exact, 1.0, time));
        for (name, error) in [
            ("displacement", relative_l2(&a, &b, |s| s.displacement)),
            ("velocity", relative_l2(&a, &b, |s| s.velocity)),
            ("stress", relative_l2(&a, &b, |s| s.stress)),
        ] {
            assert!(error < 2e-11, "{name} after {part} periods: {error:e}");
        }
    }
}

/// The non-linear part of the stress is of the order of the strain: at a tenth of the velocity, a tenth.
#[test]
fn hill_tends_to_the_linear_law() {
    let difference = |velocity| {
        let mut exact = VibratingBar::new(1.0, 2e3, 4e4, velocity).unwrap();
        let mut bar = hill_bar(velocity, 8, 8);
        relative_l2(&sample(&mut bar, 1.0, 0.1), &sample(&mut exact, 1.0, 0.1), |s| {
            s.stress
        })
    };
    let (large, small) = (difference(1e-3), difference(1e-4));
    assert!(small < 1e-4 && small > 1e-6, "{small:e}");
    assert!((large / small - 10.0).abs() < 0.1, "{large:e} {small:e}");
}

/// Before shocks the total energy is that of the start, rho v0^2 L / 4.
#[test]
fn energy_is_conserved_before_shocks() {
    let mut bar = hill_bar(0.8, 24, 8);
    let initial = 0.25 * 2e3 * 0.8 * 0.8;
    assert!((bar.energy() / initial - 1.0).abs() < 1e-12);
    let mut stored = 0.0_f64;
    for tenth in [0.1, 0.2, 0.3] {
        bar.advance(tenth).unwrap();
        let motion = &bar.motion;
        stored = stored.max(bar.operator.integrate(&motion.displacement, |j| HILL.energy(j)));
        assert!(
            (bar.energy() / initial - 1.0).abs() < 1e-9,
            "{:e}",
            bar.energy() / initial - 1.0
        );
    }
    // Nothing would be shown if the energy had stayed kinetic.
    assert!(stored > 0.5 * initial, "{stored}");
}

/// Spectral: two degrees more gain at least two digits each time, where a fixed order would gain ever less.
#[test]
fn converges_spectrally_with_the_degree() {
    let fine = sample(&mut hill_bar(0.8, 12, 16), 1.0, 0.2);
    let error = |degree| {
        relative_l2(&sample(&mut hill_bar(0.8, 12, degree), 1.0, 0.2), &fine, |s| {
            s.stress
        })
    };
    let errors = [2, 4, 6, 8].map(error);
    for pair in errors.windows(2) {
        assert!(pair[0] > 100.0 * pair[1], "{errors:?}");
    }
    assert!(errors[0] > 1e-3 && errors[3] < 1e-9, "{errors:?}");
}

/// Algebraic in the element size: the strain of degree p has order p, seen at random points.
#[test]
fn converges_with_the_order_of_the_degree() {
    let fine = sample(&mut hill_bar(0.8, 16, 8), 1.0, 0.1);
    for degree in [2, 3] {
        let error = |elements| {
            relative_l2(
                &sample(&mut hill_bar(0.8, elements, degree), 1.0, 0.1),
                &fine,
                |s| s.stress,
            )
        };
        let order = (error(20) / error(40)).log2();
        assert!(
            (order - degree as f64).abs() < 0.3,
            "degree {degree}: order {order}"
        );
    }
}

/// The default resolution is what the benchmark promises, and the estimate is neither idle nor optimistic.
#[test]
fn estimate_bounds_the_error() {
    let fine = sample(&mut hill_bar(0.8, 64, 8), 1.0, 0.1);
    let mut bar = LagrangianBar::vibrating_bar(1.0, 2e3, 0.8, HILL).unwrap();
    assert_eq!(bar.error_estimate(0.0), Ok(0.0));
    let estimate = bar.error_estimate(0.1).unwrap();
    let error = relative_l2(&sample(&mut bar, 1.0, 0.1), &fine, |s| s.stress);
    assert!(error < estimate && estimate < 1e-10, "{error:e} {estimate:e}");

    let mut coarse = hill_bar(0.8, 4, 4);
    let estimate = coarse.error_estimate(0.1).unwrap();
    let error = relative_l2(&sample(&mut coarse, 1.0, 0.1), &fine, |s| s.stress);
    assert!(
        error < estimate && estimate < 1e3 * error,
        "{error:e} {estimate:e}"
    );
}

/// The steepest gradient grows as 1 / (t_b - t). Its reciprocal is extrapolated to the breaking of two weak
/// waves of half the amplitude in an isothermal gas, which is what Hill's law makes of the bar: t_b = 2 L /
/// (pi v0) = 0.796 s.
#[test]
fn steepens_towards_the_known_breaking_time() {
    let mut bar = hill_bar(0.8, 32, 8);
    let mut reciprocal = |time| {
        bar.advance(time).unwrap();
        let stress: Vec<f64> = (0..=4000).map(|i| bar.at(f64::from(i) / 4000.0).stress).collect();
        1.0 / stress
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .fold(0.0, f64::max)
    };
    let (first, second) = (reciprocal(0.72), reciprocal(0.75));
    let breaking = 0.75 + 0.03 * second / (first - second);
    let expected = 2.0 / (PI * 0.8);
    assert!(
        (breaking / expected - 1.0).abs() < 0.02,
        "{breaking} against {expected}"
    );
}

/// Shocks form at 0.792 s; the solution must not pretend to be one after that.
#[test]
fn estimate_exposes_shocks() {
    let mut bar = hill_bar(0.8, 16, 8);
    assert!(bar.error_estimate(0.3).unwrap() < 1e-6);
    let late = bar.error_estimate(1.5);
    assert!(late.is_err() || late.is_ok_and(|estimate| estimate > 1e-2));
}

#[test]
fn going_back_restarts_and_repeating_changes_nothing() {
    let mut bar = hill_bar(0.8, 8, 8);
    bar.advance(0.05).unwrap();
    let first = bar.at(0.3);
    bar.advance(0.05).unwrap();
    assert_eq!(bar.at(0.3), first);
    bar.advance(0.1).unwrap();
    assert_ne!(bar.at(0.3), first);
    bar.advance(0.05).unwrap();
    assert_eq!(bar.at(0.3), first);
    bar.advance(0.0).unwrap();
    assert_eq!(bar.at(0.3).displacement, 0.0);
}

/// A step added to a time reaches the next one only within rounding; past it, the same `advance` would start
/// again.
#[test]
fn arrives_at_exactly_the_time_asked_for() {
    let mut bar = hill_bar(0.8, 8, 8);
    for i in 1..=300 {
        bar.advance(1e-5 / f64::from(3 * i)).unwrap();
        bar.advance(0.777e-5).unwrap();
        assert_eq!(bar.motion.time, 0.777e-5);
    }
}

#[test]
fn origin_only_moves_the_bar() {
    let mut here = hill_bar(0.8, 8, 8);
    let mut there = here.clone().with_origin(-4.0).unwrap();
    here.advance(0.1).unwrap();
    there.advance(0.1).unwrap();
    for i in 0..=16 {
        let x = f64::from(i) / 16.0;
        let (a, b) = (here.at(x), there.at(x - 4.0));
        assert!((a.stress - b.stress).abs() < 1e-7 * 4e4, "{a:?} {b:?}");
        assert!((a.displacement - b.displacement).abs() < 1e-12, "{a:?} {b:?}");
    }
}

/// Another law with the same modulus at rest: energy as exactly kept, the stress another one.
#[test]
fn neo_hookean_bar_keeps_its_energy() {
    let law = NeoHookean { lambda: 2e4, mu: 1e4 };
    let mut bar = LagrangianBar::vibrating_bar(1.0, 2e3, 0.8, law).unwrap();
    let initial = bar.energy();
    let states = sample(&mut bar, 1.0, 0.1);
    assert!(
        (bar.energy() / initial - 1.0).abs() < 1e-9,
        "{:e}",
        bar.energy() / initial - 1.0
    );
    let hill = sample(&mut hill_bar(0.8, 16, 8), 1.0, 0.1);
    let difference = relative_l2(&states, &hill, |s| s.stress);
    assert!((1e-3..0.2).contains(&difference), "{difference:e}");
}
