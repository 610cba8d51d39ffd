//! A folder for the files that LAMMPS reads and writes.

use crate::refusal::refused;
use grainlab_engine::EngineError;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A folder of this process alone, which is removed with it.
#[derive(Debug)]
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new() -> Result<Self, EngineError> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let parent = std::env::temp_dir();
        if parent.to_string_lossy().contains('"') {
            return refused(format!(
                "TMPDIR is {}: commands of LAMMPS have no names with a \"",
                parent.display()
            ));
        }
        let path = parent.join(format!("grainlab-lammps-{}-{number}", std::process::id()));
        match std::fs::create_dir(&path) {
            Ok(()) => Ok(Self(path)),
            Err(e) => refused(format!(
                "no folder for temporary files: {}: {e}; the variable TMPDIR names its place",
                path.display()
            )),
        }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, EngineError> {
        let path = self.file(name);
        match std::fs::write(&path, bytes) {
            Ok(()) => Ok(path),
            Err(e) => refused(format!("{}: {e}", path.display())),
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
