//! Random scenes, as text, from reading to the files.
//!
//! * Valid scenes ([`scene_text`]): most are accepted (all but 1 %; what is refused is refused by a typed
//!   error), and a run of at most 80 steps is done or stops with a typed error of the step. What it prints
//!   and writes holds no `NaN` and no infinity. Shepard, TLS and relaxed TLS keep mass and momentum to 1e-10
//!   in `f64` (5e5 roundings; sums here have at most 2e3 terms), and to 1e-3 in `f32`, also where the step is
//!   far too large.
//! * Damaged scenes ([`damage`]): they are read or refused in one line, and reading never panics.

mod damage;
mod scene_text;

use std::fs;

use materialpoint_command::output::Folder;
use materialpoint_command::run::{Outcome, RunError, critical_step, run};
use materialpoint_command::scene::{ReconstructionKind, ScalarKind, Scene, StepSize};
use proptest::prelude::*;
use proptest::test_runner::{TestCaseError, TestRunner};
use scene_text::{MOST_STEPS, Text, scene_text};

/// What became of the scenes.
#[derive(Debug, Default)]
struct Tally {
    refused: usize,
    stopped: usize,
    nothing_resists: usize,
    done: usize,
}

impl Tally {
    fn count(&mut self, end: End) {
        match end {
            End::Refused => self.refused += 1,
            End::Stopped => self.stopped += 1,
            End::NothingResists => self.nothing_resists += 1,
            End::Done => self.done += 1,
        }
    }
}

/// How one scene ended.
enum End {
    Refused,
    Stopped,
    NothingResists,
    Done,
}

#[test]
fn a_valid_scene_runs_to_its_end_or_stops_with_a_reason() {
    let path = std::env::temp_dir().join(format!("materialpoint-generated-{}", std::process::id()));
    let folder = Folder::create(&path).unwrap();
    let tally = std::cell::RefCell::new(Tally::default());
    let result = TestRunner::new(crate::identities::config()).run(&scene_text(), |text| {
        tally.borrow_mut().count(end_of(&text, &folder)?);
        Ok(())
    });
    fs::remove_dir_all(&path).unwrap();
    result.unwrap_or_else(|failure| panic!("{failure}"));
    let tally = tally.into_inner();
    println!("{tally:?}");
    let Tally {
        refused,
        stopped,
        nothing_resists,
        done,
    } = tally;
    let all = refused + stopped + nothing_resists + done;
    assert!(100 * refused <= all && 2 * done >= all, "{tally:?}");
}

fn end_of(text: &Text, folder: &Folder) -> Result<End, TestCaseError> {
    let mut scene = match Scene::from_toml(&text.0, &[]) {
        Ok(scene) => scene,
        Err(error) => {
            prop_assert!(!error.to_string().is_empty());
            return Ok(End::Refused);
        }
    };
    bound_steps(&mut scene)?;
    match run(&scene, Some(folder), &mut |_| {}) {
        Ok(outcome) => {
            check_files(&outcome)?;
            check_summary(&scene, &outcome)?;
            Ok(End::Done)
        }
        Err(RunError::NoCriticalStep) => Ok(End::NothingResists),
        Err(RunError::Stopped { .. } | RunError::NoEnergy { .. } | RunError::NoEnergyAtStart { .. }) => {
            Ok(End::Stopped)
        }
        Err(other) => Err(TestCaseError::fail(format!("a scene that was accepted: {other}"))),
    }
}

/// Ends a scene of automatic steps earlier if its layout makes them small.
fn bound_steps(scene: &mut Scene) -> Result<(), TestCaseError> {
    let critical = critical_step(scene).map_err(|error| TestCaseError::fail(error.to_string()))?;
    let Some(critical) = critical else {
        return Ok(());
    };
    prop_assert!(critical.step > 0.0 && critical.step.is_finite(), "{critical:?}");
    if let StepSize::Auto { .. } = scene.time.step {
        scene.time.end = scene.time.end.min(MOST_STEPS * scene.safety() * critical.step);
    }
    Ok(())
}

fn check_files(outcome: &Outcome) -> Result<(), TestCaseError> {
    for file in &outcome.files {
        let text = fs::read_to_string(file).unwrap();
        fs::remove_file(file).unwrap();
        let rows = text.lines().skip(1);
        prop_assert_eq!(rows.clone().count(), outcome.summary.particles);
        for number in rows.flat_map(|row| row.split(',')) {
            let number: f64 = number.parse().unwrap();
            prop_assert!(number.is_finite(), "{}:\n{text}", file.display());
        }
    }
    Ok(())
}

fn check_summary(scene: &Scene, outcome: &Outcome) -> Result<(), TestCaseError> {
    // JSON has no word for what is not finite but `null`, and everything absent is left out.
    let json = serde_json::to_string(&outcome.summary).unwrap();
    prop_assert!(!json.contains("null"), "{json}");
    if scene.method.reconstruction == ReconstructionKind::Spline {
        return Ok(());
    }
    let bound = match scene.method.scalar {
        ScalarKind::F64 => 1e-10,
        ScalarKind::F32 => 1e-3,
    };
    for errors in outcome.summary.conservation.values() {
        prop_assert!(
            errors.mass <= bound && errors.momentum_scaled <= bound,
            "{errors:?}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::identities::config())]

    #[test]
    fn a_damaged_scene_is_read_or_refused_in_one_line(text in damage::damaged(scene_text())) {
        if let Err(error) = Scene::from_toml(&text.0, &[]) {
            let message = error.to_string();
            prop_assert!(message.lines().count() == 1, "{message}");
        }
    }
}

/// A law that remembers moves volumes where a relaxation moves its stress, and a volume holds its liquid's
/// mass: mapped with the masses of then the liquid's momentum was off by 4e-5 of itself.
#[test]
fn a_liquid_keeps_its_momentum_where_volumes_are_relaxed() {
    let scene = "title = \"Two bodies\"\n\
         [grid]\nmin = [0.0]\nmax = [1.0]\ncells = [2]\n\
         [time]\nend = 1e-2\nstep = \"auto\"\n\
         [method]\nbasis = \"linear\"\nreconstruction = \"relaxed-taylor\"\n\
         [material]\nstrain = \"large\"\nlaw.neo-hookean = { youngs_modulus = 100.0 }\nphases = 2\nporosity = 0.01\n\
         solid_density = 1.0\nliquid_density = 1e3\nliquid_bulk_modulus = 1e4\npermeability = 1.0\n\
         [[body]]\nmin = [0.0]\nmax = [0.0134]\nparticles_per_cell = [1]\nvelocity = [\"201.0\"]\n\
         [[body]]\nmin = [0.0134]\nmax = [1.0]\nparticles_per_cell = [3]\n\
         [[boundary]]\nface = \"x-min\"\ndrained = true\n\
         [[boundary]]\nface = \"x-max\"\ntraction = [\"20.0\"]\n";
    let scene = Scene::from_toml(scene, &[]).unwrap();
    let outcome = run(&scene, None, &mut |_| {}).unwrap();
    assert_eq!(outcome.summary.conservation.len(), 2);
    for errors in outcome.summary.conservation.values() {
        assert!(errors.momentum_scaled < 1e-13, "{errors:?}");
    }
}
