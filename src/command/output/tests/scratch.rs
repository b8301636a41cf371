//! Folders that do not outlive their test.

use std::fs;
use std::path::PathBuf;

use crate::output::Folder;

/// A folder of this test alone, removed at its end.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    pub fn new(name: &str) -> Scratch {
        Scratch(std::env::temp_dir().join(format!("materialpoint-{name}-{}", std::process::id())))
    }

    pub fn folder(&self) -> Folder {
        Folder::create(&self.0.join("a/b")).unwrap()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
