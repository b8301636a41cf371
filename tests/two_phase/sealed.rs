//! Surfaces that the liquid does not pass.
//!
//! Source: a sealed element under a load (OpenSees/OpenSees #1811); the storage equation alone.
//! Goal: where no liquid can leave and the load comes slowly, solid and liquid strain alike: of a load `q`
//! the liquid takes
//! `p = q Q / (Q + M)`, `Q = K_w / n`, `M` the modulus of uniaxial strain, everywhere, whatever the
//! permeability, the drag's treatment, the method, the cells and the particles across. The energy is then
//! that of the strain, `q^2 / (2 (Q + M))` per volume.
//! Parameters: a box between smooth walls, a layer that ends at the grid's end or below it, a slab with two
//! surfaces in one cell; as scenes, with half the step that `check` calls stable.
//! Expected: pressure within 1 % in every particle, energy within 1 %, left and right alike to round-off.

use std::f64::consts::PI;

use materialpoint_command::run::{Outcome, run, run_in};
use materialpoint_command::scene::Scene;

pub const SEALED_BOX: &str = r#"
title = "A sealed box of saturated soil takes a load"
[grid]
min = [0, 0]
max = [1, 1]
cells = [1, 8]
[time]
step = "auto"
safety = 0.5
end = 0.4
[method]
basis = "linear"
reconstruction = "shepard"
[material]
phases = 2
strain = "small"
law.linear-elastic = { youngs_modulus = 1e7, poissons_ratio = 0.3 }
porosity = 0.4
solid_density = 2.65e3
liquid_density = 1e3
liquid_bulk_modulus = 2e7
permeability = 1e-4
[[body]]
min = [0, 0]
max = [1, 1]
particles_per_cell = [2, 2]
[[boundary]]
face = "x-min"
roller = true
[[boundary]]
face = "x-max"
roller = true
[[boundary]]
face = "y-min"
roller = true
[[boundary]]
face = "y-max"
traction = ["0", "-1e4*sin(pi/2*min(t/0.3, 1))^2"]
"#;

/// Modulus of uniaxial strain, stiffness of the liquid in its pores and load of the box.
const M: f64 = 1e7 * 0.7 / (1.3 * 0.4);
const Q: f64 = 2e7 / 0.4;
const LOAD: f64 = 1e4;

const LAYER: &str = r#"
title = "A sealed layer takes a load"
[grid]
min = [0]
max = [4]
cells = [40]
[time]
step = "auto"
end = 0.2
[method]
basis = "bspline"
reconstruction = "shepard"
[material]
phases = 2
strain = "small"
law.linear-elastic = { youngs_modulus = 5e6 }
porosity = 0.45
solid_density = 2650
liquid_density = 1e3
liquid_bulk_modulus = 2e9
permeability = 1e-3
[[body]]
min = [0]
max = [4]
particles_per_cell = [4]
[[boundary]]
face = "x-min"
fixed = true
[[boundary]]
face = "x-max"
traction = ["-1e5*(min(t/0.1, 1) - sin(2*pi*min(t/0.1, 1))/(2*pi))"]
"#;

const BASES: [&str; 3] = ["linear", "dual-domain", "bspline"];
/// A layer that ends at the grid's end, and one at a cell's edge with room above.
const ROOMS: [&str; 2] = ["title='none'", "grid={min=[0], max=[4.4], cells=[44]}"];
/// One that ends inside a cell: there the particles are poor points of an integral, and published TLS gains
/// energy by itself.
const INSIDE: &str = "grid={min=[0], max=[4.4], cells=[42]}";

fn scene(text: &str, set: &[String]) -> Scene {
    Scene::from_toml(text, set).unwrap_or_else(|error| panic!("{set:?}: {error}"))
}

fn method(basis: &str, reconstruction: &str) -> [String; 2] {
    [
        format!("method.basis={basis:?}"),
        format!("method.reconstruction={reconstruction:?}"),
    ]
}

/// Largest deviation of the pressure from `expected`, relative to it.
fn worst<const D: usize>(outcome: &Outcome<D>, expected: f64) -> f64 {
    let off = outcome
        .liquid
        .iter()
        .map(|liquid| (liquid.pressure / expected - 1.0).abs());
    off.fold(0.0, f64::max)
}

#[track_caller]
fn check<const D: usize>(outcome: &Outcome<D>, what: &[String], pressure: f64, energy: f64) {
    let off = worst(outcome, pressure);
    let energy = outcome.summary.energy.last / energy - 1.0;
    println!("pressure within {off:.1e}, energy {energy:+.1e} {what:?}");
    assert!(off < 0.01, "{what:?}: pressure off by {off}");
    assert!(energy.abs() < 0.01, "{what:?}: energy off by {energy}");
}

/// The box with `cells`, and whether left and right are alike.
#[track_caller]
fn check_box(set: &[String]) {
    let outcome = run_in::<2>(&scene(SEALED_BOX, set), None, &mut |_| {}).unwrap();
    let volume: f64 = outcome.particles.volume.iter().sum();
    check(
        &outcome,
        set,
        -LOAD * Q / (Q + M),
        volume * LOAD * LOAD / (2.0 * (Q + M)),
    );
    let (x, liquid) = (&outcome.particles.initial_position, &outcome.liquid);
    for (here, one) in x.iter().zip(liquid) {
        let other = x
            .iter()
            .position(|there| (there[0] + here[0] - 1.0).abs() + (there[1] - here[1]).abs() < 1e-9)
            .unwrap();
        let differ = (one.pressure - liquid[other].pressure).abs() / one.pressure.abs();
        assert!(differ < 1e-9, "{set:?}: left and right differ by {differ}");
    }
}

/// Any permeability and both treatments of the drag, with the explicit one where its steps are not too small.
#[test]
fn a_sealed_box_is_undrained_for_any_permeability() {
    for basis in BASES {
        for reconstruction in ["shepard", "taylor"] {
            for exponent in 2..=10 {
                for drag in ["implicit", "explicit"] {
                    if drag == "explicit" && exponent > 4 {
                        continue;
                    }
                    let mut set = method(basis, reconstruction).to_vec();
                    set.push(format!("material.permeability=1e-{exponent}"));
                    set.push(format!("material.drag={drag:?}"));
                    check_box(&set);
                }
            }
        }
    }
}

/// From one particle across, where one equation a particle was enough, to eight in one cell and in four;
/// oblong cells too.
#[test]
fn a_sealed_box_is_undrained_with_any_number_of_particles_across() {
    for basis in BASES {
        for reconstruction in ["shepard", "taylor"] {
            if (basis, reconstruction) == ("bspline", "taylor") {
                // In the plane it is noise beyond one cell, drained or not: Gauss forces over lumped masses.
                continue;
            }
            for (across, per_cell) in [(1, 1), (1, 2), (1, 8), (2, 1), (4, 2), (3, 4)] {
                let mut set = method(basis, reconstruction).to_vec();
                set.push(format!("grid.cells=[{across}, 8]"));
                set.push(format!("body.0.particles_per_cell=[{per_cell}, 2]"));
                check_box(&set);
            }
        }
    }
}

/// The surface lies where a cell ends, deep in a cell, and barely in one. There the load itself is felt up to
/// a fifth too weak or strong by single particles, since a cut cell's particles are poor points of its
/// integral; the liquid takes its share of what is felt.
#[test]
fn a_sealed_box_is_undrained_wherever_its_surface_lies() {
    for basis in BASES {
        for cells in [9, 10, 11, 13] {
            let mut set = method(basis, "shepard").to_vec();
            set.push(format!("grid={{min=[0, 0], max=[1, 1.25], cells=[2, {cells}]}}"));
            let outcome = run_in::<2>(&scene(SEALED_BOX, &set), None, &mut |_| {}).unwrap();
            let states = outcome.liquid.iter().zip(&outcome.particles.stress);
            for (liquid, stress) in states {
                let share = liquid.pressure / (liquid.pressure + stress[(1, 1)]);
                let off = share / (Q / (Q + M)) - 1.0;
                assert!(off.abs() < 0.01, "{set:?}: the liquid's share is off by {off}");
            }
        }
    }
}

/// A roof that the box does not reach is no wall of its liquid: under its own weight the mean pressure stays
/// the undrained one,
/// `Q / (Q + M)` of the mean total stress `rho g H / 2`, while the liquid settles to `p' = rho_w g` within.
#[test]
fn a_wall_out_of_reach_does_not_drain_a_surface() {
    let weight = [
        "grid={min=[0, 0], max=[1, 1.25], cells=[2, 10]}",
        "boundary=[{face='x-min', roller=true}, {face='x-max', roller=true}, {face='y-min', roller=true},
        {face='y-max', roller=true}]",
        "load.body_force=['0', '-9.81*sin(pi/2*min(t/0.3, 1))^2']",
        "material.permeability=1e-2",
    ]
    .map(str::to_owned);
    let expected = -Q / (Q + M) * (0.6 * 2.65e3 + 0.4 * 1e3) * 9.81 / 2.0;
    for basis in BASES {
        let set = [&weight[..], &method(basis, "shepard")].concat();
        let outcome = run_in::<2>(&scene(SEALED_BOX, &set), None, &mut |_| {}).unwrap();
        let sum: f64 = outcome.liquid.iter().map(|liquid| liquid.pressure).sum();
        let off = sum / outcome.liquid.len() as f64 / expected - 1.0;
        assert!(off.abs() < 0.01, "{basis}: {off}");
    }
}

/// A layer that drains through its base alone, its surface at two heights in each cell: one equation a point
/// would fix all slip in the uppermost cells, and their pressure would stay what it was.
///
/// Expected: in the mean of the two uppermost cells, between which the points of uneven cells leave noise,
/// Terzaghi's series between those of the two heights, 0.556 to 0.596 of the initial pressure (0.7 if the
/// uppermost cells keep theirs).
#[test]
fn an_uneven_sealed_surface_lets_its_cells_drain_downwards() {
    let (low, high, time) = (0.95, 1.0, 2.775);
    let inside = "inside='0.975 - y + 0.1*max(sin(40*pi*x), 0)',";
    for basis in BASES {
        let set = [&layer(time, "", inside)[..], &method(basis, "shepard")].concat();
        let outcome = run_in::<2>(&scene(SEALED_BOX, &set), None, &mut |_| {}).unwrap();
        let places = outcome.particles.initial_position.iter().zip(&outcome.liquid);
        let top: Vec<_> = places.filter(|(x, _)| x[1] > 0.8).collect();
        let mean_of = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / top.len() as f64;
        let mean = mean_of(&mut top.iter().map(|(_, liquid)| liquid.pressure / -7878.787879));
        let expected = |height: f64| {
            let scaled = diffusivity(1e-4) * time / (height * height);
            mean_of(
                &mut top
                    .iter()
                    .map(|(x, _)| terzaghi((x[1] / height).min(1.0), scaled)),
            )
        };
        let expected = expected(low)..expected(high);
        println!("{basis}: {mean} in {expected:?}");
        assert!(expected.contains(&mean), "{basis}: {mean} is not in {expected:?}");
    }
}

/// Noise in the solid, no load, nearly the largest stable step, little drag: the energy falls. With Shepard:
/// published TLS gains some in the plane, drained or not.
#[test]
fn no_energy_comes_through_a_sealed_surface() {
    let noise = "sin(1e4*sin(1e4*(x+2*y+1)))*1e-6";
    for basis in BASES {
        for room in [1.0, 1.25] {
            let mut set = method(basis, "shepard").to_vec();
            set.extend([
                format!("grid={{min=[0, 0], max=[1, {room}], cells=[4, 11]}}"),
                "time={step='auto', safety=0.95, end=0.4}".to_owned(),
                "material.permeability=1e-1".to_owned(),
                format!("body.0.velocity=['{noise}', '{noise}']"),
                "boundary=[{face='x-min', roller=true}, {face='y-min', roller=true}]".to_owned(),
            ]);
            let outcome = run_in::<2>(&scene(SEALED_BOX, &set), None, &mut |_| {}).unwrap();
            let energy = outcome.summary.energy;
            assert!(energy.last < energy.initial, "{set:?}: {energy:?}");
        }
    }
}

/// A wall that the liquid passes, under a sealed top and under a drained one, with both treatments of the
/// drag.
///
/// Expected: Terzaghi's series of a layer that drains on one side, or on two: the mean pressure of a cell
/// within 2 % of the initial one. With the drag felt at the step's end the liquid at the wall moved with the
/// solid in the accelerations and not in the mapped velocities, and the energy ended at 4000 J/m instead of
/// 0.4.
#[test]
fn a_wall_that_the_liquid_passes_drains_a_layer() {
    for basis in BASES {
        for (top, drained) in [("", false), (", drained=true", true)] {
            for (drag, permeability, time) in [
                ("implicit", 1e-4, 2.0),
                ("implicit", 3e-5, 3.0),
                ("implicit", 1e-7, 0.3),
                ("explicit", 1e-3, 0.2),
            ] {
                let set = [
                    &layer(time, top, "")[..],
                    &method(basis, "shepard"),
                    &[
                        format!("material.permeability={permeability}"),
                        format!("material.drag={drag:?}"),
                    ],
                ]
                .concat();
                let outcome = run_in::<2>(&scene(SEALED_BOX, &set), None, &mut |_| {}).unwrap();
                let path = if drained { 0.5 } else { 1.0 };
                let scaled = diffusivity(permeability) * time / (path * path);
                // With linear functions the pressure of a cell is that of its mean.
                let mut off = [0.0; 10];
                for (x, liquid) in outcome.particles.initial_position.iter().zip(&outcome.liquid) {
                    let exact = terzaghi(x[1] / path, scaled);
                    off[(x[1] * 10.0) as usize] += (liquid.pressure / -7878.787879 - exact) / 16.0;
                }
                // Two rows of particles do not tell the mean of what drains in the outermost cells.
                let told = if drained { 1..9 } else { 1..10 };
                let worst = off[told].iter().fold(0.0_f64, |worst, off| worst.max(off.abs()));
                println!("pressure of cells within {worst:.1e} {set:?}");
                assert!(worst < 0.02, "{set:?}: {off:?}");
            }
        }
    }
}

/// A layer 1 m high on a drained base, undrained at the start.
fn layer(time: f64, top: &str, inside: &str) -> [String; 4] {
    [
        "grid={min=[0, 0], max=[0.2, 1.1], cells=[2, 11]}".to_owned(),
        format!("time.end={time}"),
        format!(
            "body=[{{min=[0, 0], max=[0.2, 1], particles_per_cell=[4, 2], {inside}
            stress={{xx='-909.0909091', yy='-2121.212121'}}, pore_pressure='-7878.787879'}}]"
        ),
        format!(
            "boundary=[{{face='x-min', roller=true}}, {{face='x-max', roller=true}},
            {{face='y-min', roller=true, drained=true}}, {{face='y-max', traction=['0', '-1e4']{top}}}]"
        ),
    ]
}

/// Coefficient of consolidation with the liquid's storage (m2/s): `k / (rho_w g) / (1/M + n/K_w)`.
fn diffusivity(permeability: f64) -> f64 {
    permeability / (1e3 * 9.81) / (1.0 / M + 1.0 / Q)
}

/// Pressure over the initial one at the share `z` of the way from the drained to the sealed end, after the
/// scaled `time`.
fn terzaghi(z: f64, time: f64) -> f64 {
    let waves = (0..2000).map(|m| f64::from(2 * m + 1) * PI / 2.0);
    waves
        .map(|wave| 2.0 / wave * (wave * z).sin() * (-wave * wave * time).exp())
        .sum()
}

#[track_caller]
fn check_layer(set: &[String]) {
    let (q, m) = (2e9 / 0.45, 5e6);
    let outcome = run(&scene(LAYER, set), None, &mut |_| {}).unwrap();
    check(&outcome, set, -1e5 * q / (q + m), 4.0 * 1e10 / (2.0 * (q + m)));
}

/// Linear functions and B-splines with Shepard ended at 1e6 J/m2 or off the grid, with k from 1e-3 m/s on,
/// while the constraint was one on the accelerations alone.
#[test]
fn a_sealed_layer_is_undrained_for_any_permeability() {
    check_permeabilities(&[2, 3, 10]);
}

#[test]
#[ignore = "60 s: cargo test --release permeabilities_between_seal_alike -- --ignored"]
fn permeabilities_between_seal_alike() {
    check_permeabilities(&[4, 5, 6, 7, 8, 9]);
}

fn check_permeabilities(exponents: &[i32]) {
    for basis in BASES {
        for reconstruction in ["shepard", "taylor", "relaxed-taylor"] {
            for &exponent in exponents {
                let inside = (reconstruction == "relaxed-taylor").then_some(INSIDE);
                for room in ROOMS.into_iter().chain(inside) {
                    let mut set = method(basis, reconstruction).to_vec();
                    set.push(room.to_owned());
                    set.push(format!("material.permeability=1e-{exponent}"));
                    check_layer(&set);
                    if exponent < 4 {
                        set.push("material.drag='explicit'".to_owned());
                        check_layer(&set);
                    }
                }
            }
        }
    }
}

/// A slab of one cell, squeezed on both sides: the two surfaces share every DOF that they see.
#[test]
fn two_surfaces_that_share_their_dofs_are_both_sealed() {
    let slab = [
        "grid={min=[0], max=[1], cells=[10]}".to_owned(),
        "body=[{min=[0.42], max=[0.5], particles_per_cell=[8]}]".to_owned(),
        "boundary=[{face='x-min', traction=['1e5*sin(pi/2*min(t/0.01, 1))^2']},
        {face='x-max', traction=['-1e5*sin(pi/2*min(t/0.01, 1))^2']}]"
            .to_owned(),
        "time.end=0.015".to_owned(),
    ];
    let (q, m) = (2e9 / 0.45, 5e6);
    for basis in BASES {
        for reconstruction in ["shepard", "taylor", "relaxed-taylor"] {
            if (basis, reconstruction) == ("bspline", "taylor") {
                // Published TLS gains energy in cells that are cut.
                continue;
            }
            let set = [&slab[..], &method(basis, reconstruction)].concat();
            let outcome = run(&scene(LAYER, &set), None, &mut |_| {}).unwrap();
            let length: f64 = outcome.particles.volume.iter().sum();
            check(
                &outcome,
                &set,
                -1e5 * q / (q + m),
                length * 1e10 / (2.0 * (q + m)),
            );
        }
    }
}
