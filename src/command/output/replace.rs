//! Files that are complete or as they were.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use super::OutputError;

/// What takes the bytes of a new file.
pub(super) trait Medium: Write {
    /// Waits until the bytes are on the disk; some file systems say only here that it is full.
    fn sync(&self) -> io::Result<()>;
}

impl Medium for File {
    fn sync(&self) -> io::Result<()> {
        self.sync_all()
    }
}

/// Fills a file of a temporary name in the same folder and renames it over `path` once its bytes are on the
/// disk.
///
/// After a failure nothing of the new file is left and an older one of that name is untouched. A loss of
/// power leaves the older file or the new one; a killed process may leave the hidden temporary file.
///
/// # Errors
/// [`OutputError::DiskFull`] if the space or the quota is exhausted, otherwise [`OutputError::Write`].
pub(super) fn replace<M: Medium>(
    path: PathBuf,
    open: impl FnOnce(&Path) -> io::Result<M>,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<PathBuf, OutputError> {
    let unfinished = beside(&path);
    let written = open(&unfinished)
        .and_then(|medium| fill_and_sync(medium, fill))
        .and_then(|()| fs::rename(&unfinished, &path));
    written.map(|()| path.clone()).map_err(|source| {
        // The first error is the one to report; a file that was never made cannot be removed.
        let _ = fs::remove_file(&unfinished);
        failure(path, source)
    })
}

fn fill_and_sync<M: Medium>(
    medium: M,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut file = BufWriter::new(medium);
    fill(&mut file)?;
    file.flush()?;
    file.get_ref().sync()
}

fn failure(path: PathBuf, source: io::Error) -> OutputError {
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => OutputError::DiskFull {
            older: path.exists(),
            path,
            source,
        },
        _ => OutputError::Write { path, source },
    }
}

/// A temporary name beside a file.
fn beside(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default();
    path.with_file_name(temporary(&name.to_string_lossy()))
}

/// A hidden name that no other writer, in this process or another, uses at the same time.
pub(super) fn temporary(name: &str) -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    format!(".{name}.{}-{count}.tmp", process::id())
}
