//! The output folder, checked before anything is computed.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::OutputError;
use super::replace::{replace, temporary};

/// An output folder that exists and was writable when it was made.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Creates the folder where it is missing and checks, with a file that is removed again, that it is
    /// writable.
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
    ///
    /// # Errors
    /// Those of [`write_with`](Folder::write_with).
    pub fn write(&self, name: &str, content: &str) -> Result<PathBuf, OutputError> {
        self.write_with(name, |file| file.write_all(content.as_bytes()))
    }

    /// Lets `fill` stream a file of this name, which replaces an older one when it is complete and on the
    /// disk; returns where it is. `fill` writes to a buffer of its own, nothing needs to be held in memory.
    ///
    /// # Errors
    /// [`OutputError::DiskFull`] if the space or the quota is exhausted, otherwise [`OutputError::Write`]
    /// with what `fill` or the system reported. The older file is then as it was, and nothing of the new one
    /// is left.
    pub fn write_with(
        &self,
        name: &str,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<PathBuf, OutputError> {
        replace(self.path.join(name), |path| File::create(path), fill)
    }
}
