//! Equilibria that are known exactly: a column under its own weight, and a sudden load that nothing can
//! drain.

use materialpoint::law::LinearElastic;
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::phase::Drag;
use materialpoint::reference::two_phase::{SaturatedColumn, Soil, TwoPhaseReference, TwoPhaseState};
use materialpoint::stepper::{FaceCondition, Forcing, PoreCondition, Simulation};
use materialpoint::taylor::{CellFit, DEFAULT_TOLERANCE};
use nalgebra::vector;

use super::column::{AT_REST, BASE, Column, Field, TOP, drained, fields, loaded, table_6};

const CELLS: usize = 20;
const PER_CELL: usize = 4;
const RELAXED: ReconstructionKind = ReconstructionKind::RelaxedTaylor;

fn column(permeability: f64, per_cell: usize) -> Column<LinearElastic<f64>> {
    let (soil, law) = table_6(permeability);
    Column {
        cells: CELLS,
        per_cell,
        soil,
        law,
        drag: Drag::Implicit,
        mass: VelocityMass::Consistent,
        surface: true,
    }
}

/// Mean of the fit of a field in each cell: of a linear field its mean over the particles, and what the force
/// of TLS integrates.
fn cell_means(simulation: &dyn Simulation<1>, per_cell: usize, field: Field) -> Vec<f64> {
    let values: Vec<f64> = fields(simulation).iter().map(field).collect();
    let positions = simulation.particles().position;
    let cells = positions
        .chunks(per_cell)
        .zip(values.chunks(per_cell))
        .enumerate();
    cells
        .map(|(cell, (x, values))| {
            let centre = (cell as f64 + 0.5) / CELLS as f64;
            let local = x.iter().map(|x| vector![(x[0] - centre) * 2.0 * CELLS as f64]);
            let fit = CellFit::<f64, 3>::new(local.clone(), 0, DEFAULT_TOLERANCE);
            fit.coefficients(local.zip(values).map(|(s, &value)| (s, 1.0, value)), 0.0)[0]
        })
        .collect()
}

/// Largest errors of the cell means of p and sigma' over their largest values, in a column that its own
/// weight has brought to rest: gravity (so small that the column's shape does not change) grows smoothly over
/// 0.2 s, k = 1e-2 m/s damps.
fn self_weight(method: Method, per_cell: usize) -> [f64; 2] {
    let gravity = 1e-5;
    let column = column(1e-2, per_cell);
    let soil = Soil {
        gravity,
        ..column.soil
    };
    let exact = SaturatedColumn::new(1.0, 1e7, 0.0, soil).unwrap();
    let mut simulation = column.build(method, |_| AT_REST);
    let dt = 2e-5;
    for step in 0..80_000 {
        let ramp = (f64::from(step) * dt / 0.2).min(1.0);
        let now = -gravity * ramp * ramp * (3.0 - 2.0 * ramp);
        simulation
            .step(dt, &drained().with_body_force(vector![now]))
            .unwrap();
    }
    let stresses: [Field; 2] = [|s| s.pore_pressure, |s| s.effective_stress];
    stresses.map(|field| {
        let largest = field(&exact.at(0.0)).abs();
        let means = cell_means(simulation.as_ref(), per_cell, field);
        (0..CELLS).fold(0.0_f64, |worst, cell| {
            let centre = (cell as f64 + 0.5) / CELLS as f64;
            worst.max((means[cell] - field(&exact.at(centre))).abs() / largest)
        })
    })
}

/// Self-weight from zero to equilibrium. Exact: p = -rho_w g (H - x), sigma' = -(1 - n)(rho_s - rho_w) g (H -
/// x), linear, so cell means are the values at the centres.
///
/// Expected: exact to 1e-6 with linear functions, and with dual domain and TLS. The others cannot be: the
/// weight that a DOF bears is the sum of m_p phi_i(x_p), which at the ends of a B-spline's grid is not the
/// integral of phi_i (an error that falls with the square of the particles per cell), and dual domain with
/// Shepard integrates smoothed gradients at the particles.
#[test]
fn a_column_under_its_own_weight_has_exact_cell_means() {
    for method in Method::ALL {
        let errors = self_weight(method, 4);
        let worst = errors[0].max(errors[1]);
        println!("{method:<22} p {:.1e} sigma' {:.1e}", errors[0], errors[1]);
        let bounds = match (method.basis, method.reconstruction) {
            // The spline's integral is not kept by anything.
            (_, ReconstructionKind::Spline) => continue,
            (Basis::Linear, _) | (Basis::DualDomain, ReconstructionKind::Taylor | RELAXED) => 0.0..1e-6,
            (Basis::DualDomain, _) => 6e-3..8e-3,
            (Basis::BSpline { .. }, ReconstructionKind::Taylor | RELAXED) => 1e-4..2e-4,
            (Basis::BSpline { .. }, _) => 4e-4..6e-4,
        };
        assert!(bounds.contains(&worst), "{method}: {worst:.1e}");
    }
}

#[test]
fn what_b_splines_miss_of_the_weight_falls_with_the_square_of_the_particles_per_cell() {
    let method = Method::new(Basis::BSpline { degree: 2 }, ReconstructionKind::Taylor);
    let [few, many] = [4, 8].map(|per_cell| self_weight(method, per_cell)[0]);
    println!("{few:.2e} {many:.2e}");
    assert!((3.5..4.5).contains(&(few / many)), "{few:.2e} {many:.2e}");
}

/// A fixed base that liquid passes, with the pressure of still water outside: a column in equilibrium stays
/// so, although its base bears the grains' weight and the liquid's DOF there is free. Expected: velocities of
/// round-off.
#[test]
fn still_water_outside_a_drained_wall_keeps_the_column_at_rest() {
    let column = column(1e-4, PER_CELL);
    let exact = SaturatedColumn::new(1.0, 1e7, 0.0, column.soil).unwrap();
    let outside = PoreCondition::Pressure(exact.at(0.0).pore_pressure);
    let forcing = drained()
        .with_body_force(vector![-column.soil.gravity])
        .with_pores(BASE, outside);
    for reconstruction in [ReconstructionKind::Shepard, ReconstructionKind::Taylor] {
        let method = Method::new(Basis::Linear, reconstruction);
        let mut simulation = column.build_with_base(method, true, |x| TwoPhaseState {
            solid_displacement: 0.0,
            ..exact.at(x)
        });
        for _ in 0..200 {
            simulation.step(2e-5, &forcing).unwrap();
        }
        for state in fields(simulation.as_ref()) {
            let fastest = state.solid_velocity.abs().max(state.liquid_velocity.abs());
            assert!(fastest < 1e-12, "{method}: {state:?}");
        }
    }
}

/// A sudden load on a column that cannot drain (k = 1e-9 m/s): the liquid takes K/n / (E + K/n) of every
/// stress, also while the wave runs. Expected: within 1 % in every particle that feels the load, the drained
/// layer at the top left out.
#[test]
fn a_sudden_load_is_taken_by_the_liquid() {
    for method in Method::ALL {
        let column = column(1e-9, PER_CELL);
        let ratio = column.soil.undrained_pressure_ratio(1e7);
        let mut simulation = column.build(method, |_| AT_REST);
        for _ in 0..200 {
            simulation.step(1e-5, &loaded(-1e4)).unwrap();
        }
        check_ratio(method, simulation.as_ref(), ratio, (CELLS - 2) * PER_CELL);
    }
}

/// The same with a top that the liquid does not pass, and any permeability: nothing drains anywhere, up to
/// the surface.
#[test]
fn a_sealed_surface_lets_no_liquid_pass() {
    let sealed = Forcing::none()
        .with_face(BASE, FaceCondition::fixed())
        .with_face(TOP, FaceCondition::Traction(vector![-1e4]));
    for permeability in [1e-9, 1e-5, 1e-3] {
        for method in Method::ALL {
            let column = column(permeability, PER_CELL);
            let ratio = column.soil.undrained_pressure_ratio(1e7);
            let mut simulation = column.build(method, |_| AT_REST);
            let steps = if permeability > 1e-4 { 20_000 } else { 200 };
            for _ in 0..steps {
                simulation.step(1e-5, &sealed).unwrap();
            }
            check_ratio(method, simulation.as_ref(), ratio, CELLS * PER_CELL);
        }
    }
}

fn check_ratio(method: Method, simulation: &dyn Simulation<1>, expected: f64, particles: usize) {
    let states = fields(simulation);
    let largest = states.iter().fold(0.0_f64, |m, s| m.max(s.pore_pressure.abs()));
    let mut checked = 0;
    let mut worst = 0.0_f64;
    for state in &states[..particles] {
        let total = state.effective_stress + state.pore_pressure;
        if total.abs() > 0.1 * largest {
            worst = worst.max((state.pore_pressure / total / expected - 1.0).abs());
            checked += 1;
        }
    }
    println!("{method:<22} ratio within {worst:.1e} in {checked} particles");
    assert!(worst < 0.01, "{method}: {worst}");
    assert!(
        checked > particles / 4,
        "{method}: only {checked} particles feel the load"
    );
}
