//! The output folder, checked before anything is computed.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use super::OutputError;

/// An output folder that exists and was writable when it was made.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Creates the folder where it is missing and checks, with a file that is removed again, that it is writable.
    pub fn create(path: &Path) -> Result<Folder, OutputError> {
        fs::create_dir_all(path).map_err(|source| OutputError::Create {
            path: path.into(),
            source,
        })?;
        let probe = path.join(temporary("probe"));
        File::create(&probe)
            .and_then(|_| fs::remove_file(&probe))
            .map_err(|source| OutputError::NotWritable {
                path: path.into(),
                source,
            })?;
        Ok(Folder { path: path.into() })
    }

    /// Where the folder is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file of this name, replacing an older one, and returns where it is.
    pub fn write(&self, name: &str, content: &str) -> Result<PathBuf, OutputError> {
        self.write_with(name, |file| file.write_all(content.as_bytes()))
    }

    /// Fills a file of a temporary name and renames it, so that a failure leaves no half file and spares the
    /// older one.
    pub(super) fn write_with(
        &self,
        name: &str,
        fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<PathBuf, OutputError> {
        let path = self.path.join(name);
        let unfinished = self.path.join(temporary(name));
        let written = fill_file(&unfinished, fill).and_then(|()| fs::rename(&unfinished, &path));
        written.map(|()| path.clone()).map_err(|source| {
            // The first error is the one to report; a file that was never made cannot be removed.
            let _ = fs::remove_file(&unfinished);
            OutputError::Write { path, source }
        })
    }
}

fn fill_file(path: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    fill(&mut file)?;
    file.flush()
}

/// A hidden name that no other writer, in this process or another, uses at the same time.
fn temporary(name: &str) -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    format!(".{name}.{}-{count}.tmp", process::id())
}
