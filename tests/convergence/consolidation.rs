//! Consolidation at small strain (report 18-2, table 6), against the exact series.
//!
//! Expected: errors measured by an independent prototype.

use super::*;

const FIELDS: [&str; 5] = [
    "solid_displacement",
    "solid_velocity",
    "liquid_velocity",
    "effective_stress",
    "pore_pressure",
];

/// 20 steps of 1e-10 s show the initial data alone: RMS errors at 20 and 160 cells of what the DOFs
/// interpolate.
#[test]
fn initial_data_from_the_dofs_have_the_order_of_the_basis() {
    let linear = [
        (3.05e-7, 4.76e-9),
        (2.62e-8, 4.11e-10),
        (4.02e-8, 6.30e-10),
        (6.80, 0.106),
        (6.80, 0.106),
    ];
    let quadratic = [
        (2.24e-9, 4.32e-12),
        (4.5e-10, 6.39e-12),
        (7.27e-10, 4.0e-12),
        (8.72e-2, 1.66e-4),
        (8.72e-2, 1.66e-4),
    ];
    for (basis, expected, order) in [(LINEAR, linear, 2.0), (BSPLINE, quadratic, 3.0)] {
        let method = Method::new(basis, TAYLOR);
        let at = |cells: &str| summary("consolidation-small", method, &[&format!("grid.cells=[{cells}]")]);
        let (coarse, fine) = (at("20"), at("160"));
        for (field, (first, last)) in FIELDS.into_iter().zip(expected) {
            assert_close(
                &format!("{basis} {field} 20"),
                coarse.errors[field].rms,
                first,
                0.02,
            );
            // Euler-Cromer's start, half a step off, is all that is left of a quadratic's velocity.
            if !(basis == BSPLINE && field.ends_with("velocity")) {
                assert_close(
                    &format!("{basis} {field} 160"),
                    fine.errors[field].rms,
                    last,
                    0.02,
                );
                let found = super::order(&coarse, &fine, field) / 3.0;
                assert!((found - order).abs() < 0.1, "{basis} {field}: {found}");
            }
        }
    }
}

/// Half a second of draining from the exact series at 0.5 s: the scene is the run that
/// `two_phase::consolidation` holds for all nine methods.
#[test]
fn the_scene_is_the_run_that_measures_the_method() {
    for (method, pressure, stress) in [
        (Method::new(LINEAR, SHEPARD), 6.9e-3, 1.1e-2),
        (Method::new(BSPLINE, TAYLOR), 8.1e-4, 1.2e-3),
    ] {
        let found = summary("consolidation", method, &[]).errors;
        let error = |field: &str| found[field].relative_l2;
        assert_close(&format!("{method} p"), error("pore_pressure"), pressure, 0.05);
        assert_close(
            &format!("{method} stress"),
            error("effective_stress"),
            stress,
            0.05,
        );
    }
}

/// Both phases with inertia: the damped wave, at second order with B-splines.
#[test]
fn a_standing_wave_converges() {
    let method = Method::new(BSPLINE, TAYLOR);
    let at = |cells: &str| summary("standing-wave", method, &[&format!("grid.cells=[{cells}]")]);
    let (coarse, fine) = (at("20"), at("40"));
    for field in ["solid_displacement", "effective_stress", "pore_pressure"] {
        let order = super::order(&coarse, &fine, field);
        assert!((order - 2.0).abs() < 0.15, "{field}: {order}");
        assert!(fine.errors[field].relative_l2 < 2.5e-3, "{field}");
    }
    let energy = fine.energy;
    assert!(energy.highest_ratio.is_some_and(|ratio| ratio < 1.001));
    assert!(energy.lowest_ratio.is_some_and(|ratio| ratio < 0.9));
}

/// The grains stand under buoyancy, the liquid under its own weight.
#[test]
fn a_saturated_column_comes_to_rest_under_its_weight() {
    let found = summary("saturated-column", Method::new(BSPLINE, TAYLOR), &[]).errors;
    for field in ["solid_displacement", "effective_stress", "pore_pressure"] {
        assert!(found[field].relative_l2 < 5e-4, "{field}");
    }
    assert!(found["liquid_velocity"].max < 1e-6);
}

/// Large strain, from the start of the load on, on a coarse grid: against the converged solution of the same
/// equations, and against Xie and Leo's, which knows neither inertia nor the liquid's compression and is
/// therefore the farther one.
#[test]
fn large_strain_follows_both_of_its_references() {
    let method = Method::new(BSPLINE, TAYLOR);
    let coarse = ["grid.cells=[60]", "body.0.particles_per_cell=[8]"];
    let against = |reference: &str| {
        let set = [&coarse[..], &[reference]].concat();
        summary("consolidation-large", method, &set).errors
    };
    let exact = against("reference={xie-leo={load=-5e5}}");
    let converged = against("reference={consolidation={load=-5e5}}");
    let bounds = [
        ("solid_displacement", 0.004),
        ("effective_stress", 0.025),
        ("pore_pressure", 0.008),
        ("liquid_velocity", 0.07),
    ];
    for (field, bound) in bounds {
        let [exact, converged] = [&exact, &converged].map(|errors| errors[field].relative_l2);
        assert!(converged < bound, "{field}: {converged:e}");
        assert!(converged < exact && exact < 4.0 * bound, "{field}: {exact:e}");
    }
}

/// Hill's rate with a constant permeability, the report's own model at large strain: against the converged
/// solution.
#[test]
fn large_strain_with_hills_rate_follows_the_converged_solution() {
    let set = [
        "grid.cells=[60]",
        "body.0.particles_per_cell=[8]",
        "material.law={linear-elastic={youngs_modulus=1e6}}",
        "material.permeability_exponent=0",
        "material.drag=implicit",
        "time.step=2e-5",
        "reference={consolidation={load=-5e5}}",
    ];
    for (basis, stress, pressure) in [(DUAL_DOMAIN, 2.97e-2, 9.47e-3), (BSPLINE, 1.98e-2, 6.94e-3)] {
        let found = summary("consolidation-large", Method::new(basis, TAYLOR), &set);
        let error = |field: &str| found.errors[field].relative_l2;
        assert_close(&format!("{basis} stress"), error("effective_stress"), stress, 0.1);
        assert_close(&format!("{basis} p"), error("pore_pressure"), pressure, 0.1);
        assert!(error("solid_displacement") < 3e-3, "{basis}");
        assert!(
            found
                .conservation
                .values()
                .all(|c| c.mass < 1e-12 && c.momentum_scaled < 1e-12)
        );
    }
}

/// The wave of both phases together bears the load in the ratio of E to K/n behind its front.
#[test]
fn a_sudden_load_is_shared_as_the_stiffnesses_are() {
    let scene = Scene::from_toml(Scene::builtin("undrained-load").unwrap(), &[]).unwrap();
    let outcome = run(&scene, None, &mut |_| {}).unwrap();
    let near_top = outcome
        .particles
        .position
        .iter()
        .map(|x| x[0] > 0.7 && x[0] < 0.95);
    let behind: Vec<usize> = near_top
        .enumerate()
        .filter_map(|(p, is_behind)| is_behind.then_some(p))
        .collect();
    let mean =
        |value: &dyn Fn(usize) -> f64| behind.iter().map(|&p| value(p)).sum::<f64>() / behind.len() as f64;
    let pressure = mean(&|p| outcome.liquid[p].pressure);
    let stress = mean(&|p| outcome.particles.stress[p][(0, 0)]);
    assert_close("total", pressure + stress, -1e4, 0.01);
    assert_close("ratio", pressure / stress, 75.0, 0.01);
}
