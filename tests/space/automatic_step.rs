//! Source: ExaMPM #43, taichi #3162 (a step that is stable at the start need not be later); Courant,
//! Friedrichs & Lewy (1928). Goal: `step = "auto"` is renewed as the run goes, so that nothing gains energy
//! at the default; a fixed step is looked at likewise. Parameters: water that swings in a closed tube at a
//! tenth and a fifth of its speed of sound until the waves break; a bar that rings in flight (both of them
//! gained energy severalfold, or stopped, with half the critical step of the start). Expected: no load, walls
//! at rest: the energy never rises, but for what crossing cell edges gives, some per cent. While the tube is
//! at rest `h / (c + |v|)` is the step of linear functions; where waves break c and |v| are greater and the
//! step is less.

use materialpoint_command::run::{Outcome, run_in};
use materialpoint_command::scene::Scene;

use super::scene;

const TUBE: &str = r#"
title = "Water swings in a closed tube"
[grid]
min = [0.0, 0.0]
max = [1.0, 0.1]
cells = [40, 4]
[time]
step = "auto"
end = 0.12
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "large"
law.newtonian-fluid = { bulk_modulus = 1e5, gamma = 7.0, viscosity = 0.0 }
density = 1000.0
[[body]]
min = [0.0, 0.0]
max = [1.0, 0.1]
particles_per_cell = [2, 2]
velocity = ["-1*sin(2*pi*x)", "0"]
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
roller = true
"#;

const BAR: &str = r#"
title = "Ringing bar in flight"
[grid]
min = [0.0]
max = [4.0]
cells = [160]
[time]
step = "auto"
end = 1.0
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 1e6 }
density = 1000.0
[[body]]
min = [0.8]
max = [1.8]
particles_per_cell = [2]
velocity = ["0.85 + 0.3*sin(60*x)"]
"#;

const BASES: [&str; 3] = ["linear", "dual-domain", "bspline"];

fn run<const D: usize>(scene: &Scene) -> Outcome<D>
where
    Scene: materialpoint_command::run::InSpace<D>,
{
    run_in::<D>(scene, None, &mut |_| {}).unwrap()
}

#[test]
fn water_that_stiffens_keeps_its_energy_at_the_default_step() {
    for basis in BASES {
        for speed in [1, 2] {
            let velocity = format!("body.0.velocity=[\"-{speed}*sin(2*pi*x)\", \"0\"]");
            let scene = scene(TUBE, &[&velocity, &format!("method.basis={basis}")]);
            let summary = run::<2>(&scene).summary;
            let ratio = summary.energy.highest_ratio.unwrap();
            assert!(ratio < 1.05, "{basis}, {speed} m/s: {ratio}");
            assert_eq!(summary.time, 0.12);
            // The greatest speeds grow from 10 m/s and the tube's by half at least.
            let [least, most] = summary.time_step_range.unwrap();
            assert!(least < most / 1.5, "{basis}: {least} {most}");
            assert!((summary.time_step * summary.steps as f64 / 0.12 - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn a_bar_that_rings_in_flight_keeps_its_energy_at_the_default_step() {
    for basis in BASES {
        let scene = scene(BAR, &[&format!("method.basis={basis}")]);
        let ratio = run::<1>(&scene).summary.energy.highest_ratio.unwrap();
        assert!(ratio < 1.05, "{basis}: {ratio}");
    }
}

/// Linear functions along one axis in full cells: h / (c + |v|), neo-Hookean c = sqrt(E / rho) at rest.
#[test]
fn the_step_is_the_classical_one_and_feels_the_speed_of_particles() {
    for speed in [0.0, 100.0] {
        let set = [
            &format!("body.0.velocity=[\"{speed:?}\"]")[..],
            "time={step='auto', safety=1.0, end=1e-3}",
        ];
        let summary = run::<1>(&scene(BAR, &set)).summary;
        let step = 0.025 / (1000.0_f64.sqrt() + speed);
        let expected = (1e-3 / step).ceil();
        assert_eq!(summary.steps as f64, expected, "{speed} m/s");
    }
}

/// 1.2 ms is less than the water's step of the start and more than it can bear once the waves steepen.
#[test]
fn a_fixed_step_that_becomes_too_large_is_warned_of_once() {
    let warned = |step: &str| {
        let scene = scene(TUBE, &[&format!("time.step={step}")]);
        let warnings = run::<2>(&scene).summary.warnings;
        let about: Vec<_> = warnings
            .into_iter()
            .filter(|w| w.starts_with("time.step"))
            .collect();
        assert!(about.len() <= 1, "{about:?}");
        about.first().cloned()
    };
    let warning = warned("1.2e-3").unwrap();
    assert!(
        warning.contains("time.step = 1.200e-3 s is above the largest stable step from 0.0"),
        "{warning}"
    );
    assert_eq!(warned("1e-4"), None);
    let warning = warned("1.7e-3").unwrap();
    assert!(warning.contains("from the start on"), "{warning}");
}

#[test]
fn a_particle_that_leaves_where_nothing_holds_it_names_the_step_and_the_face() {
    for (velocity, face) in [("-1", "x-min"), ("1", "x-max")] {
        // Above the largest stable step, below it, and renewed.
        for step in ["1e-3", "1e-4", "auto"] {
            let set = [
                &format!("body.0.velocity=[\"{velocity}\"]")[..],
                &format!("time.step={step}"),
                "time.end=5.0",
            ];
            let error = run_in::<1>(&scene(BAR, &set), None, &mut |_| {}).unwrap_err();
            let message = error.to_string();
            let key = match step {
                "auto" => "time.safety",
                _ => "time.step",
            };
            let missing = format!("there is no [[boundary]] at {face}, through which it left");
            let (smaller, place) = (message.find(key), message.find(&missing));
            assert!(
                place.is_some() && smaller < place && smaller.is_some(),
                "{message}"
            );
        }
    }
}
