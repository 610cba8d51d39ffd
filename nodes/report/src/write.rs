//! The file of a report.

use crate::run::Run;
use grainlab_viewer::PictureError;
use std::path::{Path, PathBuf};

/// Name of the report in the directory of its run.
pub const FILE: &str = "report.html";

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The picture of the packing failed.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// The file cannot be written.
    #[error("{}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

/// Writes a page to a file, whole or not at all. What is no file, such as a pipe or a device, is written to as it is; a link
/// stays one.
///
/// # Errors
/// If it cannot be written.
pub fn write_page(path: &Path, text: &str) -> Result<(), ReportError> {
    let failed = |source| ReportError::Write { path: path.to_owned(), source };
    if path.metadata().is_ok_and(|found| !found.is_file()) {
        return std::fs::write(path, text).map_err(failed);
    }
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let partial = target.with_extension("html.part");
    let written = std::fs::write(&partial, text).and_then(|()| std::fs::rename(&partial, &target));
    written.map_err(|source| {
        let _ = std::fs::remove_file(&partial);
        failed(source)
    })
}

/// Writes the report of a run beside its recording, and returns its path.
///
/// # Errors
/// If it cannot be written. What cannot be read of the run is named in the report.
pub fn write_report(directory: &Path) -> Result<PathBuf, ReportError> {
    let path = directory.join(FILE);
    write_page(&path, &Run::read(directory).html()?)?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link_and_its_file_gets_the_page() {
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["page.html", "link.html"].map(|name| folder.path().join(name));
        std::fs::write(&file, "old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_page(&link, "new").unwrap();
        assert!(link.is_symlink() && std::fs::read_to_string(&file).unwrap() == "new");
    }
}
