//! A run that is killed, again and again, ends as if nothing had happened.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

use super::{assert_refused, materialpoint, text};

/// A column of sand, 6400 particles that cross cells as it collapses, in about a second.
const SAND: &[&str] = &[
    "granular-column",
    "body.0.particles_per_cell=[4, 4]",
    "time.end=0.05",
    "output={particles=\"vtu\", every=40, checkpoint_every=10}",
];

/// A column of saturated soil under a load, in half a second.
const SOIL: &[&str] = &[
    "consolidation-large",
    "time.end=0.02",
    "output={particles=\"csv\", every=400, checkpoint_every=50}",
];

/// The command for a scene, the first of the words, with what is to be set, the others.
fn command(scene: &[&str], folder: &Path, further: &[&str]) -> Command {
    let (name, set) = scene.split_first().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_materialpoint"));
    command.args(["run", name, "--json", "--quiet", "--threads", "1", "--out"]);
    command.arg(folder).args(further);
    for set in set {
        command.args(["--set", set]);
    }
    command
}

/// A folder that is not there yet.
fn fresh(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn run(scene: &[&str], folder: &Path, further: &[&str]) -> Output {
    let output = command(scene, folder, further).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    output
}

/// The summary without what the clock says, and without the temporary files that a killed run had left: it
/// may have been killed while it wrote one.
fn summary(output: &Output) -> serde_json::Value {
    let mut summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let entries = summary.as_object_mut().unwrap();
    for key in ["wall_seconds", "particle_steps_per_second"] {
        assert!(entries.remove(key).is_some());
    }
    for name in entries
        .remove("removed")
        .iter()
        .flat_map(|names| names.as_array().unwrap())
    {
        let name = name.as_str().unwrap();
        assert!(name.starts_with('.') && name.ends_with(".tmp"), "{name} removed");
    }
    summary
}

/// Every file by name; hidden ones are what a killed process was writing.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let named = entries.map(|entry| (entry.file_name().into_string().unwrap(), entry.path()));
    let shown = named.filter(|(name, _)| !name.starts_with('.'));
    shown
        .map(|(name, path)| (name, std::fs::read(path).unwrap()))
        .collect()
}

#[track_caller]
fn assert_same_files(found: &BTreeMap<String, Vec<u8>>, expected: &BTreeMap<String, Vec<u8>>) {
    let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(found), names(expected));
    for (name, content) in found {
        assert!(content == &expected[name], "{name} differs");
    }
}

/// Numbers from 0 to 1 by Knuth's generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Starts the run, from its last checkpoint if there is one.
fn start(scene: &[&str], folder: &Path) -> Child {
    let checkpoint = folder.join("checkpoint.mpm");
    let resume = ["--resume", checkpoint.to_str().unwrap()];
    let further = if checkpoint.exists() { &resume[..] } else { &[] };
    let mut command = command(scene, folder, further);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// When the last checkpoint was written, if there is one.
fn written(folder: &Path) -> Option<SystemTime> {
    let checkpoint = std::fs::metadata(folder.join("checkpoint.mpm")).ok()?;
    checkpoint.modified().ok()
}

/// Waits until so many more checkpoints have been seen, and then for a time: on a busy machine a clock alone
/// would kill the run before it has begun.
fn wait(child: &mut Child, folder: &Path, checkpoints: usize, then: Duration) {
    for _ in 0..checkpoints {
        let before = written(folder);
        while written(folder) == before {
            assert!(
                child.try_wait().unwrap().is_none(),
                "it ended before it was killed"
            );
            std::thread::sleep(Duration::from_millis(1));
        }
    }
    std::thread::sleep(then);
}

/// Kills the run so many times, each time after none to three checkpoints and a random part of the time to
/// the next one, and lets it end. It writes `checkpoints` in all.
fn survives(name: &str, scene: &[&str], kills: usize, checkpoints: usize) {
    let whole = fresh(&format!("{name}-whole"));
    let begun = Instant::now();
    let expected = run(scene, &whole, &[]);
    let between = begun.elapsed() / checkpoints as u32;
    let folder = fresh(name);
    let mut random = Random(2024);
    let mut resumed = 0;
    for _ in 0..kills {
        resumed += usize::from(written(&folder).is_some());
        let mut child = start(scene, &folder);
        let seen = (4.0 * random.next()) as usize;
        wait(&mut child, &folder, seen, between.mul_f64(random.next()));
        assert!(
            child.try_wait().unwrap().is_none(),
            "it ended before it was killed"
        );
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(
        resumed > kills / 2,
        "{resumed} of {kills} starts from a checkpoint"
    );
    let output = start(scene, &folder).wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(summary(&output), summary(&expected));
    assert_same_files(&files(&folder), &files(&whole));
}

#[test]
fn sand_that_is_killed_twenty_times_falls_as_it_would_have() {
    survives("killed-sand", SAND, 20, 60);
}

#[test]
fn soil_that_is_killed_settles_as_it_would_have() {
    survives("killed-soil", SOIL, 6, 100);
}

#[test]
fn a_run_without_checkpoints_comes_to_the_same() {
    let (with, without) = (fresh("with-checkpoints"), fresh("without-checkpoints"));
    let first = run(SOIL, &with, &[]);
    let second = run(&[SOIL, &["output.checkpoint_every=0"]].concat(), &without, &[]);
    assert_eq!(summary(&first), summary(&second));
    let mut files_with = files(&with);
    assert!(files_with.remove("checkpoint.mpm").is_some());
    assert_same_files(&files_with, &files(&without));
}

#[test]
fn a_checkpoint_that_does_not_serve_ends_with_status_two() {
    let folder = fresh("foreign-checkpoint");
    let few = ["consolidation-small", "output={checkpoint_every=5}"];
    run(&few, &folder, &[]);
    let checkpoint = folder.join("checkpoint.mpm");
    let name = checkpoint.to_str().unwrap();
    let refused = |arguments: &[&str], fragments: &[&str]| {
        let (output, _) = materialpoint("foreign-checkpoint-out", arguments);
        assert_refused(&output, 2, fragments);
    };
    let resume = ["run", "consolidation-small", "--resume"];
    refused(
        &[&resume[..], &["nowhere.mpm"]].concat(),
        &["nowhere.mpm", "cannot be read"],
    );
    refused(
        &[&resume[..], &[name, "--set", "grid.cells=[10]"]].concat(),
        &[name, "another scene", "grid.cells was 20 and is 10 now"],
    );
    let bytes = std::fs::read(&checkpoint).unwrap();
    std::fs::write(&checkpoint, &bytes[..bytes.len() / 2]).unwrap();
    refused(&[&resume[..], &[name]].concat(), &[name, "damaged or incomplete"]);
}

/// On a small file system, mounted in a name space of its own where that is allowed: the first checkpoint
/// fits, there is no room for the second beside it.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_keeps_the_last_checkpoint() {
    let (scene, whole) = (
        [
            "vibrating-bar-large",
            "output={particles=\"none\", checkpoint_every=300}",
        ],
        fresh("room"),
    );
    let expected = run(&scene, &whole, &[]);
    let size = std::fs::metadata(whole.join("checkpoint.mpm")).unwrap().len();
    let (small, kept) = (fresh("full-disk"), fresh("full-disk-kept"));
    std::fs::create_dir_all(&small).unwrap();
    std::fs::create_dir_all(&kept).unwrap();
    let script = "mount -t tmpfs -o size=\"$1\" tmpfs \"$2\" || exit 99\n\
        \"$4\" run \"$5\" --set \"$6\" --quiet --out \"$2\"; status=$?\ncp \"$2\"/* \"$3\"; exit $status";
    let room = (size * 3 / 2).to_string();
    let output = Command::new("unshare")
        .args(["--map-root-user", "--mount", "sh", "-c", script, "sh", &room])
        .args([&small, &kept])
        .arg(env!("CARGO_BIN_EXE_materialpoint"))
        .args(scene)
        .output();
    let Ok(output) = output else {
        return println!("no small file system can be mounted here");
    };
    if !matches!(output.status.code(), Some(0 | 3)) {
        return println!(
            "no small file system can be mounted here: {}",
            text(&output.stderr)
        );
    }
    assert_refused(
        &output,
        3,
        &[
            "the disk is full",
            "checkpoint.mpm",
            "older file of that name is still as it was",
        ],
    );
    let checkpoint = kept.join("checkpoint.mpm");
    let output = run(&scene, &whole, &["--resume", checkpoint.to_str().unwrap()]);
    assert_eq!(summary(&output), summary(&expected));
}
