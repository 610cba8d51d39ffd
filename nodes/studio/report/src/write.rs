//! The file of a report.

use crate::run::Run;
use grainlab_console::{Failure, replace_whole};
use grainlab_viewer::PictureError;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Name of the report in the directory of its run.
pub const FILE: &str = "report.html";

/// Text in the style of every page, by which a page is known.
const SIGN: &[u8] = b":root{--paper:";

/// Number of bytes at the start of a page that contain [`SIGN`]: only the title is before it.
const HEAD: u64 = 8 << 10;

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

/// Returns the path of a page that the user did not name, unless it has a file that is no page of grainlab.
///
/// # Errors
/// Wrong usage, which names the file.
pub fn default_page(path: PathBuf) -> Result<PathBuf, Failure> {
    if path.symlink_metadata().is_err() || is_page(&path) {
        return Ok(path);
    }
    let fault = format!(
        "{}: this file is no page of grainlab, and is not replaced: name the page with -o",
        path.display()
    );
    Err(Failure::usage(fault))
}

fn is_page(file: &Path) -> bool {
    let mut head = Vec::new();
    // A pipe would block.
    let is_file = file.metadata().is_ok_and(|found| found.is_file());
    is_file
        && File::open(file).and_then(|file| file.take(HEAD).read_to_end(&mut head)).is_ok()
        && head.windows(SIGN.len()).any(|part| part == SIGN)
}

/// Writes the report of a run beside its recording, and returns its path.
///
/// # Errors
/// If it cannot be written. What cannot be read of the run is named in the report.
pub fn write_report(directory: &Path) -> Result<PathBuf, ReportError> {
    let path = directory.join(FILE);
    let written = replace_whole(&path, Run::read(directory).html()?);
    written.map_err(|source| ReportError::Write { path: path.clone(), source })?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_page::Page;

    #[test]
    fn a_page_that_the_user_did_not_name_replaces_only_a_page_of_grainlab() {
        let folder = tempfile::tempdir().unwrap();
        let path = || folder.path().join("report.html");
        assert!(default_page(path()).is_ok());
        for is_served in [false, true] {
            let text = Page { title: "&".repeat(1000), is_served, ..Page::default() }.text();
            std::fs::write(path(), text).unwrap();
            assert!(default_page(path()).is_ok());
        }
        std::fs::write(path(), "<html>my own</html>").unwrap();
        let refused = default_page(path()).unwrap_err();
        assert_eq!(refused.exit, grainlab_msgs::Exit::Usage);
        assert!(refused.to_string().contains("is no page of grainlab"), "{refused}");
    }
}
