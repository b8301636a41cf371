//! Consolidation at large strain: particles cross cells, the loaded surface sinks through them.
//!
//! Report 18-2, Table 7, with the logarithmic law, k = k0 lambda^2, k0 = 3.68e-4 m/s, 120 cells, 16 particles
//! per cell, 0.4 s. Exact without inertia: Xie & Leo with a compressible liquid, a settlement of -5.4027e-2
//! m.
//!
//! Expected: errors of TLS with all three bases and of Shepard with B-splines at most 1.5 times those of an
//! independent prototype (explicit drag, steps of 4e-6 s), settlement within 0.3 %, the total stress of the
//! topmost particle within 5 % of the load for TLS, mass and momentum of both phases kept. The default tier
//! takes the implicit drag at steps of 1e-5 s, with the same errors.

use materialpoint::law::{Logarithmic, Moduli};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::phase::Drag;
use materialpoint::reference::two_phase::{Soil, TwoPhaseReference, TwoPhaseState, XieLeo};
use materialpoint::stepper::{FaceCondition, Forcing, PoreCondition};
use nalgebra::vector;

use super::column::{AT_REST, BASE, Column, TOP, errors, fields, loaded};

const LOAD: f64 = -5e5;
const END: f64 = 0.4;

const LINEAR: Basis = Basis::Linear;
const DUAL_DOMAIN: Basis = Basis::DualDomain;
const BSPLINE: Basis = Basis::BSpline { degree: 2 };
const RELAXED: ReconstructionKind = ReconstructionKind::RelaxedTaylor;

#[derive(Clone, Copy, Debug)]
struct Found {
    settlement: f64,
    stress: f64,
    pressure: f64,
    /// Total stress of the topmost particle over the load.
    top: f64,
    mass: f64,
    momentum: f64,
    crossings: usize,
}

fn soil(permeability: f64) -> Soil {
    Soil {
        porosity: 0.4,
        solid_density: 2.6e3,
        liquid_density: 1e3,
        liquid_bulk_modulus: 3e7,
        permeability,
        permeability_exponent: 2.0,
        gravity: 9.81,
    }
}

fn exact(permeability: f64) -> XieLeo {
    let solution = XieLeo::new(1.0, 1e6, LOAD, soil(permeability)).unwrap();
    solution.with_compressible_liquid()
}

fn run(method: Method, permeability: f64, drag: Drag, mass: VelocityMass, step: f64) -> Found {
    let column = Column {
        cells: 120,
        per_cell: 16,
        soil: soil(permeability),
        law: Logarithmic {
            moduli: Moduli::uniaxial(1e6).unwrap(),
        },
        drag,
        mass,
        surface: true,
    };
    let mut simulation = column.build(method, |_| TwoPhaseState {
        pore_pressure: LOAD,
        ..AT_REST
    });
    for _ in 0..(END / step).round() as usize {
        simulation.step(step, &loaded(LOAD)).unwrap();
    }
    let mut solution = exact(permeability);
    let norms = errors(simulation.as_ref(), &mut solution, END, END - step / 2.0);
    let states = fields(simulation.as_ref());
    let top = states.last().unwrap();
    let diagnostics = simulation.diagnostics();
    let kept = [diagnostics.conservation, diagnostics.liquid_conservation.unwrap()];
    Found {
        settlement: top.solid_displacement,
        stress: norms[3].1,
        pressure: norms[4].1,
        top: (top.effective_stress + top.pore_pressure) / LOAD,
        mass: kept[0].mass.max(kept[1].mass),
        momentum: kept[0].momentum_scaled.max(kept[1].momentum_scaled),
        crossings: diagnostics.grid_crossings,
    }
}

/// Basis, reconstruction, the prototype's errors of effective stress and pressure.
const TABLE: [(Basis, ReconstructionKind, f64, f64); 7] = [
    // Our own, without a prototype: of the pressure's error only the inertia is left, which the exact
    // solution does not know.
    (LINEAR, RELAXED, 1.7e-3, 4.2e-3),
    (DUAL_DOMAIN, RELAXED, 8.3e-4, 4.2e-3),
    // What the fits with the neighbours creep, in proportion to the motion of a cell's particles. The motion
    // of its first one alone, here the slowest, gave 3.9e-4, and 1.8e-3 in the column upside down.
    (BSPLINE, RELAXED, 1.1e-3, 4.0e-3),
    (LINEAR, ReconstructionKind::Taylor, 0.044, 0.0136),
    (DUAL_DOMAIN, ReconstructionKind::Taylor, 0.0191, 0.0070),
    (BSPLINE, ReconstructionKind::Shepard, 0.0216, 0.0067),
    (BSPLINE, ReconstructionKind::Taylor, 0.0159, 0.0066),
];

fn check(permeability: f64, settlement: f64, tolerance: impl Fn(Method) -> f64) {
    let mut solution = exact(permeability);
    solution.advance(END).unwrap();
    let top = solution.at(1.0).solid_displacement;
    assert!((top / settlement - 1.0).abs() < 1e-4, "{top}");
    for (basis, reconstruction, stress, pressure) in TABLE {
        let method = Method::new(basis, reconstruction);
        let found = run(
            method,
            permeability,
            Drag::Implicit,
            VelocityMass::Consistent,
            1e-5,
        );
        println!("{method:<22} {found:?}");
        assert!(
            (found.settlement / top - 1.0).abs() < tolerance(method),
            "{method}: {found:?}"
        );
        assert!(
            found.mass <= 1e-12 && found.momentum <= 1e-12,
            "{method}: {found:?}"
        );
        assert!((found.top - 1.0).abs() < 0.05, "{method}: {found:?}");
        assert!(found.crossings > 30, "{method}: {found:?}");
        // The table is of k0 = 3.68e-4.
        if permeability > 1e-4 {
            assert!(
                (0.5..=1.5).contains(&(found.stress / stress)),
                "{method}: {found:?}"
            );
            assert!(
                (0.5..=1.5).contains(&(found.pressure / pressure)),
                "{method}: {found:?}"
            );
        }
    }
}

#[test]
fn errors_are_those_of_the_table_and_the_surface_bears_its_load() {
    check(3.68e-4, -5.402679e-2, |_| 3e-3);
}

/// Table 7's printed k = 1e-5: a settlement of -8.906e-3 m, not the printed 5.4e-2. The drained layer is two
/// and a half cells deep, hence 1 to 1.7 % of error, with relaxed TLS and linear functions or dual domain 2.6
/// and 2.5 %: there neighbours differ most.
#[test]
#[ignore = "40 s: cargo test --release the_printed_permeability -- --ignored"]
fn the_printed_permeability_settles_six_times_less() {
    let slopes_from_neighbours = |method: Method| method.reconstruction == RELAXED && method.basis != BSPLINE;
    check(1e-5, -8.906053e-3, |method| {
        if slopes_from_neighbours(method) {
            3e-2
        } else {
            2e-2
        }
    });
}

/// Rates of relaxation that come from one particle of a cell prefer a direction: its first one is the slowest
/// where the drained end is above, the fastest where it is below.
#[test]
fn a_column_upside_down_settles_alike() {
    const STEP: f64 = 1e-5;
    let column = Column {
        cells: 80,
        per_cell: 8,
        soil: soil(3.68e-4),
        law: Logarithmic {
            moduli: Moduli::uniaxial(1e6).unwrap(),
        },
        drag: Drag::Implicit,
        mass: VelocityMass::Consistent,
        surface: true,
    };
    let hanging = Column {
        surface: false,
        ..column
    };
    let loaded_below = Forcing::none()
        .with_face(TOP, FaceCondition::fixed())
        .with_face(BASE, FaceCondition::Traction(vector![-LOAD]))
        .with_pores(BASE, PoreCondition::Pressure(0.0));
    let initial = |_| TwoPhaseState {
        pore_pressure: LOAD,
        ..AT_REST
    };
    for basis in [LINEAR, DUAL_DOMAIN, BSPLINE] {
        let method = Method::new(basis, RELAXED);
        let mut upright = column.build(method, initial);
        let mut upside_down = hanging.build_with_base(method, true, initial);
        for _ in 0..3000 {
            upright.step(STEP, &loaded(LOAD)).unwrap();
            upside_down.step(STEP, &loaded_below).unwrap();
        }
        let crossings = upright.diagnostics().grid_crossings;
        assert!(crossings > 10, "{method}: {crossings}");
        let image = fields(upside_down.as_ref()).into_iter().rev();
        for (one, other) in fields(upright.as_ref()).into_iter().zip(image) {
            let apart = [
                (one.effective_stress - other.effective_stress) / LOAD,
                (one.pore_pressure - other.pore_pressure) / LOAD,
                one.solid_displacement + other.solid_displacement,
            ];
            assert!(
                apart.iter().all(|apart| apart.abs() < 1e-9),
                "{method}: {apart:?}, {one:?}, {other:?}"
            );
        }
    }
}

#[test]
#[ignore = "a table, minutes: cargo test --release --test main two_phase::large -- --ignored --nocapture"]
fn table_of_all_nine_methods() {
    for permeability in [3.68e-4, 1e-5] {
        for (drag, mass, step) in [
            (Drag::Explicit, VelocityMass::Consistent, 4e-6),
            (Drag::Implicit, VelocityMass::Consistent, 1e-5),
            (Drag::Implicit, VelocityMass::Lumped, 1e-5),
        ] {
            if permeability < 1e-4 && drag == Drag::Explicit {
                continue;
            }
            for method in Method::ALL {
                let found = run(method, permeability, drag, mass, step);
                println!(
                    "k0 {permeability:.2e} {drag:?} {mass:?} {method:<22} u {:.4e} sigma' {:.2e} p {:.2e} top {:.3} mass {:.0e} momentum {:.0e} crossings {}",
                    found.settlement,
                    found.stress,
                    found.pressure,
                    found.top,
                    found.mass,
                    found.momentum,
                    found.crossings
                );
            }
        }
    }
}
