//! Source: statics; the self-weight column among the tests of AMPLE, Coombs & Augarde (2020); Timoshenko's
//! beam; Jaky's K0.
//! Goal: bodies under their weight carry the stresses and settle as statics says, whatever the basis and the
//! shape of the cells.
//! Parameters: a column 5 m high, E = 10 MPa, nu = 0.3, 1800 kg/m3, between smooth walls, on square cells of
//! 0.5 m and on cells of 1 m x 0.25 m, its weight brought on over five periods; sand 4 m deep that starts
//! with K0 = 0.5; a cantilever of 2 m x 0.4 m with nu = 0, 4 cells thick, its weight brought on over six
//! periods.
//! Expected: sigma_yy = -rho g (H - y), sigma_xx = nu / (1 - nu) sigma_yy, u_y = -rho g (H y - y^2 / 2) / M
//! within 0.5 %; a cell holds one stress with linear functions, so particles are off by h / (4 H) of rho g H
//! in the mean square. Measured: u_y 0.9969 to 1.0022, stress 0.9990 to 1.0039. The sand stays: 1e-14 m and
//! 1e-13 of rho g H with linear functions, 1.3e-5 m and 1.5 % where the quadrature is not exact; without its
//! stress it would settle 4.9 mm. The tip sinks as Timoshenko says within 3 %: measured 0.996, 1.018, 1.020.

use materialpoint_command::run::{RunError, run_in};

use super::{BASES, largest, root_mean_square, scene, solved_by};

const COLUMN: &str = include_str!("column.toml");
const OBLONG: &str = include_str!("oblong-cells.toml");
const SAND: &str = include_str!("sand-at-rest.toml");
const CANTILEVER: &str = include_str!("cantilever.toml");

/// Compares with statics; `cell` is the height of a cell (m).
fn check_column(text: &str, method: [&str; 2], cell: f64) {
    const HEIGHT: f64 = 5.0;
    let (young, poisson) = (1e7, 0.3);
    let modulus = young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let weight = 1800.0 * 9.81;
    let particles = solved_by(text, method, &[]).particles;
    let stress = |y: f64| -weight * (HEIGHT - y);
    let settlement = |y: f64| -weight * (HEIGHT * y - y * y / 2.0) / modulus;

    let heights = || particles.initial_position.iter().map(|x| x[1]);
    let mean = particles.stress.iter().map(|s| s[(1, 1)]).sum::<f64>() / heights().map(stress).sum::<f64>();
    assert!((mean - 1.0).abs() < 5e-3, "{method:?}: stress {mean}");
    let differences = particles
        .stress
        .iter()
        .zip(heights())
        .map(|(s, y)| s[(1, 1)] - stress(y));
    let rms = root_mean_square(differences) / (weight * HEIGHT);
    let step_in_a_cell = cell / (4.0 * HEIGHT);
    assert!(rms < 1.02 * step_in_a_cell, "{method:?}: stress rms {rms}");
    let found: f64 = particles.displacement.iter().map(|u| u[1]).sum();
    let settled = found / heights().map(settlement).sum::<f64>();
    assert!((settled - 1.0).abs() < 5e-3, "{method:?}: u_y {settled}");
    let uppermost = heights().fold(0.0, f64::max);
    for ((u, s), y) in particles
        .displacement
        .iter()
        .zip(&particles.stress)
        .zip(heights())
    {
        assert!(u[0].abs() < 1e-9, "{method:?}: u_x {}", u[0]);
        let sideways = s[(0, 0)] / s[(1, 1)] * (1.0 - poisson) / poisson;
        assert!(
            (sideways - 1.0).abs() < 1e-2,
            "{method:?}: K {sideways} of nu / (1 - nu)"
        );
        if y == uppermost {
            let top = u[1] / settlement(y);
            assert!((top - 1.0).abs() < 5e-3, "{method:?}: top {top}");
        }
    }
}

#[test]
fn a_column_settles_under_its_weight_between_smooth_walls() {
    for basis in BASES {
        check_column(COLUMN, [basis, "shepard"], 0.5);
    }
    // With B-splines u_x is not round-off and the ratio of the stresses is off by 1.1 %.
    for basis in ["linear", "dual-domain"] {
        check_column(COLUMN, [basis, "relaxed-taylor"], 0.5);
    }
}

/// The field does not vary across, so it cannot know how wide a cell is.
#[test]
fn the_width_of_cells_does_not_matter_to_a_column() {
    for basis in BASES {
        for reconstruction in ["shepard", "relaxed-taylor"] {
            check_column(OBLONG, [basis, reconstruction], 0.25);
        }
    }
}

#[test]
fn sand_that_starts_with_its_stress_stays_at_rest() {
    let weight = 1700.0 * 9.81;
    for (basis, limit) in [("linear", 1e-9), ("dual-domain", 0.02), ("bspline", 0.016)] {
        let outcome = solved_by(SAND, [basis, "shepard"], &[]);
        let particles = &outcome.particles;
        let moved = largest(particles.displacement.iter().map(|u| u.norm()));
        // A hundredth of the settlement that the weight would cause.
        assert!(moved < 5e-5, "{basis}: {moved}");
        let off = particles
            .stress
            .iter()
            .zip(&particles.initial_position)
            .flat_map(|(s, x)| {
                let pressure = weight * (4.0 - x[1]);
                [s[(0, 0)] + pressure / 2.0, s[(1, 1)] + pressure, s[(0, 1)]]
            });
        let off = largest(off) / (weight * 4.0);
        assert!(off < limit, "{basis}: stress {off}");
        // Dual domain's quadrature, off by as much as sand at the surface bears, lets a little yield there.
        if basis != "dual-domain" {
            let yielded = largest(outcome.law.plastic_strain.iter().copied());
            assert!(yielded < 1e-12, "{basis}: plastic strain {yielded}");
        }
    }
}

/// Active failure is at K = 1/3, passive failure at 3.
#[test]
fn a_start_beyond_the_cone_names_key_place_and_what_is_allowed() {
    for k in ["0.2", "3"] {
        let stress = format!("body.0.stress={{xx='-{k}*1700*9.81*(4-y)', yy='-1700*9.81*(4-y)'}}");
        let error = run_in::<2>(&scene(SAND, &[&stress]), None, &mut |_| {}).unwrap_err();
        assert!(
            matches!(error, RunError::InitialStress { body: 0, .. }),
            "{error}"
        );
        let text = error.to_string();
        for fragment in [
            "body.0.stress",
            "[0.1250, 0.1250] m",
            "yy = ",
            "xy = ",
            "the law bears xx from",
        ] {
            assert!(text.contains(fragment), "{text:?} lacks {fragment:?}");
        }
    }
}

#[test]
fn a_cantilever_bends_under_its_weight() {
    const LENGTH: f64 = 2.0;
    const THICKNESS: f64 = 0.4;
    let (young, load) = (1e7, 0.05 * 1000.0 * THICKNESS);
    let bending = young * THICKNESS.powi(3) / 12.0;
    let shear = 5.0 / 6.0 * (young / 2.0) * THICKNESS;
    let deflection = |x: f64| {
        let bent = x * x * (6.0 * LENGTH * LENGTH - 4.0 * LENGTH * x + x * x) / (24.0 * bending);
        let sheared = (LENGTH * x - x * x / 2.0) / shear;
        -load * (bent + sheared)
    };
    assert!((deflection(LENGTH) + 0.774e-3).abs() < 1e-6);
    for basis in BASES {
        let particles = solved_by(CANTILEVER, [basis, "shepard"], &[]).particles;
        let places = || particles.initial_position.iter().map(|x| x[0]);
        let last = places().fold(0.0, f64::max);
        let sunk = places()
            .zip(&particles.displacement)
            .filter(|(x, _)| *x > last - 1e-9);
        let (sum, count) = sunk.fold((0.0, 0), |(sum, count), (_, u)| (sum + u[1], count + 1));
        let tip = sum / f64::from(count) / deflection(last);
        assert!((tip - 1.0).abs() < 0.03, "{basis}: {tip}");
    }
}
