//! Goal: slips of a careless user are refused in one line that names the key, its value and what is allowed,
//! before anything is computed where that is possible.
//! Parameters: a block of 0.4 m on the floor of its grid, with one or two slips a scene.
//! Expected: the fragments below.

use materialpoint_command::run::{RunError, run_in, warnings};
use materialpoint_command::scene::{Scene, SceneError};

use super::scene;

const TYPOS: &str = include_str!("typos.toml");
const TWICE: &str = include_str!("face-twice.toml");
const POLE: &str = include_str!("pole.toml");

#[track_caller]
fn assert_says(text: &str, fragments: &[&str]) {
    assert!(!text.contains('\n'), "{text:?}");
    for fragment in fragments {
        assert!(text.contains(fragment), "{text:?} lacks {fragment:?}");
    }
}

fn refused(text: &str, set: &[&str]) -> SceneError {
    let set: Vec<String> = set.iter().map(ToString::to_string).collect();
    Scene::from_toml(text, &set).unwrap_err()
}

fn stopped(text: &str, set: &[&str]) -> RunError {
    run_in::<2>(&scene(text, set), None, &mut |_| {}).unwrap_err()
}

/// What is wrong with an expression, whether it is found in the scene or once the particles are there.
fn said_of_expression(text: &str, set: &[&str]) -> String {
    let owned: Vec<String> = set.iter().map(ToString::to_string).collect();
    match Scene::from_toml(text, &owned) {
        Err(error) => error.to_string(),
        Ok(scene) => {
            let error = run_in::<2>(&scene, None, &mut |_| {}).unwrap_err();
            assert!(matches!(error, RunError::Expression(_)), "{error}");
            error.to_string()
        }
    }
}

#[test]
fn slips_of_the_pen_are_named_with_what_is_allowed() {
    let error = refused(TYPOS, &[]);
    assert!(matches!(error, SceneError::UnknownKey { .. }), "{error}");
    let fragments = [
        "material.law.neo-hookean.young_modulus",
        "youngs_modulus, poissons_ratio",
    ];
    assert_says(&error.to_string(), &fragments);
    let mended = "material.law={neo-hookean={youngs_modulus=1e5, poissons_ratio=0.3}}";
    let error = refused(TYPOS, &[mended]);
    assert!(matches!(error, SceneError::WrongType { .. }), "{error}");
    assert_says(
        &error.to_string(),
        &["boundary.0.roller = \"y\"", "expected true"],
    );
    scene(TYPOS, &[mended, "boundary.0.roller=true"]);
}

#[test]
fn a_face_named_twice_and_a_step_too_large_are_named() {
    let error = refused(TWICE, &[]);
    assert!(matches!(error, SceneError::Conflict { .. }), "{error}");
    let fragments = [
        "boundary.1.face = \"y-min\"",
        "boundary.0",
        "one [[boundary]] a face",
    ];
    assert_says(&error.to_string(), &fragments);

    let once = "boundary=[{face='y-min', fixed=true}]";
    let error = stopped(TWICE, &[once]);
    assert!(matches!(error, RunError::Stopped { .. }), "{error}");
    let fragments = [
        "time.step = 5.000e-2 s is above the largest stable step",
        "take a smaller one or \"auto\"",
    ];
    assert_says(&error.to_string(), &fragments);
}

/// The pole at 0.013 s is met but for round-off: its value is finite and huge, so the run stops in the step
/// after it.
#[test]
fn a_body_force_with_a_pole_is_named() {
    let said = warnings(&scene(POLE, &[])).unwrap();
    let named = "load.body_force.1 = \"-9.81/(t-0.013)\"";
    assert!(said.iter().any(|warning| warning.contains(named)), "{said:?}");
    let error = stopped(POLE, &[]);
    assert!(matches!(error, RunError::Stopped { .. }), "{error}");
    assert_says(&error.to_string(), &["step 14", "look at the loads"]);

    for (force, fragments) in [
        ("-9.81/t", ["-inf at t = 0", "it must be finite there"]),
        ("sqrt(0.05-t)", ["NaN at t = 0.", "it must be finite there"]),
    ] {
        let text = said_of_expression(POLE, &[&format!("load.body_force=['0', '{force}']")]);
        assert_says(&text, &[&format!("load.body_force.1 = \"{force}\"")]);
        assert_says(&text, &fragments);
    }
}
