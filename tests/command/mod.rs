//! The command as a user meets it: exit status, what stands on standard output and on standard error, files.

mod resume;
mod warned;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Runs the command with its files in a folder of the test's own.
fn materialpoint(test: &str, arguments: &[&str]) -> (Output, PathBuf) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    let output = Command::new(env!("CARGO_BIN_EXE_materialpoint"))
        .args(arguments)
        .args(["--out".as_ref(), folder.as_os_str()])
        .output()
        .unwrap();
    (output, folder)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// The heads of the columns, a blank between two words.
fn header(table: &str) -> String {
    let line = table.lines().nth(2).unwrap_or_default();
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Status, and a single clear sentence on standard error that holds all `fragments`.
#[track_caller]
fn assert_refused(output: &Output, status: i32, fragments: &[&str]) {
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{message}");
    assert!(message.lines().count() <= 2, "{message}");
    assert!(!message.contains("panicked"), "{message}");
    for fragment in fragments {
        assert!(message.contains(fragment), "{message:?} lacks {fragment:?}");
    }
    assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
}

#[test]
fn run_prints_one_json_object_and_nothing_else() {
    let (output, folder) = materialpoint("run-json", &["run", "vibrating-bar-large", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in [
        "title",
        "method",
        "particles",
        "cells",
        "dofs",
        "steps",
        "time",
        "time_step",
        "wall_seconds",
        "particle_steps_per_second",
        "bytes_per_particle",
        "grid_crossings",
        "reduced_cells",
        "virtual_cells",
        "errors",
        "conservation",
        "energy",
    ] {
        assert!(!summary[key].is_null(), "{key}");
    }
    for key in [
        "basis",
        "degree",
        "reconstruction",
        "subpoints",
        "velocity_mass",
        "phases",
        "law",
        "strain",
        "scalar",
        "dimension",
    ] {
        assert!(!summary["method"][key].is_null(), "method.{key}");
    }
    for field in ["displacement", "velocity", "stress"] {
        for norm in ["rms", "relative_l2", "max"] {
            assert!(summary["errors"][field][norm].is_f64(), "{field} {norm}");
        }
    }
    for key in ["initial", "final", "highest_ratio", "lowest_ratio"] {
        assert!(summary["energy"][key].is_f64(), "{key}");
    }
    assert!(summary["conservation"]["solid"]["momentum_scaled"].is_f64());
    assert!(folder.join("fields.svg").exists());
}

#[test]
fn particles_are_written_with_their_units_and_all_digits() {
    let (output, folder) = materialpoint(
        "run-csv",
        &[
            "run",
            "vibrating-bar-small",
            "--set",
            "output.every=10",
            "--quiet",
        ],
    );
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty());
    let csv = std::fs::read_to_string(folder.join("particles.csv")).unwrap();
    let mut lines = csv.lines();
    let header = "x0[m],x[m],u[m],v[m/s],stress[Pa],density[kg/m3],volume[m]";
    let found = lines.next().unwrap();
    assert_eq!(found, format!("{header},mass[kg/m2],body[-],particle[-]"));
    assert_eq!(lines.count(), 40 * 12);
    assert!(folder.join("particles-00000010.csv").exists());
}

#[test]
fn the_default_command_compares_all_methods_and_draws_them() {
    let (output, folder) = materialpoint("default", &["--json", "--cells", "10,20"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let study: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = study["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 12);
    for row in rows {
        for key in [
            "basis",
            "reconstruction",
            "subpoints",
            "velocity_mass",
            "cells",
            "errors",
            "orders",
            "wall_seconds",
            "particle_steps_per_second",
            "conservation",
            "on_front",
        ] {
            assert!(!row[key].is_null(), "{key}");
        }
        // Runs of milliseconds are timed again, more often than the flag asks.
        let (timings, seconds) = (
            row["timings"].as_u64().unwrap(),
            row["wall_seconds"].as_f64().unwrap(),
        );
        assert!(
            timings >= 200 || timings as f64 * seconds >= 0.0999,
            "{timings} of {seconds} s"
        );
    }
    let advice = study["recommendation"].as_str().unwrap();
    assert!(
        advice.starts_with("For a stress error below 1 % the cheapest here is"),
        "{advice}"
    );
    assert!(rows.iter().any(|row| row["on_front"] == true));
    for file in ["study.csv", "study.svg", "fields.svg"] {
        assert!(folder.join(file).exists(), "{file}");
    }
    let (table, _) = materialpoint(
        "default-table",
        &["--cells", "20", "--methods", "bspline+taylor,linear+shepard"],
    );
    let table = text(&table.stdout);
    assert!(table.contains("BSMPM + TLS"), "{table}");
    assert!(
        header(&table).contains("stress ord u ord v ord time [s]"),
        "{table}"
    );
    let last = table.lines().rfind(|line| !line.starts_with("wrote")).unwrap();
    assert!(last.contains("the cheapest here is"), "{table}");
}

#[test]
fn check_names_the_largest_stable_step_and_what_limits_it() {
    let (output, _) = materialpoint("check", &["check", "vibrating-bar-large", "--json", "--sharp"]);
    let check: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(check["critical_by"], "iteration");
    assert_eq!(check["steps"], 1000.0);
    // In units of h/c; `convergence::critical_step` confirms such figures by bisection.
    let critical = check["critical_time_step"].as_f64().unwrap() / (0.05 / 20.0_f64.sqrt());
    assert!((critical - 1.39).abs() < 0.01, "{critical}");
    assert!(check["mechanism"].as_str().unwrap().contains("wave"));
    assert_eq!(check["stable"], true);
    // Published TLS has no bound: a sample of the particles is iterated on, here all of them. The particles'
    // speed, 0.8 m/s, counts: 1 / dt = c / (1.39 h) + v / h.
    let (output, _) = materialpoint("check-sample", &["check", "vibrating-bar-large", "--json"]);
    let check: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(check["critical_by"], "sample");
    let with_speed = check["critical_time_step"].as_f64().unwrap() / 0.05;
    let c = 20.0_f64.sqrt();
    assert!(
        (1.0 / with_speed - c / critical - 0.8).abs() < 0.01,
        "{with_speed}"
    );
}

/// Linear functions along one axis: h / (c + |v|) = 0.05 / (4.472 + 0.8), by the bound. The default takes a
/// tenth of it.
#[test]
fn check_counts_the_steps_and_refuses_an_unstable_one() {
    let plain = [
        "check",
        "vibrating-bar-large",
        "--set",
        "method={basis='linear', reconstruction='shepard'}",
    ];
    let (output, _) = materialpoint(
        "check-auto",
        &[&plain[..], &["--set", "time.step=auto", "--json"]].concat(),
    );
    let check: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(check["critical_by"], "bound");
    let step = 0.05 / (20.0_f64.sqrt() + 0.8);
    let found = check["critical_time_step"].as_f64().unwrap();
    assert!((found / step - 1.0).abs() < 0.01, "{found} {step}");
    assert_eq!(check["steps"], (0.1 / (0.1 * found)).ceil());
    let (output, _) = materialpoint("check-text", &[&plain[..], &["--set", "time.step=auto"]].concat());
    let page = text(&output.stdout);
    assert!(page.contains("by a bound") && page.contains("  steps "), "{page}");
    // Three times the wave's step: no layout bears that.
    let fixed = ["--set", "time.step=0.034", "--set", "time.end=1.0", "--json"];
    let (output, _) = materialpoint("check-unstable", &[&plain[..], &fixed].concat());
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("time.step = 3.400e-2 s is above the largest stable step"),
        "{message}"
    );
    let check: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&check["stable"], &check["critical_by"]),
        (&false.into(), &"iteration".into())
    );
    // 1e15 s are 1e17 steps and more.
    for command in ["check", "run"] {
        let set = ["--set", "time={step='auto', end=1e15}", "--quiet"];
        let (output, _) = materialpoint("check-endless", &[&[command], &plain[1..], &set].concat());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command}: {message}");
        assert!(message.contains("expected at most 1e12"), "{command}: {message}");
    }
}

/// A step in which a wave crosses nearly a cell, where particles cross edges: energy out of nothing. The
/// files are there, and the command says that they are no result.
#[test]
fn a_run_that_made_energy_writes_its_files_and_ends_with_status_three() {
    let arguments = [
        "run",
        "vibrating-bar-large",
        "--set",
        "method={basis='linear', reconstruction='shepard'}",
        "--set",
        "time={step=0.0105, end=2.0}",
        "--json",
    ];
    let (output, folder) = materialpoint("gain", &arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(
        message.contains("the energy rose to") && message.contains("smaller time.step"),
        "{message}"
    );
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(
        summary["energy"]["highest_ratio"].as_f64().unwrap() > 1.1,
        "{summary}"
    );
    let warnings = summary["warnings"].as_array().unwrap();
    assert!(
        warnings
            .iter()
            .any(|warning| warning.as_str().unwrap().contains("the energy rose"))
    );
    assert!(folder.join("particles.csv").exists());
    // Said once.
    assert_eq!(message.matches("the energy rose").count(), 1, "{message}");
}

#[test]
fn flags_of_a_study_are_refused_elsewhere_by_name() {
    for (flag, value) in [
        ("--cells", "5,10"),
        ("--methods", "linear+shepard"),
        ("--repeat", "2"),
    ] {
        for command in ["run", "check"] {
            let after = materialpoint("flags", &[command, "vibrating-bar-small", flag, value]).0;
            let before = materialpoint("flags", &[flag, value, command, "vibrating-bar-small"]).0;
            for output in [after, before] {
                let message = text(&output.stderr);
                assert_eq!(output.status.code(), Some(2), "{message}");
                assert!(message.contains(flag), "{message}");
            }
        }
    }
}

#[test]
fn the_list_is_json_where_that_is_asked_for() {
    let output = Command::new(env!("CARGO_BIN_EXE_materialpoint"))
        .args(["list", "--json"])
        .output()
        .unwrap();
    let list: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for (key, name) in [
        ("bases", "linear"),
        ("reconstructions", "relaxed-taylor"),
        ("laws", "neo-hookean"),
        ("phases", "2"),
        ("references", "vibrating-bar"),
    ] {
        let entries = list[key].as_array().unwrap();
        assert!(
            entries
                .iter()
                .any(|entry| entry["name"] == name && entry["about"].is_string()),
            "{key}"
        );
    }
    assert!(list["scenes"].as_array().unwrap().contains(&"dam-break".into()));
    assert!(
        list["methods"]
            .as_array()
            .unwrap()
            .contains(&"bspline+relaxed-taylor".into())
    );
}

#[test]
fn a_period_of_output_beyond_the_run_is_warned_of() {
    let arguments = ["run", "vibrating-bar-small", "--json", "--set", "output.every=20"];
    let (output, _) = materialpoint("period", &arguments);
    let message = text(&output.stderr);
    assert!(
        message.contains("output.every = 20 is more than the 19 steps"),
        "{message}"
    );
}

#[test]
fn a_run_of_two_phases_reports_both() {
    let (output, folder) = materialpoint("two-phases", &["run", "consolidation-small", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["method"]["phases"], 2);
    assert!(summary["warnings"].is_null());
    for field in [
        "solid_displacement",
        "solid_velocity",
        "liquid_velocity",
        "effective_stress",
        "pore_pressure",
    ] {
        for norm in ["rms", "relative_l2", "max"] {
            assert!(summary["errors"][field][norm].is_f64(), "{field} {norm}");
        }
    }
    for phase in ["solid", "liquid"] {
        let mass = summary["conservation"][phase]["mass"].as_f64().unwrap();
        assert!(mass < 1e-13, "{phase}: {mass:e}");
    }
    let csv = std::fs::read_to_string(folder.join("particles.csv")).unwrap();
    let header =
        "x0[m],x[m],u_solid[m],v_solid[m/s],v_liquid[m/s],effective_stress[Pa],pore_pressure[Pa],porosity[-]";
    let rest = "density[kg/m3],volume[m],mass[kg/m2],body[-],particle[-]";
    assert_eq!(csv.lines().next().unwrap(), format!("{header},{rest}"));
    assert_eq!(csv.lines().count(), 1 + 20 * 4);
    let picture = std::fs::read_to_string(folder.join("fields.svg")).unwrap();
    for name in [
        "solid displacement",
        "liquid velocity",
        "effective stress",
        "pore pressure",
    ] {
        assert!(picture.contains(name), "{name}");
    }
}

/// Ten steps just above the drag's limit still end, with a warning.
#[test]
fn a_step_above_the_critical_one_is_warned_of() {
    let set = [
        "--set",
        "material.drag=explicit",
        "--set",
        "time.step=4e-5",
        "--set",
        "time.end=4e-4",
    ];
    let arguments = [&["run", "consolidation", "--json"], &set[..]].concat();
    let (output, _) = materialpoint("warned", &arguments);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    for fragment in [
        "warning",
        "largest stable step",
        "the drag between solid and liquid",
        "implicit",
    ] {
        assert!(message.contains(fragment), "{message:?} lacks {fragment:?}");
    }
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["warnings"].as_array().map(Vec::len), Some(1));
    let (output, _) = materialpoint(
        "warned-check",
        &[&["check", "consolidation", "--json"], &set[..]].concat(),
    );
    let check: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(check["mechanism"], "the drag between solid and liquid (explicit)");
    assert_eq!(check["unknowns_per_dof"], 2);
    assert_eq!(check["stable"], false);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    let (output, _) = materialpoint("implicit-check", &["check", "consolidation", "--json"]);
    let check: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let mechanism = check["mechanism"].as_str().unwrap();
    assert!(mechanism.starts_with("a compression wave of solid and liquid crossing a cell"));
}

#[test]
fn a_study_of_two_phases_compares_all_twelve_methods() {
    let study = ["study", "consolidation-small"];
    let (output, folder) = materialpoint(
        "two-phase-study",
        &[&study[..], &["--json", "--cells", "10"]].concat(),
    );
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let rows: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(rows["rows"].as_array().map(Vec::len), Some(12));
    let csv = std::fs::read_to_string(folder.join("study.csv")).unwrap();
    for column in [
        "effective_stress_order",
        "pore_pressure_rms",
        ",mass_error,",
        "liquid_momentum_error_scaled",
    ] {
        assert!(csv.contains(column), "{column}");
    }
    let (output, _) = materialpoint("two-phase-table", &[&study[..], &["--cells", "10"]].concat());
    let table = text(&output.stdout);
    assert!(
        header(&table).contains("stress ord p ord u ord v ord v_w ord time [s]")
            && table.contains("For an effective stress error"),
        "{table}"
    );
    let relaxed = ["study", "footing", "--methods", "linear+relaxed-taylor"];
    let (output, _) = materialpoint("two-phase-relaxed", &relaxed);
    assert_refused(
        &output,
        2,
        &[
            "--methods",
            "linear+relaxed-taylor",
            "one phase only beyond one axis",
            "shepard or taylor",
        ],
    );
}

#[test]
fn sub_points_are_asked_for_in_a_study_and_named_in_every_report() {
    let methods = ["--methods", "dual-domain+shepard,dual-domain+shepard4"];
    let study = ["study", "vibrating-bar-large", "--cells", "10"];
    let (output, folder) = materialpoint("sub-points", &[&study[..], &methods, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let rows: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for (row, expected) in rows["rows"].as_array().unwrap().iter().zip([1, 4]) {
        assert_eq!(row["reconstruction"], "shepard");
        assert_eq!(row["subpoints"], expected);
    }
    let csv = std::fs::read_to_string(folder.join("study.csv")).unwrap();
    assert!(csv.contains("\ndual-domain,1,shepard,4,10,80,"), "{csv}");
    let (output, _) = materialpoint("sub-points-table", &[&study[..], &methods].concat());
    let table = text(&output.stdout);
    assert!(table.contains("DDMPM + 4 sub-points"), "{table}");
    let set = [
        "method.basis=dual-domain",
        "method.reconstruction=shepard",
        "method.subpoints=4",
    ];
    let set = set.map(|key| ["--set", key]).concat();
    for command in ["run", "check"] {
        let arguments = [&[command, "vibrating-bar-large"][..], &set].concat();
        let (output, _) = materialpoint(&format!("sub-points-{command}"), &arguments);
        let report = text(&output.stdout);
        assert!(report.contains("at 4 sub-points of each particle"), "{report}");
        let (output, _) = materialpoint(
            &format!("sub-points-{command}-json"),
            &[&arguments[..], &["--json"]].concat(),
        );
        let object: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(object["method"]["subpoints"], 4);
        assert_eq!(object["method"]["reconstruction"], "shepard");
    }
    for name in [
        "dual-domain+shepard129",
        "dual-domain+shepard0",
        "linear+shepard4",
    ] {
        let arguments = [&study[..], &["--methods", name]].concat();
        let (output, _) = materialpoint("sub-points-refused", &arguments);
        assert_refused(&output, 2, &[name, "2 to 128"]);
    }
}

#[test]
fn list_names_everything_a_scene_can_ask_for() {
    let (output, _) = materialpoint("list", &["list"]);
    let list = text(&output.stdout);
    for name in [
        "linear",
        "dual-domain",
        "bspline",
        "shepard",
        "subpoints = 2 to 128",
        "taylor",
        "spline",
        "linear-elastic",
        "neo-hookean",
        "vibrating-bar",
        "column-compaction",
        "vibrating-bar-small",
        "logarithmic",
        "a saturated solid",
        "consolidation",
        "xie-leo",
        "standing-wave",
        "self-weight",
        "consolidation-large",
        "saturated-column",
        "undrained-load",
    ] {
        assert!(list.contains(name), "{name}");
    }
}

#[test]
fn bad_flags_and_scenes_end_with_status_two() {
    let refused = |test, arguments: &[&str], fragments: &[&str]| {
        assert_refused(&materialpoint(test, arguments).0, 2, fragments);
    };
    refused("no-file", &["run", "nowhere.toml"], &["nowhere.toml"]);
    refused(
        "bad-set",
        &["run", "vibrating-bar-large", "--set", "grid.cells=[0]"],
        &["grid.cells"],
    );
    refused(
        "bad-cells",
        &["study", "vibrating-bar-large", "--cells", "0"],
        &["--cells"],
    );
    refused("bad-repeat", &["--repeat", "0"], &["--repeat"]);
    refused(
        "bad-method",
        &["--methods", "linear+magic"],
        &["linear+magic", "taylor"],
    );
    let (output, _) = materialpoint("bad-flag", &["run", "vibrating-bar-large", "--frobnicate"]);
    assert_eq!(output.status.code(), Some(2));
    let set = ["--set", "reference={}"];
    let (output, _) = materialpoint(
        "no-reference",
        &[&["study", "vibrating-bar-large"], &set[..]].concat(),
    );
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn an_unwritable_folder_ends_with_status_three_before_anything_is_computed() {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("a-file");
    std::fs::write(&file, "no folder").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_materialpoint"))
        .args(["run", "vibrating-bar-large", "--out"])
        .arg(file.join("below"))
        .output()
        .unwrap();
    assert_refused(&output, 3, &["a-file"]);
}

/// A time step ten times the critical one: the message names the step, the particle and the largest stable
/// step, and what was written before stays readable.
#[test]
fn an_unstable_run_stops_with_the_step_the_particle_and_the_stable_step() {
    for method in ["shepard", "taylor", "relaxed-taylor", "spline"] {
        let name = format!("unstable-{method}");
        let reconstruction = format!("method.reconstruction=\"{method}\"");
        let arguments = [
            "run",
            "vibrating-bar-large",
            "--set",
            &reconstruction,
            "--set",
            "time.step=0.1",
            "--set",
            "time.end=100.0",
            "--set",
            "output.every=1",
        ];
        let (output, folder) = materialpoint(&name, &arguments);
        assert_refused(&output, 3, &["step ", "particle ", "largest stable step"]);
        let first = folder.join("particles-00000001.csv");
        if let Ok(csv) = std::fs::read_to_string(first) {
            assert_eq!(csv.lines().count(), 1 + 160);
            assert!(
                csv.lines()
                    .skip(1)
                    .all(|line| line.split(',').all(|field| field.parse::<f64>().is_ok()))
            );
        }
    }
}
