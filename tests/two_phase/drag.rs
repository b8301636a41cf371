//! Point-implicit drag against explicit drag where the drag is stiff.
//!
//! k = 1e-9 m/s: the explicit step is limited to 4.06e-10 s, the wave allows 5e4 times more. A quarter of a
//! standing wave, 20 cells, to 4e-4 s (a tenth of a period). Velocities start at the time where they live,
//! half a step before the stresses.
//!
//! Expected: pressure and displacement of the implicit run at the wave's step differ from the resolved
//! explicit run by no more than the scheme's own error in time, (omega dt)^2 / 24 relative and less, far
//! below its error in space.

use materialpoint::mass::VelocityMass;
use materialpoint::method::Method;
use materialpoint::phase::Drag;
use materialpoint::reference::two_phase::{StandingWave, TwoPhaseReference, TwoPhaseState};

use super::column::{Column, Field, drained, fields, table_6};

const START: f64 = 1e-4;
const LENGTH: f64 = 4e-4;

fn run(method: Method, drag: Drag, steps: usize) -> Vec<TwoPhaseState> {
    let (soil, law) = table_6(1e-9);
    let column = Column {
        cells: 20,
        per_cell: 4,
        soil,
        law,
        drag,
        mass: VelocityMass::Lumped,
        surface: true,
    };
    let dt = LENGTH / steps as f64;
    let mut wave = StandingWave::new(2.0, 1e7, soil, 1, 1e-6).unwrap();
    let mut early = wave.clone();
    wave.advance(START).unwrap();
    early.advance(START - dt / 2.0).unwrap();
    let mut simulation = column.build(method, |x| TwoPhaseState {
        solid_velocity: early.at(x).solid_velocity,
        liquid_velocity: early.at(x).liquid_velocity,
        ..wave.at(x)
    });
    for _ in 0..steps {
        simulation.step(dt, &drained()).unwrap();
    }
    fields(simulation.as_ref())
}

fn difference(a: &[TwoPhaseState], b: &[TwoPhaseState], field: Field) -> f64 {
    let (mut error, mut square) = (0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        error += (field(a) - field(b)).powi(2);
        square += field(b).powi(2);
    }
    (error / square).sqrt()
}

#[test]
fn implicit_drag_at_the_waves_step_gives_the_resolved_answer() {
    check(&[Method::ALL[10]]);
}

#[test]
#[ignore = "30 s: cargo test --release implicit_drag_gives_the_answer_with_other_methods -- --ignored"]
fn implicit_drag_gives_the_answer_with_other_methods() {
    check(&[Method::ALL[0], Method::ALL[5], Method::ALL[9]]);
}

fn check(methods: &[Method]) {
    for &method in methods {
        let explicit = run(method, Drag::Explicit, 1_000_000);
        let implicit = run(method, Drag::Implicit, 20);
        let fields: [(&str, Field); 2] = [("p", |s| s.pore_pressure), ("u", |s| s.solid_displacement)];
        for (name, field) in fields {
            let found = difference(&implicit, &explicit, field);
            println!("{method:<22} {name}: {found:.1e}");
            assert!(found < 1e-3, "{method}: {name} {found:.1e}");
        }
    }
}
