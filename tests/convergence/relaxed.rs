//! Relaxed Taylor least squares: accuracy, energy in long runs, free surfaces; with 8, 4, 3 and 2 particles
//! per cell.
//!
//! Large bar: relative L2 error of the stress at 0.1 s against the converged solution, as in `large_bar`.
//! Column: against the dynamic solution, as in `column`. Smooth run: the large bar with v0 = 0.08 m/s, 80
//! cells, to 8 s. It stays smooth until 7.96 s, so the exact energy is constant; particles cross cell edges
//! all the time, and published TLS gains energy without bound there. The figures are this library's own
//! (`docs/theory/relaxed-tls.md`); a prototype without the fits through neighbours and without free surfaces
//! had 8.2e-3, 2.4e-3, 5.75e-4 on the bar and 6.6e-3, 1.6e-3, 1.6e-4 on the column.

use super::*;

const RELAXED: ReconstructionKind = ReconstructionKind::RelaxedTaylor;

/// Basis; large bar with 8, 4, 3 and 2 particles per cell.
const BAR: [(Basis, [f64; 4]); 3] = [
    (LINEAR, [2.07e-3, 2.37e-3, 2.58e-3, 4.75e-3]),
    (DUAL_DOMAIN, [1.72e-3, 2.08e-3, 2.52e-3, 3.30e-3]),
    (BSPLINE, [3.25e-4, 3.33e-4, 3.35e-4, 4.11e-4]),
];

/// Basis; column with 20 and with 4 particles per cell on its own grid, and with 100 cells, where its top
/// leaves a cell half empty.
const COLUMN: [(Basis, [f64; 3]); 3] = [
    (LINEAR, [1.65e-4, 1.56e-4, 7.54e-5]),
    (DUAL_DOMAIN, [1.37e-4, 1.41e-4, 4.38e-5]),
    (BSPLINE, [6.17e-6, 3.38e-5, 2.17e-6]),
];

fn stress_error(scene: &str, basis: Basis, set: &[&str]) -> f64 {
    summary(scene, Method::new(basis, RELAXED), set).errors["stress"].relative_l2
}

#[test]
fn few_particles_cost_little_accuracy() {
    for (basis, errors) in BAR {
        for (per_cell, expected) in [8, 4, 3, 2].into_iter().zip(errors) {
            let set = format!("body.0.particles_per_cell=[{per_cell}]");
            let found = stress_error("vibrating-bar-large", basis, &[&set]);
            assert_close(&format!("{basis}, {per_cell} per cell"), found, expected, 0.03);
        }
    }
}

#[test]
fn a_free_surface_may_leave_cells_half_empty() {
    let sets = [
        "body.0.particles_per_cell=[20]",
        "body.0.particles_per_cell=[4]",
        "grid.cells=[100]",
    ];
    for (basis, errors) in COLUMN {
        for (set, expected) in sets.into_iter().zip(errors) {
            let found = stress_error("column-compaction", basis, &[set]);
            assert_close(&format!("column, {basis}, {set}"), found, expected, 0.05);
        }
    }
}

/// Third order with B-splines, once the error of the step (first order, 1.4e-4 with 1e-4 s) is out of the
/// way.
#[test]
fn the_order_is_that_of_the_basis() {
    let error = |basis, cells: &str| {
        let set = [cells, "time.step=1e-5"];
        stress_error("vibrating-bar-large", basis, &set)
    };
    for (basis, lowest, highest) in [(LINEAR, 1.4, 2.2), (DUAL_DOMAIN, 1.8, 2.2), (BSPLINE, 2.6, 3.0)] {
        let order = (error(basis, "grid.cells=[20]") / error(basis, "grid.cells=[40]")).log2();
        assert!(lowest < order && order < highest, "{basis}: order {order:.2}");
    }
}

/// The relaxation is a rate: a step of a fifth leaves the error as it is, within what the step itself
/// contributes.
#[test]
fn smaller_steps_do_not_relax_more() {
    for (basis, errors) in BAR {
        let found = stress_error("vibrating-bar-large", basis, &["time.step=2e-5"]);
        assert_close(&format!("{basis}, a fifth of the step"), found, errors[0], 0.15);
    }
}

/// The momentum of the column passes near zero, so there it is measured against the sum of m |v|.
#[test]
fn mass_and_momentum_are_kept() {
    for (basis, ..) in BAR {
        let method = Method::new(basis, RELAXED);
        let bar = summary("vibrating-bar-large", method, &[]).conservation["solid"];
        assert!(bar.mass <= 1e-14 && bar.momentum <= 1e-14, "{basis}: {bar:?}");
        let column = summary("column-compaction", method, &[]).conservation["solid"];
        assert!(
            column.mass <= 1e-13 && column.momentum_scaled <= 1e-13,
            "{basis}: {column:?}"
        );
    }
}

fn smooth(method: Method, per_cell: usize, end: &str) -> Summary {
    swing(method, per_cell, (0.08, 80), end)
}

/// The bar with another velocity (m/s) and number of cells.
fn swing(method: Method, per_cell: usize, (velocity, cells): (f64, usize), end: &str) -> Summary {
    let set = [
        &format!("body.0.velocity=[\"{velocity:?}*sin(pi*x)\"]")[..],
        &format!("reference.vibrating-bar.velocity={velocity:?}"),
        &format!("grid.cells=[{cells}]"),
        &format!("body.0.particles_per_cell=[{per_cell}]"),
        end,
    ];
    summary("vibrating-bar-large", method, &set)
}

/// Within 0.98 and 1.003 at all times up to 8 s, where the published method has 1.17 (dual domain, lumped) to
/// 13.5 (linear).
#[test]
fn the_smooth_run_keeps_its_energy_where_the_published_method_gains() {
    for (basis, ..) in BAR {
        for per_cell in [8, 4, 3, 2] {
            let energy = smooth(Method::new(basis, RELAXED), per_cell, "time.end=8.0").energy;
            let (lowest, highest) = (energy.lowest_ratio.unwrap(), energy.highest_ratio.unwrap());
            assert!(
                lowest > 0.98 && highest < 1.003,
                "{basis}, {per_cell}: {lowest} to {highest}"
            );
        }
    }
    let published = smooth(Method::new(LINEAR, TAYLOR), 8, "time.end=6.0").energy;
    assert_close("published, linear", published.highest_ratio.unwrap(), 1.34, 0.03);
}

/// Particles that swing to and fro without leaving their cells, and few in large cells: a linear basis gained
/// where slopes from the neighbours turned about the middle of the particles instead of the cell (1.06, 1.07,
/// 2.8 and 3.2).
#[test]
fn particles_off_the_middle_of_their_cells_gain_no_energy() {
    for (per_cell, velocity, cells) in [(4, 0.02, 80), (3, 0.04, 80), (2, 0.04, 80), (2, 0.08, 40)] {
        let energy = swing(
            Method::new(LINEAR, RELAXED),
            per_cell,
            (velocity, cells),
            "time.end=8.0",
        )
        .energy;
        let (lowest, highest) = (energy.lowest_ratio.unwrap(), energy.highest_ratio.unwrap());
        assert!(
            lowest > 0.97 && highest < 1.003,
            "{per_cell}, {velocity} m/s, {cells} cells: {lowest} to {highest}"
        );
    }
}

/// Shocks from 0.79 s on: the exact energy falls, so more than the round-off of the half step that velocities
/// lag is a gain.
#[test]
fn the_bar_with_shocks_never_gains_energy() {
    for (basis, ..) in BAR {
        for per_cell in [8, 4, 3, 2] {
            let set = [
                &format!("body.0.particles_per_cell=[{per_cell}]")[..],
                "time.end=10.0",
            ];
            let energy = summary("vibrating-bar-large", Method::new(basis, RELAXED), &set).energy;
            let highest = energy.highest_ratio.unwrap();
            assert!(highest < 1.001, "{basis}, {per_cell}: {highest}");
        }
    }
}

/// A law that leaves the stress as it is, with a state `S` of its own.
#[derive(Clone, Copy)]
struct Frozen<S>(std::marker::PhantomData<S>);

impl<S: Copy + Default + Send + Sync> materialpoint::law::ConstitutiveLaw<f64, 1> for Frozen<S> {
    type State = S;

    fn large_strain(&self) -> bool {
        false
    }

    fn update(&self, _: &nalgebra::Matrix1<f64>, _: &mut nalgebra::Matrix1<f64>, _: &mut S) {}

    fn wave_speed(&self, _: f64, _: &nalgebra::Matrix1<f64>, _: &S) -> f64 {
        1.0
    }

    fn energy_density(&self, _: &nalgebra::Matrix1<f64>, _: &S) -> f64 {
        0.0
    }
}

/// Whether one step moves rough stresses towards their fit.
fn moves_the_stress<S: Copy + Default + Send + Sync>() -> bool {
    use materialpoint::basis::BSpline;
    use materialpoint::grid::Grid;
    use materialpoint::particles::{Particles, lattice};
    use materialpoint::phase::OnePhase;
    use materialpoint::reconstruction::RelaxedTaylor;
    use materialpoint::stepper::{Forcing, Setup, Stepper};
    use nalgebra::vector;

    let grid = Grid::new(vector![0.0], vector![1.0], [4]).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [6]);
    let mut particles = Particles::at_rest(&points, 1.0);
    for (p, stress) in particles.stress.iter_mut().enumerate() {
        stress[(0, 0)] = (p * 5 % 7) as f64;
    }
    let before = particles.stress.clone();
    let law = Frozen(std::marker::PhantomData::<S>);
    let fits = RelaxedTaylor::<f64, 1, 3>::for_degree(2);
    let setup = Setup::new(grid, BSpline::<2>, fits, law, OnePhase, particles);
    let mut stepper = Stepper::new(setup).unwrap();
    stepper.step(1e-6, &Forcing::none()).unwrap();
    stepper.particles().stress != before
}

/// Plastic history, a deformation gradient: stress is bound to it and must not be moved without it.
#[test]
fn the_stress_of_a_law_with_a_state_is_not_relaxed() {
    assert!(moves_the_stress::<()>());
    assert!(!moves_the_stress::<f64>());
}
