//! Malformed scenes: one mistake each, and what its message must say.
//!
//! Every message is one line of reasonable length that names the key, the value where there is one, and what
//! is allowed.

mod limits;
mod space;
mod text;
mod two_phase;
mod values;

use materialpoint_command::scene::Scene;

/// Longest message, in characters: three lines of a terminal.
const LONGEST: usize = 300;

/// A scene without a reference, with two bodies that touch, that uses every part of the language.
const GOOD: &str = r#"
title = "Good"

[grid]
min = [0.0]
max = [1.0]
cells = [20]

[time]
step = 1e-4
end = 0.1

[method]
basis = "bspline"
degree = 2
reconstruction = "taylor"
velocity_mass = "consistent"
scalar = "f64"

[material]
phases = 1
strain = "large"
law.linear-elastic = { youngs_modulus = 4e4 }
density = 2000.0

[[body]]
min = [0.0]
max = [0.5]
particles_per_cell = [8]
velocity = ["0.8*sin(pi*x)"]
stress = "-10*x"
jitter = 0.5
seed = 3
initialise = "exact"

[[body]]
min = [0.5]
max = [0.75]
particles_per_cell = [4]

[[boundary]]
face = "x-min"
fixed = true

[[boundary]]
face = "x-max"
traction = ["-5*t"]

[load]
body_force = ["-2*t"]

[output]
particles = "csv"
every = 10
checkpoint_every = 0
"#;

/// Name of a case, the edit, and what the message must contain.
type Case = (&'static str, Edit, &'static [&'static str]);

/// What is done to the good scene.
#[derive(Clone, Copy)]
enum Edit {
    /// A piece of its text, found exactly once, is replaced.
    Replace(&'static str, &'static str),
    /// Overrides are applied, one a line.
    Set(&'static str),
}
fn read(scene: &str, edit: Edit) -> Result<Scene, String> {
    let result = match edit {
        Edit::Replace(old, new) => {
            assert_eq!(scene.matches(old).count(), 1, "{old:?} is not there once");
            Scene::from_toml(&scene.replace(old, new), &[])
        }
        Edit::Set(overrides) => {
            let overrides: Vec<_> = overrides.lines().map(String::from).collect();
            Scene::from_toml(scene, &overrides)
        }
    };
    result.map_err(|error| error.to_string())
}

/// Every mistake at once, so that a change of wording shows all it touches.
fn check(scene: &str, cases: &[Case]) {
    let mut failures = Vec::new();
    for &(name, edit, fragments) in cases {
        let message = match read(scene, edit) {
            Ok(_) => {
                failures.push(format!("{name}: accepted"));
                continue;
            }
            Err(message) => message,
        };
        if let Some(missing) = fragments.iter().find(|fragment| !message.contains(**fragment)) {
            failures.push(format!("{name}: no {missing:?} in: {message}"));
        }
        let length = message.chars().count();
        if message.lines().count() != 1 || !(20..=LONGEST).contains(&length) {
            failures.push(format!("{name}: not one readable line: {message}"));
        }
    }
    assert!(failures.is_empty(), "\n{}\n", failures.join("\n"));
}

fn builtin(name: &str) -> &'static str {
    Scene::builtin(name).unwrap_or_else(|| panic!("no scene {name}"))
}

#[test]
fn the_scene_that_is_edited_is_good() {
    let scene = Scene::from_toml(GOOD, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.title, "Good");
    assert_eq!((scene.bodies.len(), scene.boundaries.len()), (2, 2));
}

#[test]
fn text_that_is_not_toml() {
    check(GOOD, text::SYNTAX);
}

#[test]
fn unknown_and_missing_keys() {
    check(GOOD, text::KEYS);
}

#[test]
fn wrong_types() {
    check(GOOD, text::TYPES);
}

#[test]
fn numbers_out_of_range() {
    check(GOOD, values::NUMBERS);
}

#[test]
fn unknown_names() {
    check(GOOD, text::NAMES);
}

#[test]
fn things_that_do_not_go_together() {
    check(GOOD, values::COMBINATIONS);
}

#[test]
fn bodies_and_boundaries() {
    check(GOOD, values::BODIES);
}

#[test]
fn expressions() {
    check(GOOD, values::EXPRESSIONS);
}

#[test]
fn what_a_later_version_may_do() {
    check(GOOD, limits::NOT_IN_THIS_VERSION);
}

#[test]
fn a_scene_that_is_not_its_reference() {
    check(builtin("vibrating-bar-large"), limits::BAR);
    check(builtin("column-compaction"), limits::COLUMN);
}

#[test]
fn scenes_in_the_plane() {
    check(builtin("manufactured"), space::WAVES);
    check(builtin("vortex"), space::VORTEX);
    check(builtin("granular-column"), space::SAND);
}

#[test]
fn the_scene_of_two_phases_is_good() {
    use materialpoint_command::scene::{Initialise, Phases};
    let scene = Scene::from_toml(two_phase::GOOD, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.material.phases.count(), 2);
    assert!(matches!(scene.material.phases, Phases::Two(soil) if soil.permeability_exponent == 2.0));
    assert_eq!(scene.bodies[0].initialise, Initialise::Dofs);
    assert!(scene.boundaries.iter().all(|boundary| boundary.is_open()));
    materialpoint_command::run::run(&scene, None, &mut |_| {}).unwrap();
}

#[test]
fn two_phases_and_their_references() {
    check(GOOD, two_phase::IN_ONE_PHASE);
    check(two_phase::GOOD, two_phase::MATERIAL);
    check(two_phase::GOOD, two_phase::BODIES);
    check(builtin("consolidation"), two_phase::CONSOLIDATION);
    check(builtin("consolidation-large"), two_phase::XIE_LEO);
    check(builtin("standing-wave"), two_phase::WAVE);
    check(builtin("saturated-column"), two_phase::WEIGHT);
}

/// Whatever is cut out of a good scene, there is a scene or a message, and never a panic.
#[test]
fn a_scene_with_any_line_missing_is_read_or_refused_in_one_line() {
    for good in [GOOD, two_phase::GOOD] {
        cut_lines(good);
    }
}

fn cut_lines(scene: &str) {
    let lines: Vec<&str> = scene.lines().collect();
    for skipped in 0..lines.len() {
        let kept = lines.iter().enumerate().filter(|(i, _)| *i != skipped);
        let text: Vec<&str> = kept.map(|(_, line)| *line).collect();
        if let Err(error) = Scene::from_toml(&text.join("\n"), &[]) {
            let message = error.to_string();
            assert!(
                message.lines().count() == 1 && message.len() <= LONGEST,
                "{message}"
            );
        }
    }
}

/// Keys of the good scene, and values that somebody might try: each pair is read or refused in one line.
#[test]
fn any_value_in_any_place_is_read_or_refused_in_one_line() {
    let keys = [
        "title",
        "grid",
        "grid.min",
        "grid.max.0",
        "grid.cells",
        "grid.cells.0",
        "time",
        "time.step",
        "time.end",
        "method",
        "method.basis",
        "method.degree",
        "method.subpoints",
        "method.virtual_points",
        "method.scalar",
        "material.phases",
        "material.law",
        "material.law.linear-elastic",
        "material.density",
        "material.porosity",
        "material.permeability",
        "material.drag",
        "body",
        "body.0",
        "body.0.min",
        "body.1.max.0",
        "body.0.particles_per_cell.0",
        "body.0.velocity",
        "body.0.velocity.0",
        "body.0.stress",
        "body.0.liquid_velocity",
        "body.0.pore_pressure",
        "body.0.initialise",
        "body.0.jitter",
        "body.0.seed",
        "boundary",
        "boundary.0",
        "boundary.0.face",
        "boundary.0.fixed",
        "boundary.0.drained",
        "boundary.0.pore_pressure",
        "boundary.1.traction",
        "boundary.1.traction.0",
        "load",
        "load.body_force",
        "load.gravity",
        "reference",
        "reference.vibrating-bar",
        "reference.column-compaction",
        "reference.consolidation",
        "reference.standing-wave.mode",
        "reference.self-weight",
        "output",
        "output.every",
        "output.checkpoint_every",
    ];
    let values = [
        "0",
        "-1",
        "1",
        "9223372036854775807",
        "-9223372036854775808",
        "1e308",
        "-1e-308",
        "5e-324",
        "nan",
        "inf",
        "-inf",
        "true",
        "\"\"",
        "\"\\n\\u0000\"",
        "\"auto\"",
        "[]",
        "[[]]",
        "[{}]",
        "[0.5]",
        "[\"t\"]",
        "{}",
        "{a={b=[1]}}",
        "1979-05-27T07:32:00Z",
    ];
    for (key, value) in keys
        .iter()
        .flat_map(|key| values.iter().map(move |value| (key, value)))
    {
        let edit = format!("{key}={value}");
        for good in [GOOD, two_phase::GOOD] {
            let Err(error) = Scene::from_toml(good, std::slice::from_ref(&edit)) else {
                continue;
            };
            let message = error.to_string();
            let length = message.chars().count();
            assert!(
                message.lines().count() == 1 && length <= LONGEST,
                "{edit}: {message}"
            );
        }
    }
}
