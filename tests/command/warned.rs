//! Warnings as a user meets them: before a run, by `check`, and beside the error of a run that stops.

use super::{materialpoint, text};

/// A body on the grid's edge without a floor.
const FALLS: &str = r#"
title = "No floor"
[grid]
min = [0.0, 0.0]
max = [1.0, 1.0]
cells = [10, 10]
[time]
step = 1e-3
end = 0.1
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 1e5, poissons_ratio = 0.3 }
density = 1000.0
[[body]]
min = [0.2, 0.0]
max = [0.6, 0.4]
particles_per_cell = [2, 2]
[load]
body_force = ["0", "-9.81"]
"#;

fn scene(name: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.toml"));
    std::fs::write(&path, FALLS).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn check_and_run_warn_alike_and_a_run_that_stops_says_it_too() {
    let scene = scene("no-floor");
    let first = |arguments: &[&str], status| {
        let (output, _) = materialpoint("no-floor", arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{said}");
        said.lines().next().unwrap_or_default().to_owned()
    };
    let checked = first(&["check", &scene], 0);
    for fragment in [
        "warning: body.0 touches y-min",
        "load.body_force.1",
        "face = \"y-min\"",
    ] {
        assert!(checked.contains(fragment), "{checked}");
    }
    assert_eq!(
        first(&["run", &scene, "--quiet", "--set", "time.end=0.05"], 0),
        checked
    );
    assert_eq!(first(&["run", &scene, "--quiet"], 3), checked);
}

#[test]
fn json_says_when_velocities_live_and_what_is_warned_of() {
    let scene = scene("no-floor-json");
    let (output, _) = materialpoint(
        "no-floor-json",
        &["run", &scene, "--json", "--set", "time.end=0.05"],
    );
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!((summary["velocity_time"].as_f64().unwrap() - 0.0495).abs() < 1e-15);
    assert_eq!(summary["warnings"].as_array().unwrap().len(), 1);
    let (output, _) = materialpoint("no-floor-json", &["check", &scene, "--json"]);
    let checked: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(checked["warnings"], summary["warnings"]);
}
