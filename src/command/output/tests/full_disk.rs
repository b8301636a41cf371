//! Goal: a disk that fills up leaves the older file, nothing of the new one, and a sentence to act on.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use super::scratch::Scratch;
use crate::output::replace::{Medium, replace};
use crate::output::{Folder, OutputError, Table};

/// A file on a disk that has room for so many bytes, and what it answers when they are used up.
struct Small {
    file: File,
    room: usize,
    sync: io::Result<()>,
}

impl Write for Small {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.room == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let taken = self.file.write(&bytes[..bytes.len().min(self.room)])?;
        self.room -= taken;
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Medium for Small {
    fn sync(&self) -> io::Result<()> {
        self.sync.as_ref().copied().map_err(|error| error.kind().into())
    }
}

/// Writes 100 000 bytes, in pieces as a table does, where there is room for `room`.
fn write(path: &Path, room: usize, sync: io::Result<()>) -> Result<(), OutputError> {
    let open = |path: &Path| File::create(path).map(|file| Small { file, room, sync });
    let fill = |file: &mut dyn Write| (0..1000).try_for_each(|_| file.write_all(&[b'x'; 100]));
    replace(path.into(), open, fill).map(drop)
}

/// The older file is as it was, alone, and the error says so.
fn check_older_kept(error: OutputError, path: &Path) {
    assert!(matches!(&error, OutputError::DiskFull { older: true, .. }));
    let sentence = error.to_string();
    let named = format!("the disk is full: the file `{}` cannot", path.display());
    assert!(
        sentence.starts_with(&named) && sentence.contains("older file of that name is still as it was"),
        "{sentence}"
    );
    assert_eq!(fs::read_to_string(path).unwrap(), "older");
    assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
}

#[test]
fn wherever_the_space_ends_the_older_file_stays() {
    let scratch = Scratch::new("small");
    let path = scratch.folder().write("p.csv", "older").unwrap();
    // At once, within the buffer, between buffers, before the last byte.
    for room in [0, 1, 5000, 8192, 65_536, 99_999] {
        check_older_kept(write(&path, room, Ok(())).unwrap_err(), &path);
    }
    write(&path, 100_000, Ok(())).unwrap();
    assert_eq!(fs::read(&path).unwrap(), [b'x'; 100_000]);
}

#[test]
fn space_that_ends_when_the_bytes_reach_the_disk_counts_too() {
    let scratch = Scratch::new("sync");
    let path = scratch.folder().write("p.csv", "older").unwrap();
    for kind in [io::ErrorKind::StorageFull, io::ErrorKind::QuotaExceeded] {
        let error = write(&path, usize::MAX, Err(kind.into())).unwrap_err();
        check_older_kept(error, &path);
    }
}

#[test]
fn without_an_older_file_nothing_is_there() {
    let scratch = Scratch::new("first");
    let folder = scratch.folder();
    let error = write(&folder.path().join("p.csv"), 10, Ok(())).unwrap_err();
    assert!(error.to_string().contains("nothing of it was kept"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// What happens on a file system of 64 kB that is mounted at this folder; run by the test below.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "needs a small file system"]
fn on_a_small_file_system() {
    let Ok(path) = std::env::var("MATERIALPOINT_SMALL_DISK") else {
        return;
    };
    let folder = Folder::create(Path::new(&path)).unwrap();
    let path = folder.write("p.csv", "older").unwrap();
    let table = Table {
        header: vec!["x[m]".into()],
        columns: vec![vec![1.0 / 3.0; 100_000]],
    };
    check_older_kept(table.write_csv(&folder, "p.csv").unwrap_err(), &path);
    folder.write("p.csv", "newer").unwrap();
    println!("kept on a small disk");
}

/// Mounts a small file system in a name space of its own, which ends with it; where that is not allowed the
/// tests above must do.
#[cfg(target_os = "linux")]
#[test]
fn a_real_disk_that_is_full_keeps_the_older_file() {
    let scratch = Scratch::new("tmpfs");
    let folder = scratch.folder();
    let run = |script: &str| {
        std::process::Command::new("unshare")
            .args(["--map-root-user", "--mount", "sh", "-c", script, "sh"])
            .arg(folder.path())
            .arg(std::env::current_exe().unwrap())
            .env("MATERIALPOINT_SMALL_DISK", folder.path())
            .output()
    };
    let mount = "mount -t tmpfs -o size=64k tmpfs \"$1\"";
    if !run(mount).is_ok_and(|done| done.status.success()) {
        return println!("no small file system can be mounted here");
    }
    let name = "output::tests::full_disk::on_a_small_file_system";
    let done = run(&format!(
        "{mount} && exec \"$2\" --exact {name} --ignored --nocapture"
    ));
    let done = done.unwrap();
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(
        done.status.success() && said.contains("kept on a small disk"),
        "{said}\n{}",
        String::from_utf8_lossy(&done.stderr)
    );
}
