//! The folder of a report.

use grainlab_console::{Failure, say, write_whole};
use std::path::Path;

/// Creates the folder: before long computations, not after.
pub(super) fn ready(folder: Option<&Path>) -> Result<(), Failure> {
    let Some(folder) = folder else { return Ok(()) };
    std::fs::create_dir_all(folder).map_err(|e| Failure::failed(format!("{}: {e}", folder.display())))
}

/// Writes one of its files and reports its path on stderr.
pub(super) fn write(folder: &Path, name: &str, text: &str) -> Result<(), Failure> {
    let path = folder.join(name);
    write_whole(&path, text).map_err(|e| Failure::failed(format!("{}: {e}", path.display())))?;
    say!("grainlab: {} written", path.display());
    Ok(())
}
