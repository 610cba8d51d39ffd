//! A file that is open only while bytes are written to it: a recording may have more topics than a process may have open files.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A new file to which bytes are appended. Each write opens the file, so that writes should be buffered.
pub(crate) struct Appended(PathBuf);

impl Appended {
    /// Creates the file, which must not exist.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        File::create_new(path)?;
        Ok(Self(path.to_owned()))
    }
}

impl Write for Appended {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        OpenOptions::new().append(true).open(&self.0)?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
