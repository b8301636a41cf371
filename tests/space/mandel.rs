//! Sources: Mandel (1953); Cheng & Detournay (1988), whose series is summed here. Goal: two phases in the
//! plane against an exact solution in which strain and flow are coupled: a slab between smooth rigid plates
//! is pressed and drains sideways, and the pressure in its middle rises before it falls. Parameters: a
//! quarter of the slab, half a width of 1 m and a height of 0.4 m, E = 50 MPa, nu = 0.2, M = K_w / n = 750
//! MPa, k such that c_v = 1 m2/s; started from the series at 0.02 s, the plate moved as the series says; the
//! side drained and free. Expected: relative L2 errors of the pressure at 0.05 s with 10 cells of 1.0 %
//! (B-splines with Shepard) to 2.0 %, of the effective stress 0.11 to 0.34 %; with B-splines and Shepard of
//! order 1.8 and 1.6, the way of the free side 4.0 % short and of order 2.3. The pressure in the middle goes
//! from 1.060 over 1.094 (at 0.05 s) to 0.579 (at 0.5 s) of that in the first moment, within 0.13 % with 20
//! cells. Inertia, which the series leaves out, is (time of a shear wave / time of draining)^2 = 1e-4 of the
//! rest.

mod series;

use materialpoint::grid::{Face, Side};
use materialpoint::stepper::{FaceCondition, Forcing, PoreCondition};
use materialpoint_command::run::simulation_in;
use nalgebra::vector;

use super::scene;
use series::Mandel;

const HEIGHT: f64 = 0.4;
const YOUNG: f64 = 5e7;
const POISSON: f64 = 0.2;
const POROSITY: f64 = 0.4;
const LIQUID: f64 = 3e8;
/// Force on the half plate (N/m).
const FORCE: f64 = 1e5;
const START: f64 = 0.02;

const SCENE: &str = r#"
title = "Mandel's problem"
[grid]
min = [0, 0]
max = [1, 0.4]
cells = [10, 4]
[time]
step = 1e-5
end = 1
[method]
basis = "bspline"
reconstruction = "shepard"
velocity_mass = "lumped"
[material]
phases = 2
strain = "small"
law.linear-elastic = { youngs_modulus = 5e7, poissons_ratio = 0.2 }
porosity = 0.4
solid_density = 2.6e3
liquid_density = 1e3
liquid_bulk_modulus = 3e8
permeability = 1
[[body]]
min = [0, 0]
max = [1, 0.4]
particles_per_cell = [2, 2]
[[boundary]]
face = "x-min"
roller = true
[[boundary]]
face = "y-min"
roller = true
[[boundary]]
face = "y-max"
roller = true
[[boundary]]
face = "x-max"
drained = true
"#;

/// What is found at one time.
#[derive(Clone, Copy, Debug)]
struct Found {
    /// Relative L2 errors of the pressure and of the effective stress along y.
    pressure: f64,
    stress: f64,
    /// Pressure in the middle over that of the first moment, and what it should be.
    middle: [f64; 2],
    /// Motion of the free side since the start over that of the series.
    side: f64,
}

/// Runs with so many cells along x to the times `until` (s).
fn run(cells: usize, basis: &str, reconstruction: &str, until: &[f64]) -> Vec<Found> {
    let exact = Mandel::new();
    let dt = 0.4e-3 / cells as f64;
    let mut set = vec![
        format!("grid.cells=[{cells}, {}]", cells * 2 / 5),
        format!("method.basis={basis:?}"),
        format!("method.reconstruction={reconstruction:?}"),
        format!("material.permeability={:?}", exact.permeability()),
    ];
    set.extend(exact.state(dt));
    let set: Vec<&str> = set.iter().map(String::as_str).collect();
    let mut simulation = simulation_in::<2>(&scene(SCENE, &set)).unwrap();
    let face = |axis, side| Face { axis, side };
    let mut forcing = Forcing::none()
        .with_face(face(0, Side::Min), FaceCondition::roller(0))
        .with_face(face(1, Side::Min), FaceCondition::roller(1))
        .with_pores(face(0, Side::Max), PoreCondition::Pressure(0.0));
    let (mut step, mut found) = (0, Vec::new());
    for &end in until {
        while START + step as f64 * dt < end - dt / 2.0 {
            let time = START + step as f64 * dt;
            let [before, after] = [time - dt / 2.0, time + dt / 2.0].map(|t| exact.pressing(t) * HEIGHT);
            let plate = FaceCondition::Held {
                held: [false, true],
                velocity: vector![0.0, after],
                acceleration: vector![0.0, (after - before) / dt],
            };
            forcing.set_face(face(1, Side::Max), plate);
            simulation.step(dt, &forcing).unwrap();
            step += 1;
        }
        let (particles, liquid) = (simulation.particles(), simulation.liquid());
        let time = START + step as f64 * dt;
        let mut sums = [[0.0; 2]; 2];
        let (mut middle, mut side) = ([0.0; 2], [0.0_f64; 2]);
        for (p, x) in particles.initial_position.iter().enumerate() {
            let expected = [exact.pressure(x[0], time), exact.stress(x[0], time)];
            let values = [liquid[p].pressure, particles.stress[p][(1, 1)]];
            for k in 0..2 {
                sums[k][0] += (values[k] - expected[k]).powi(2);
                sums[k][1] += expected[k].powi(2);
            }
            if x[0] < 0.5 / cells as f64 {
                middle[0] += values[0];
                middle[1] += expected[0];
            }
            if x[0] > 1.0 - 0.5 / cells as f64 {
                side[0] += particles.displacement[p][0];
                side[1] += exact.side(time) - exact.side(START);
            }
        }
        let column = 2.0 * (cells * 2 / 5) as f64;
        found.push(Found {
            pressure: (sums[0][0] / sums[0][1]).sqrt(),
            stress: (sums[1][0] / sums[1][1]).sqrt(),
            middle: middle.map(|p| p / column / (-exact.scale / 2.0)),
            side: side[0] / side[1],
        });
    }
    found
}

/// Within a fifth.
fn is_about(found: f64, expected: f64) -> bool {
    (found / expected - 1.0).abs() < 0.2
}

#[test]
fn every_method_follows_mandel() {
    for (basis, reconstruction, pressure, stress) in [
        ("bspline", "shepard", 9.7e-3, 1.7e-3),
        ("linear", "shepard", 1.65e-2, 2.9e-3),
        ("dual-domain", "shepard", 1.97e-2, 3.4e-3),
        ("bspline", "taylor", 1.13e-2, 1.1e-3),
        ("linear", "taylor", 1.65e-2, 2.9e-3),
        ("dual-domain", "taylor", 1.02e-2, 1.8e-3),
    ] {
        let found = run(10, basis, reconstruction, &[START, 0.05]);
        assert!(found[0].pressure < 1e-14 && found[0].stress < 1e-14, "{found:?}");
        let at = found[1];
        assert!(
            is_about(at.pressure, pressure) && is_about(at.stress, stress),
            "{basis} {reconstruction}: {at:?}"
        );
        assert!(
            (0.95..0.99).contains(&at.side),
            "{basis} {reconstruction}: {at:?}"
        );
    }
}

#[test]
fn the_pressure_in_the_middle_rises_before_it_falls() {
    let found = run(20, "bspline", "shepard", &[START, 0.05, 0.1, 0.5]);
    let middle: Vec<f64> = found.iter().map(|found| found.middle[0]).collect();
    assert!(
        middle[1] > middle[0] + 0.03 && middle[2] < middle[1] - 0.005,
        "{middle:?}"
    );
    assert!(middle[3] < 0.6, "{middle:?}");
    let off = found
        .iter()
        .map(|found| (found.middle[0] / found.middle[1] - 1.0).abs());
    let worst = off.fold(0.0, f64::max);
    assert!(is_about(worst, 1.24e-3), "{worst}");
}

#[test]
fn b_splines_converge_to_mandel() {
    let [coarse, fine] = [10, 20].map(|cells| run(cells, "bspline", "shepard", &[0.05])[0]);
    let order = |coarse: f64, fine: f64| (coarse / fine).log2();
    let pressure = order(coarse.pressure, fine.pressure);
    assert!((1.65..1.9).contains(&pressure), "{pressure}");
    let stress = order(coarse.stress, fine.stress);
    assert!((1.5..1.8).contains(&stress), "{stress}");
    let side = order(1.0 - coarse.side, 1.0 - fine.side);
    assert!((2.15..2.45).contains(&side), "{side}");
}
