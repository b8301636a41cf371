//! Goal: every kind of run that a scene can ask for is resumed to the bit, and what does not serve is refused
//! by name.

mod kinds;
mod refusals;

use std::path::PathBuf;

use crate::output::tests::scratch::Scratch;
use crate::run::{InSpace, Outcome, RunError, resume_in, run_in};
use crate::scene::Scene;

/// A bar of two cells whose particles cross: small enough to damage its checkpoint bit by bit.
pub(super) const BAR: &str = r#"
    title = "Bar"
    [grid]
    min = [0]
    max = [4]
    cells = [4]
    [time]
    step = 0.1
    end = 2
    [method]
    basis = "linear"
    reconstruction = "shepard"
    [material]
    strain = "large"
    law.linear-elastic = { youngs_modulus = 1 }
    density = 1
    [[body]]
    min = [0.5]
    max = [1.5]
    particles_per_cell = [2]
    velocity = ["1"]
    [output]
    particles = "none"
    checkpoint_every = 11
"#;

pub(super) fn scene(text: &str, set: &[&str]) -> Scene {
    let set: Vec<_> = set.iter().map(ToString::to_string).collect();
    Scene::from_toml(text, &set).unwrap()
}

/// A folder with the checkpoint that a run of `scene` leaves, and what the run came to.
fn with_checkpoint<const D: usize>(name: &str, scene: &Scene) -> (Scratch, PathBuf, Outcome<D>)
where
    Scene: InSpace<D>,
{
    let scratch = Scratch::new(name);
    let folder = scratch.folder();
    let outcome = run_in::<D>(scene, Some(&folder), &mut |_| {}).unwrap();
    let path = folder.path().join(super::NAME);
    (scratch, path, outcome)
}

fn resume<const D: usize>(scene: &Scene, path: &std::path::Path) -> Result<Outcome<D>, RunError>
where
    Scene: InSpace<D>,
{
    resume_in::<D>(scene, path, None, &mut |_| {})
}

/// Bits of the particles and their liquid.
fn numbers<const D: usize>(outcome: &Outcome<D>) -> Vec<u64> {
    let particles = &outcome.particles;
    let mut numbers = Vec::new();
    let vectors = [
        &particles.initial_position,
        &particles.position,
        &particles.displacement,
        &particles.velocity,
    ];
    for vector in vectors.into_iter().flatten() {
        numbers.extend(vector.iter());
    }
    numbers.extend(particles.stress.iter().flatten());
    numbers.extend(particles.mass.iter().chain(&particles.volume));
    for liquid in &outcome.liquid {
        numbers.extend(liquid.velocity.iter().chain([&liquid.pressure]));
    }
    numbers.into_iter().map(|x: &f64| x.to_bits()).collect()
}

/// The summary but for what the clock says.
fn summary<const D: usize>(outcome: &Outcome<D>) -> serde_json::Value {
    let mut summary = serde_json::to_value(&outcome.summary).unwrap();
    for key in ["wall_seconds", "particle_steps_per_second"] {
        summary.as_object_mut().unwrap().remove(key).unwrap();
    }
    summary
}

#[track_caller]
fn assert_same<const D: usize>(resumed: &Outcome<D>, whole: &Outcome<D>, what: &str) {
    assert!(numbers(resumed) == numbers(whole), "{what}");
    assert_eq!(summary(resumed), summary(whole), "{what}");
}

#[test]
fn a_run_that_is_resumed_at_its_end_has_nothing_left_to_step() {
    let scene = scene(BAR, &["output.checkpoint_every=10"]);
    let (_scratch, path, whole) = with_checkpoint::<1>("resume-end", &scene);
    let mut seen = Vec::new();
    let resumed = resume_in::<1>(&scene, &path, None, &mut |progress| seen.push(progress.step)).unwrap();
    assert_same(&resumed, &whole, "at the end");
    assert_eq!(seen, [20]);
    assert_eq!(resumed.summary.particle_steps_per_second, 0.0);
}

/// The longer run has its own samples of the energy: all else is that of a run that was longer from the
/// start.
#[test]
fn a_later_end_makes_the_run_longer() {
    let (_scratch, path, _) = with_checkpoint::<1>("resume-longer", &scene(BAR, &[]));
    let longer = scene(BAR, &["time.end=2.55"]);
    let resumed = resume::<1>(&longer, &path).unwrap();
    let whole = run_in::<1>(&longer, None, &mut |_| {}).unwrap();
    assert!(numbers(&resumed) == numbers(&whole));
    assert_eq!(resumed.summary.steps, 26);
}

/// With files: a resumed run lists the frames before the checkpoint as the others, and says if they are not
/// there.
#[test]
fn frames_before_the_checkpoint_count() {
    let scene = scene(BAR, &["output.particles=vtu", "output.every=4"]);
    let (scratch, path, whole) = with_checkpoint::<1>("resume-frames", &scene);
    let folder = scratch.folder();
    let index = folder.path().join("particles.pvd");
    let before = std::fs::read(&index).unwrap();
    std::fs::remove_file(&index).unwrap();
    let late = folder.path().join("particles-000003.vtu");
    std::fs::remove_file(&late).unwrap();
    let mut without = scene.clone();
    without.output.checkpoint_every = 0;
    let resumed = resume_in::<1>(&without, &path, Some(&folder), &mut |_| {}).unwrap();
    assert_same(&resumed, &whole, "frames");
    assert_eq!(resumed.files[..], whole.files[..whole.files.len() - 1]);
    assert_eq!(std::fs::read(&index).unwrap(), before);
    assert!(late.exists());
    let other = Scratch::new("resume-frames-elsewhere");
    let resumed = resume_in::<1>(&without, &path, Some(&other.folder()), &mut |_| {}).unwrap();
    let warnings = resumed.summary.warnings;
    assert!(
        warnings[0].starts_with("3 of the 3 frames written before the checkpoint"),
        "{warnings:?}"
    );
}
