//! Short runs of every method, dimension, phase and scalar through the command, with checksums of what they
//! write: the gate for changes that must change nothing but round-off.
//!
//! `cargo test --release golden::every_run_is_as_recorded -- --ignored` compares, and where figures are meant
//! to change `cargo test --release golden::record -- --ignored` records anew; the commit says which runs
//! changed and why.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use materialpoint_command::scene::Scene;
use serde::{Deserialize, Serialize};

/// Difference in the checksums of a column, relative to its norm, that round-off may make.
const TOLERANCE: f64 = 1e-9;
/// The same in single precision.
const TOLERANCE_F32: f64 = 3e-4;

/// Norm of a stress (Pa) that is round-off: of bodies that fly without touching anything.
const NOTHING: f64 = 1e-9;

/// What a run left.
#[derive(Debug, Deserialize, PartialEq, Serialize)]
#[serde(untagged)]
enum Outcome {
    /// It was refused, or stopped.
    Stopped {
        /// Exit status.
        status: i32,
        /// Beginning of the message.
        message: String,
    },
    /// It came to its end.
    Ended {
        steps: u64,
        grid_crossings: u64,
        /// Of each column of the particles' table the sum, the norm and a sum that knows the order.
        columns: BTreeMap<String, [f64; 3]>,
    },
}

/// A scene of the crate with what is set in it, written `key=value`.
struct Run {
    scene: &'static str,
    set: Vec<String>,
}

impl Run {
    fn new(scene: &'static str, method: &[(&str, &str)], set: &[&str]) -> Self {
        let method = method.iter().map(|(key, value)| match value.parse::<f64>() {
            Ok(_) => format!("method.{key}={value}"),
            Err(_) => format!("method.{key}=\"{value}\""),
        });
        let set = method.chain(set.iter().map(ToString::to_string)).collect();
        Self { scene, set }
    }

    fn name(&self) -> String {
        format!("{} {}", self.scene, self.set.join(" "))
    }

    fn outcome(&self, folder: &Path) -> Outcome {
        let mut command = Command::new(env!("CARGO_BIN_EXE_materialpoint"));
        command.args(["run", self.scene, "--json", "--quiet", "--threads", "1", "--out"]);
        command.arg(folder);
        let output = [
            "output.particles=\"csv\"",
            "output.every=0",
            "output.checkpoint_every=0",
        ];
        for set in self.set.iter().map(String::as_str).chain(output) {
            command.args(["--set", set]);
        }
        let output = command.output().unwrap();
        let status = output.status.code().unwrap();
        if status != 0 {
            let message = String::from_utf8(output.stderr).unwrap();
            let message = message.trim().chars().take(160).collect();
            return Outcome::Stopped { status, message };
        }
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        Outcome::Ended {
            steps: summary["steps"].as_u64().unwrap(),
            grid_crossings: summary["grid_crossings"].as_u64().unwrap(),
            columns: checksums(&folder.join("particles.csv")),
        }
    }
}

/// The columns of a table of numbers with a line of names.
fn checksums(table: &Path) -> BTreeMap<String, [f64; 3]> {
    let text = std::fs::read_to_string(table).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut sums = vec![[0.0; 3]; names.len()];
    for (row, line) in lines.enumerate() {
        for (sum, value) in sums.iter_mut().zip(line.split(',')) {
            let value: f64 = value.parse().unwrap();
            sum[0] += value;
            sum[1] += value * value;
            sum[2] += value * (row as f64).cos();
        }
    }
    let sums = sums
        .into_iter()
        .map(|[sum, squares, ordered]| [sum, squares.sqrt(), ordered]);
    names.into_iter().map(str::to_owned).zip(sums).collect()
}

const BASES: [&str; 3] = ["linear", "dual-domain", "bspline"];
const RECONSTRUCTIONS: [&str; 4] = ["shepard", "taylor", "relaxed-taylor", "spline"];

fn runs() -> Vec<Run> {
    let mut runs = on_one_axis();
    runs.extend(other_degrees_and_sub_points());
    runs.extend(in_the_plane());
    runs
}

/// Both phases, every method, every scalar and every mass that the method has.
fn on_one_axis() -> Vec<Run> {
    let bar = "vibrating-bar-large";
    let scenes: [(_, &[&str]); 6] = [
        (bar, &["grid.cells=[13]", "time.step=1e-4", "time.end=1.2e-2"]),
        ("column-compaction", &["grid.cells=[21]", "time.end=2e-2"]),
        ("vibrating-bar-period", &["grid.cells=[9]", "time.end=5e-4"]),
        ("consolidation", &["grid.cells=[11]", "time.end=0.5005"]),
        ("standing-wave", &["grid.cells=[9]", "time.end=2e-4"]),
        ("undrained-load", &["grid.cells=[9]", "time.end=1e-4"]),
    ];
    let mut runs = Vec::new();
    for (scene, set) in scenes {
        for basis in BASES {
            for reconstruction in RECONSTRUCTIONS {
                let method = [("basis", basis), ("reconstruction", reconstruction)];
                runs.push(Run::new(scene, &method, set));
                if scene != bar {
                    continue;
                }
                runs.push(Run::new(
                    scene,
                    &[&method[..], &[("scalar", "f32")]].concat(),
                    set,
                ));
                for mass in ["constrained", "lumped"] {
                    if reconstruction == "taylor" {
                        let method = [&method[..], &[("velocity_mass", mass)]].concat();
                        runs.push(Run::new(scene, &method, set));
                    }
                }
            }
        }
    }
    runs
}

fn other_degrees_and_sub_points() -> Vec<Run> {
    let set = ["grid.cells=[13]", "time.end=1.2e-2"];
    let mut runs = Vec::new();
    for degree in ["1", "3"] {
        for reconstruction in RECONSTRUCTIONS {
            let method = [
                ("basis", "bspline"),
                ("degree", degree),
                ("reconstruction", reconstruction),
            ];
            runs.push(Run::new("vibrating-bar-large", &method, &set));
        }
    }
    let method = [
        ("basis", "dual-domain"),
        ("reconstruction", "shepard"),
        ("subpoints", "4"),
    ];
    runs.push(Run::new("vibrating-bar-large", &method, &set));
    runs
}

/// The beginnings of the scenes in the plane.
fn in_the_plane() -> Vec<Run> {
    let scenes = [
        ("manufactured", 0.0),
        ("spinning-disc", 200.0),
        ("cooks-membrane", 200.0),
        ("granular-column", 200.0),
        ("dam-break", 200.0),
        ("slope", 2000.0),
        ("footing", 2000.0),
        ("colliding-discs", 200.0),
        ("vortex", 200.0),
        ("cantilever", 200.0),
    ];
    let mut runs = Vec::new();
    for (scene, part) in scenes {
        let set = match part {
            0.0 => vec!["grid.cells=[7, 7]".to_owned(), "time.end=1.5e-3".to_owned()],
            part => {
                let whole = Scene::from_toml(Scene::builtin(scene).unwrap(), &[]).unwrap();
                vec![format!("time.end={:e}", whole.time.end / part)]
            }
        };
        let set: Vec<&str> = set.iter().map(String::as_str).collect();
        for basis in BASES {
            for reconstruction in &RECONSTRUCTIONS[..3] {
                let method = [("basis", basis), ("reconstruction", *reconstruction)];
                runs.push(Run::new(scene, &method, &set));
            }
        }
    }
    runs
}

/// What differs between two outcomes of a run by more than `tolerance`, if anything does.
fn difference(found: &Outcome, recorded: &Outcome, tolerance: f64) -> Option<String> {
    match (found, recorded) {
        (Outcome::Stopped { status: a, .. }, Outcome::Stopped { status: b, .. }) if a == b => None,
        (Outcome::Ended { columns: found, .. }, Outcome::Ended { columns, .. }) => {
            if !found.keys().eq(columns.keys()) {
                return Some(format!("columns {:?} were {:?}", found.keys(), columns.keys()));
            }
            let differs = |(name, sums): (&String, &[f64; 3])| {
                let other = &found[name];
                if name.ends_with("[Pa]") && sums[1].max(other[1]) < NOTHING {
                    return None;
                }
                let scale = sums[1].abs().max(f64::MIN_POSITIVE);
                let differences = sums.iter().zip(other).map(|(a, b)| (a - b).abs());
                let most = differences.fold(0.0, f64::max);
                // The sums grow with the number of particles where the norm grows with its root.
                (most > 10.0 * tolerance * scale).then(|| format!("{name} by {:.1e}", most / scale))
            };
            columns.iter().find_map(differs)
        }
        _ => Some(format!("{found:?} was {recorded:?}")),
    }
}

fn file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/runs.json")
}

fn outcomes() -> BTreeMap<String, Outcome> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden");
    let named = |run: Run| (run.name(), run.outcome(&folder));
    runs().into_iter().map(named).collect()
}

#[test]
#[ignore = "189 runs: a minute in release; for changes that must change nothing but round-off"]
fn every_run_is_as_recorded() {
    let recorded: BTreeMap<String, Outcome> =
        serde_json::from_slice(&std::fs::read(file()).unwrap()).unwrap();
    let found = outcomes();
    assert!(found.keys().eq(recorded.keys()), "other runs than were recorded");
    let differ = |(name, outcome): (&String, &Outcome)| {
        let tolerance = if name.contains("f32") {
            TOLERANCE_F32
        } else {
            TOLERANCE
        };
        difference(outcome, &recorded[name], tolerance).map(|what| format!("{name}: {what}"))
    };
    let different: Vec<String> = found.iter().filter_map(differ).collect();
    assert!(
        different.is_empty(),
        "{} of {} differ:\n{}",
        different.len(),
        found.len(),
        different.join("\n")
    );
}

#[test]
#[ignore = "records the runs anew"]
fn record() {
    let text = serde_json::to_string_pretty(&outcomes()).unwrap();
    std::fs::write(file(), text + "\n").unwrap();
}
