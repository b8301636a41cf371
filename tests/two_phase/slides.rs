//! Walls that rub with two phases, as scenes.
//!
//! Source: Coulomb's law with effective stress. Goal: what the steppers do scenes can ask for. Parameters: a
//! slab of soil 1 m x 0.25 m on a sealed floor of friction 0.5 that bears 10 kPa on all sides and, along its
//! top, 2 kPa; a column between smooth walls under 10 kPa on a floor that may let go. Expected: pushed at
//! once the slab slides, since its water bears the load, and stops when it has drained, where 2 kPa are less
//! than what friction bears; drained from the start it stays; the column is that on a roller.

use materialpoint_command::run::{Outcome, run_in};
use materialpoint_command::scene::Scene;

fn scene(text: &str) -> Scene {
    Scene::from_toml(text, &[]).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// The slab under loads that come within so long (s).
fn slab(permeability: f64, end: f64, basis: &str) -> Outcome<2> {
    let load = "*min(t/0.005, 1)";
    run_in::<2>(
        &scene(&format!(
            r#"
title = "Slab"
[grid]
min = [0, 0]
max = [1.75, 0.375]
cells = [28, 6]
[time]
step = "auto"
safety = 0.5
end = {end:?}
[method]
basis = "{basis}"
reconstruction = "shepard"
[material]
phases = 2
strain = "small"
law.linear-elastic = {{ youngs_modulus = 1e7, poissons_ratio = 0.0 }}
porosity = 0.4
solid_density = 2.65e3
liquid_density = 1e3
liquid_bulk_modulus = 1e8
permeability = {permeability:?}
[[body]]
min = [0.375, 0]
max = [1.375, 0.25]
particles_per_cell = [2, 2]
[[boundary]]
face = "y-min"
friction = 0.5
[[boundary]]
face = "x-min"
traction = ["1e4{load}", "0"]
[[boundary]]
face = "x-max"
traction = ["-1e4{load}", "0"]
[[boundary]]
face = "y-max"
traction = ["2e3{load}", "-1e4{load}"]
drained = true
"#
        )),
        None,
        &mut |_| {},
    )
    .unwrap()
}

/// Velocity (m/s) and way (m) along the floor, mean.
fn motion(outcome: &Outcome<2>) -> [f64; 2] {
    let particles = &outcome.particles;
    let count = particles.len() as f64;
    [
        particles.velocity.iter().map(|v| v[0]).sum::<f64>() / count,
        particles.displacement.iter().map(|u| u[0]).sum::<f64>() / count,
    ]
}

#[test]
fn a_slab_that_is_pushed_slides_until_it_has_drained() {
    for basis in ["linear", "bspline"] {
        let [early, _] = motion(&slab(1e-3, 0.015, basis));
        // 2 kPa on 498 kg of every square metre.
        let free = 2e3 / 497.5 * (0.015 - 0.0025);
        let [late, way] = motion(&slab(1e-3, 0.5, basis));
        let [never, little] = motion(&slab(10.0, 0.3, basis));
        println!("{basis}: {early} of {free}, then {late} after {way}; drained {never} {little}");
        assert!(early > 0.6 * free && early < free, "{basis}: {early} {free}");
        assert!(late.abs() < 0.02 * early, "{basis}: {late}");
        assert!(way > 2e-4, "{basis}: {way}");
        assert!(little.abs() < 0.2 * way, "{basis}: {little}");
    }
}

/// A column between smooth walls under a load, on a floor that is `held` so and drained or not.
fn column(floor: &str) -> Outcome<3> {
    run_in::<3>(
        &scene(&format!(
            r#"
title = "Column"
[grid]
min = [0, 0, 0]
max = [0.2, 1, 0.2]
cells = [2, 10, 2]
[time]
step = 2e-4
end = 0.1
[method]
basis = "linear"
reconstruction = "shepard"
[material]
phases = 2
strain = "small"
law.linear-elastic = {{ youngs_modulus = 1e7, poissons_ratio = 0.2 }}
porosity = 0.4
solid_density = 2.65e3
liquid_density = 1e3
liquid_bulk_modulus = 2e7
permeability = 2e-3
[[body]]
min = [0, 0, 0]
max = [0.2, 1, 0.2]
particles_per_cell = [2, 2, 2]
[[boundary]]
face = "x-min"
roller = true
[[boundary]]
face = "x-max"
roller = true
[[boundary]]
face = "z-min"
roller = true
[[boundary]]
face = "z-max"
roller = true
[[boundary]]
face = "y-min"
{floor}
[[boundary]]
face = "y-max"
traction = ["0", "-1e4*sin(pi/2*min(t/0.05, 1))^2", "0"]
drained = true
"#
        )),
        None,
        &mut |_| {},
    )
    .unwrap()
}

#[test]
fn what_a_floor_that_may_let_go_bears_in_space_is_what_a_roller_bears() {
    for pores in ["", "drained = true", "pore_pressure = '-1e3*min(t/0.05, 1)'"] {
        let held = column(&format!("roller = true\n{pores}"));
        let rubs = column(&format!("friction = 0.4\n{pores}"));
        let pairs = held.liquid.iter().zip(&rubs.liquid);
        let off = pairs
            .map(|(a, b)| (a.pressure - b.pressure).abs())
            .fold(0.0, f64::max)
            / 1e4;
        println!("{pores:?}: {off:.2e}");
        assert!(off < 5e-3, "{pores:?}: {off}");
        let warned = rubs
            .summary
            .warnings
            .iter()
            .any(|warning| warning.contains("contact"));
        assert!(!warned, "{:?}", rubs.summary.warnings);
    }
}
