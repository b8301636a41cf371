//! Column compaction (journal section 6.2): H = 50 m, E = 1e6 Pa, body force from 0 to -200 N/kg over 0.5 s,
//! bottom fixed, top free, 50 cells, 20 particles per cell, 5000 steps of 1e-4 s, Hill's law.
//!
//! Expected: relative L2 errors of the stress against the static and the converged dynamic solution, as
//! measured by an independent prototype. Against the static one the better methods measure the residual
//! vibration of 3.6e-3. The prototype's fits go on to the end of the cell that the top lies in; ours end at
//! the top, which spares B-splines a part of their dynamic error.

use super::*;

const TABLE: [(Basis, ReconstructionKind, f64, f64, f64); 9] = [
    (LINEAR, SHEPARD, 4.71e-2, 4.69e-2, 0.03),
    (LINEAR, SPLINE, 8.90e-3, 8.55e-3, 0.03),
    (LINEAR, TAYLOR, 9.10e-3, 8.39e-3, 0.03),
    (DUAL_DOMAIN, SHEPARD, 4.31e-3, 2.61e-3, 0.03),
    (DUAL_DOMAIN, SPLINE, 4.25e-3, 2.43e-3, 0.03),
    (DUAL_DOMAIN, TAYLOR, 4.23e-3, 2.45e-3, 0.03),
    (BSPLINE, SHEPARD, 3.36e-3, 5.1e-4, 0.03),
    (BSPLINE, SPLINE, 3.49e-3, 3.2e-4, 0.10),
    (BSPLINE, TAYLOR, 3.49e-3, 3.9e-4, 0.03),
];

fn against(kind: &str) -> String {
    format!("reference.column-compaction={{ body_force = -200.0, ramp = 0.5, against = \"{kind}\" }}")
}

#[test]
fn nine_methods_have_the_errors_of_the_table() {
    for (basis, reconstruction, fixed, moving, tolerance) in TABLE {
        let method = Method::new(basis, reconstruction);
        for (kind, expected) in [("static", fixed), ("dynamic", moving)] {
            let found = summary("column-compaction", method, &[&against(kind)]).errors["stress"].relative_l2;
            let spared = basis == BSPLINE && reconstruction != SHEPARD && kind == "dynamic";
            if spared && 0.8 * expected < found && found < expected {
                continue;
            }
            assert_close(&format!("{method} {kind}"), found, expected, tolerance);
        }
    }
}

/// Top settlement 0.249 m, 165 to 189 crossings.
#[test]
fn the_column_settles_and_crosses_as_measured() {
    for reconstruction in [SHEPARD, TAYLOR, SPLINE] {
        let method = Method::new(LINEAR, reconstruction);
        let scene = Scene::from_toml(Scene::builtin("column-compaction").unwrap(), &[]).unwrap();
        let outcome = run(&scene.with_method(method), None, &mut |_| {}).unwrap();
        let top = outcome.particles.displacement.last().unwrap()[0];
        assert!((top + 0.249).abs() < 1e-3, "{method}: {top}");
        let crossings = outcome.summary.grid_crossings;
        assert!((165..=189).contains(&crossings), "{method}: {crossings}");
    }
}
