//! The predicted critical step against the running scheme.
//!
//! Column of Table 6, 20 cells, 4 particles per cell, lumped velocity mass, started from noise; a run is
//! unstable if its energy has grown a thousandfold after 3000 steps. Permeability from 1e-1 to 1e-9 m/s, all
//! nine methods, both drags.
//!
//! Expected: limited by the drag, stable at 0.95 of the prediction and unstable at 1.05; limited by the wave,
//! stable at 0.95 and unstable at 1.08 (the prediction joins the largest eigenvalue of the grid's part with
//! the two-phase material).

use materialpoint::law::LinearElastic;
use materialpoint::mass::VelocityMass;
use materialpoint::method::Method;
use materialpoint::phase::Drag;
use materialpoint::reference::two_phase::TwoPhaseState;
use materialpoint::stepper::{CriticalStep, Mechanism};

use super::column::{AT_REST, Column, drained, table_6};

const STEPS: usize = 3000;

fn column(permeability: f64, drag: Drag, mass: VelocityMass) -> Column<LinearElastic<f64>> {
    let (soil, law) = table_6(permeability);
    Column {
        cells: 20,
        per_cell: 4,
        soil,
        law,
        drag,
        mass,
        surface: true,
    }
}

/// Whether noise stays bounded with a step of `share` of the predicted one.
fn is_stable(method: Method, permeability: f64, drag: Drag, mass: VelocityMass, share: f64) -> bool {
    let column = column(permeability, drag, mass);
    // Velocities of both signs and no pattern, so small that nothing moves.
    let noise = |x: f64| ((x * 1e4).sin() * 1e4).fract() * 1e-9;
    let mut simulation = column.build(method, |x| TwoPhaseState {
        solid_velocity: noise(x),
        liquid_velocity: noise(x + 0.123),
        ..AT_REST
    });
    let step = predicted(method, permeability, drag, mass).step * share;
    let before = simulation.energy().total();
    for _ in 0..STEPS {
        if simulation.step(step, &drained()).is_err() {
            return false;
        }
        if simulation.energy().total() > 1e3 * before {
            return false;
        }
    }
    true
}

fn predicted(method: Method, permeability: f64, drag: Drag, mass: VelocityMass) -> CriticalStep<f64> {
    let column = column(permeability, drag, mass);
    let simulation = column.build(method, |_| AT_REST);
    simulation.critical_step(&drained()).unwrap()
}

#[test]
fn explicit_drag_is_stable_below_the_predicted_step_and_not_above() {
    let lumped = VelocityMass::Lumped;
    for exponent in 1..=9 {
        let permeability = 10.0_f64.powi(-exponent);
        for method in Method::ALL {
            let limit = predicted(method, permeability, Drag::Explicit, lumped);
            let stable = |share| is_stable(method, permeability, Drag::Explicit, lumped, share);
            match limit.mechanism {
                Mechanism::Drag => {
                    assert!(stable(0.95), "{method} k = {permeability:.0e}");
                    assert!(!stable(1.05), "{method} k = {permeability:.0e}");
                }
                Mechanism::Wave => {
                    assert!(stable(0.95), "{method} k = {permeability:.0e}");
                    assert!(!stable(1.08), "{method} k = {permeability:.0e}");
                }
                Mechanism::Diffusion => panic!("{method}: nothing diffuses"),
            }
        }
    }
}

#[test]
fn implicit_drag_is_stable_up_to_the_waves_step() {
    let lumped = VelocityMass::Lumped;
    for exponent in 1..=9 {
        let permeability = 10.0_f64.powi(-exponent);
        for method in Method::ALL {
            let limit = predicted(method, permeability, Drag::Implicit, lumped);
            assert_eq!(limit.mechanism, Mechanism::Wave);
            let stable = |share| is_stable(method, permeability, Drag::Implicit, lumped, share);
            assert!(stable(0.95), "{method} k = {permeability:.0e}");
            assert!(!stable(1.08), "{method} k = {permeability:.0e}");
        }
    }
}

/// The drag limit is 2 / beta, beta = (n g / k) (1 + n rho_w / ((1 - n) rho_s)): 4.06e-10 s at k = 1e-9.
#[test]
fn the_drag_limit_is_the_closed_form() {
    for (permeability, expected) in [(1e-5, 4.06e-6), (1e-9, 4.06e-10)] {
        let method = Method::NINE[1];
        let limit = predicted(method, permeability, Drag::Explicit, VelocityMass::Lumped);
        assert_eq!(limit.mechanism, Mechanism::Drag);
        assert!((limit.step / expected - 1.0).abs() < 0.01, "{limit:?}");
    }
}

/// Observed over predicted, for the table in `docs/verification/two-phase.md`.
#[test]
#[ignore = "a table, not a check: cargo test --release --test main two_phase::critical_step -- --ignored --nocapture"]
fn table_of_observed_over_predicted_steps() {
    for mass in [VelocityMass::Lumped, VelocityMass::Consistent] {
        for drag in [Drag::Explicit, Drag::Implicit] {
            for method in Method::ALL {
                let mut row = Vec::new();
                for exponent in 1..=9 {
                    let permeability = 10.0_f64.powi(-exponent);
                    let (mut low, mut high) = (0.25_f64, 4.0_f64);
                    while high / low > 1.01 {
                        let middle = (low * high).sqrt();
                        if is_stable(method, permeability, drag, mass, middle) {
                            low = middle;
                        } else {
                            high = middle;
                        }
                    }
                    let mechanism = predicted(method, permeability, drag, mass).mechanism;
                    row.push(format!(
                        "{low:.2}{}",
                        if mechanism == Mechanism::Drag { "d" } else { "w" }
                    ));
                }
                println!("{mass:?} {drag:?} {method:<22} {}", row.join(" "));
            }
        }
    }
}
