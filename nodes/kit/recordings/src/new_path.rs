//! Outputs that appear complete or not at all.

use rustix::fs::{CWD, RenameFlags, renameat_with};
use rustix::io::Errno;
use std::ffi::OsString;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// A file or directory that is written under a temporary name beside its own. Dropped before [`NewPath::finish`], it is
/// removed.
#[derive(Debug)]
pub struct NewPath {
    path: PathBuf,
    partial: PathBuf,
}

impl NewPath {
    /// The temporary name of `path`; only missing parents are created.
    ///
    /// # Errors
    /// `AlreadyExists` if there is something under this name; if the path has no last name.
    pub fn begin(path: &Path) -> io::Result<Self> {
        let name = path.file_name().ok_or_else(|| {
            io::Error::new(ErrorKind::InvalidInput, format!("{} has no name at its end", path.display()))
        })?;
        if path.symlink_metadata().is_ok() {
            let problem = format!("{} exists: choose another output", path.display());
            return Err(io::Error::new(ErrorKind::AlreadyExists, problem));
        }
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".part-{}", std::process::id()));
        Ok(Self { path: path.to_owned(), partial: path.with_file_name(hidden) })
    }

    /// Temporary name, under which the output is written.
    pub fn partial(&self) -> &Path {
        &self.partial
    }

    /// Gives the output its name.
    ///
    /// # Errors
    /// `AlreadyExists` if there is something under this name by now, or if the file system fails. The output is then removed.
    pub fn finish(self) -> io::Result<()> {
        rename_new(&self.partial, &self.path)
    }
}

impl Drop for NewPath {
    fn drop(&mut self) {
        // After the end, nothing of this name is left.
        let _ = match self.partial.is_dir() {
            true => fs::remove_dir_all(&self.partial),
            false => fs::remove_file(&self.partial),
        };
    }
}

/// Renames unless `to` exists; on a file system that cannot do both at once, after a look.
fn rename_new(from: &Path, to: &Path) -> io::Result<()> {
    match renameat_with(CWD, from, CWD, to, RenameFlags::NOREPLACE) {
        Err(Errno::INVAL | Errno::NOSYS) if to.symlink_metadata().is_ok() => {
            Err(ErrorKind::AlreadyExists.into())
        }
        Err(Errno::INVAL | Errno::NOSYS) => fs::rename(from, to),
        outcome => Ok(outcome?),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_output_appears_at_the_end_and_never_replaces_another() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out");
        let new = NewPath::begin(&path).unwrap();
        fs::write(new.partial(), "x").unwrap();
        assert!(!path.exists());
        new.finish().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "x");
        assert_eq!(NewPath::begin(&path).unwrap_err().kind(), ErrorKind::AlreadyExists);
        let late = folder.path().join("late");
        let new = NewPath::begin(&late).unwrap();
        fs::create_dir(new.partial()).unwrap();
        fs::create_dir(&late).unwrap();
        assert_eq!(new.finish().unwrap_err().kind(), ErrorKind::AlreadyExists);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "the partial one is removed");
    }
}
