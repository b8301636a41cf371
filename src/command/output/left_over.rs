//! Files that a former run left in an output folder.

use std::fs;
use std::path::Path;
use std::process;
use std::time::Duration;

use super::Folder;

/// What the names of our files begin with, and end in: a number may stand between, after a dash.
const FILES: [(&str, &str); 8] = [
    ("particles", ".csv"),
    ("particles", ".vtu"),
    ("particles", ".pvd"),
    ("fields", ".svg"),
    ("study", ".csv"),
    ("study", ".svg"),
    ("checkpoint", ".mpm"),
    ("probe", ""),
];
/// Where processes cannot be looked up, a temporary file that nothing was written to for so long is nobody's
/// any more.
const LONG: Duration = Duration::from_secs(3600);

impl Folder {
    /// Removes temporary files of processes that were killed and, if `frames` says so of a name, older
    /// frames; returns the names of what was removed, in order. Files that we do not name so are never
    /// touched, and what cannot be removed stays.
    pub(crate) fn remove_left_over(&self, frames: impl Fn(&str) -> bool) -> Vec<String> {
        let Ok(entries) = fs::read_dir(self.path()) else {
            return Vec::new();
        };
        let mut removed = Vec::new();
        for entry in entries.flatten() {
            let Ok(name) = entry.file_name().into_string() else {
                continue;
            };
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            let is_old = frames(&name) || is_abandoned(&entry.path(), &name);
            if is_file && is_old && fs::remove_file(entry.path()).is_ok() {
                removed.push(name);
            }
        }
        removed.sort_unstable();
        removed
    }
}

/// Whether a name is that of a frame on the way, `particles-00000010.csv` or `particles-000001.vtu`, or of
/// their index.
pub(crate) fn is_frame(name: &str) -> bool {
    let numbered = |end: &str, digits: usize| {
        let number = name
            .strip_prefix("particles-")
            .and_then(|rest| rest.strip_suffix(end));
        number.is_some_and(|number| number.len() >= digits && is_number(number))
    };
    name == "particles.pvd" || numbered(".csv", 8) || numbered(".vtu", 6)
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Whether a file is a temporary one, `.NAME.PROCESS-COUNT.tmp` of one of our names, whose process is gone.
fn is_abandoned(path: &Path, name: &str) -> bool {
    let parts = name.strip_prefix('.').and_then(|rest| rest.strip_suffix(".tmp"));
    let Some((file, writer)) = parts.and_then(|parts| parts.rsplit_once('.')) else {
        return false;
    };
    let Some((process, count)) = writer.split_once('-') else {
        return false;
    };
    is_number(process) && is_number(count) && is_ours(file) && is_gone(path, process)
}

fn is_ours(file: &str) -> bool {
    FILES.iter().any(|(begin, end)| {
        let middle = file.strip_prefix(begin).and_then(|rest| rest.strip_suffix(end));
        middle.is_some_and(|middle| middle.is_empty() || middle.strip_prefix('-').is_some_and(is_number))
    })
}

fn is_gone(path: &Path, process: &str) -> bool {
    if process == process::id().to_string() {
        return false;
    }
    let processes = Path::new("/proc");
    if processes.join("self").exists() {
        return !processes.join(process).exists();
    }
    let age = fs::metadata(path).and_then(|file| file.modified()).ok();
    age.and_then(|at| at.elapsed().ok()).is_some_and(|age| age > LONG)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_frames_are_frames() {
        for name in [
            "particles-00000010.csv",
            "particles-000001.vtu",
            "particles.pvd",
            "particles-123456789.csv",
        ] {
            assert!(is_frame(name), "{name}");
        }
        for name in [
            "particles.csv",
            "particles-1.csv",
            "particles-0000001x.csv",
            "particles-000001.vtu.bak",
            "my-particles-000001.vtu",
            "particles-.vtu",
        ] {
            assert!(!is_frame(name), "{name}");
        }
    }

    #[test]
    fn temporary_files_of_the_dead_go_and_all_others_stay() {
        let scratch = crate::output::tests::scratch::Scratch::new("left-over");
        let folder = scratch.folder();
        // No process has so high a number.
        let dead = [
            ".particles.csv.4294967295-0.tmp",
            ".particles-000003.vtu.4294967295-12.tmp",
            ".probe.4294967295-1.tmp",
        ];
        let own = format!(".fields.svg.{}-3.tmp", process::id());
        let others = [
            own.as_str(),
            ".notes.txt.4294967295-0.tmp",
            "particles.csv.4294967295-0.tmp",
            ".particles.csv.4294967295.tmp",
            ".particles-x.vtu.4294967295-0.tmp",
            "notes.txt",
            "particles-000002.vtu",
        ];
        for name in dead.iter().chain(&others) {
            fs::write(folder.path().join(name), "x").unwrap();
        }
        let mut expected = dead.map(String::from);
        expected.sort_unstable();
        assert_eq!(folder.remove_left_over(|_| false), expected);
        for name in others {
            assert!(folder.path().join(name).exists(), "{name}");
        }
        assert_eq!(folder.remove_left_over(is_frame), ["particles-000002.vtu"]);
    }
}
