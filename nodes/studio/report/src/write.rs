//! The file of a report.

use crate::run::Run;
use grainlab_console::write_whole;
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
        /// Path of the file.
        path: PathBuf,
        /// Reason of the system.
        source: std::io::Error,
    },
}

/// Writes a page to a file, whole or not at all. What is no file, such as a pipe or a device, is written to as it is; a link
/// stays one.
///
/// # Errors
/// If it cannot be written.
pub fn write_page(path: &Path, text: &str) -> Result<(), ReportError> {
    write_whole(path, text).map_err(|source| ReportError::Write { path: path.to_owned(), source })
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
