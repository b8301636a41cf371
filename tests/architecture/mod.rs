//! Who may call whom, as the page on the architecture says it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Rust files in a folder and below it.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found
}

/// A file without comments and tests.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// Modules that a file names as `crate::module`, below a `use crate::{..}` too.
fn modules_named_in(code: &str) -> Vec<&str> {
    let name = |rest: &str| {
        rest.find(|c: char| !c.is_alphanumeric() && c != '_')
            .unwrap_or(rest.len())
    };
    code.split("crate::")
        .skip(1)
        .map(|rest| &rest[..name(rest)])
        .collect()
}

/// Calls of one module by another, of the files in `folder` but for those in `without`.
fn calls(folder: &str, without: &[&str]) -> Vec<(String, String, PathBuf)> {
    let folder = root().join(folder);
    let mut found = Vec::new();
    for path in files(&folder) {
        let inside = path.strip_prefix(&folder).unwrap();
        let first = inside.iter().next().unwrap().to_str().unwrap();
        let module = first.trim_end_matches(".rs");
        let is_test = inside.iter().any(|part| part == "tests" || part == "tests.rs");
        if is_test || without.contains(&module) {
            continue;
        }
        let code = code(&path);
        for named in modules_named_in(&code) {
            if named != module {
                found.push((module.into(), named.into(), path.clone()));
            }
        }
    }
    found
}

/// The table's order: each folder may call those of earlier rows.
#[test]
fn no_folder_calls_one_below_it() {
    let page = std::fs::read_to_string(root().join("docs/guide/architecture.md")).unwrap();
    let table = page.split("## Who may call whom").nth(1).unwrap();
    let mut rank = BTreeMap::new();
    for (row, line) in table.lines().filter(|line| line.starts_with("| `")).enumerate() {
        let names = line.split('|').nth(1).unwrap();
        for name in names.split('`').skip(1).step_by(2) {
            rank.insert(name.to_string(), row);
        }
    }
    assert!(rank.len() > 20, "{rank:?}");
    let mut seen = 0;
    for (from, to, path) in calls("src", &["command", "steppers", "lib"]) {
        let Some(below) = rank.get(&to) else { continue };
        let above = rank.get(&from);
        let above = above.unwrap_or_else(|| panic!("`{from}` is not in the table"));
        assert!(below < above, "{from} calls {to}: {}", path.display());
        seen += 1;
    }
    assert!(seen > 300, "{seen}");
}

/// Nobody but the stepper and the check of a transfer calls the sweeps; scenes and files know nothing of each
/// other.
#[test]
fn the_command_has_no_circle() {
    for (from, to, path) in calls("src", &["command", "steppers", "lib"]) {
        let of_steps = ["stepper", "testing"].contains(&from.as_str());
        assert!(
            to != "transfer" || of_steps,
            "{from} calls transfer: {}",
            path.display()
        );
    }
    let order = ["scene", "output", "run", "study", "cli"];
    let rank = |name: &str| order.iter().position(|&other| other == name);
    for (from, to, path) in calls("src/command", &["lib", "main"]) {
        let (Some(above), Some(below)) = (rank(&from), rank(&to)) else {
            continue;
        };
        let apart = from == "output" && to == "scene";
        assert!(below < above && !apart, "{from} calls {to}: {}", path.display());
    }
}
