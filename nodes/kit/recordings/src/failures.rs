//! Failures of files that are written.

use grainlab_console::Failure;
use mcap::McapError;
use std::fmt::Display;
use std::path::Path;

/// A failure to do this with a file or directory, before its reason.
pub(crate) fn cannot<E: Display>(path: &Path, action: &str) -> impl FnOnce(E) -> Failure + use<E> {
    let what = format!("{}: cannot {action}", path.display());
    move |reason| Failure::failed(format!("{what}: {reason}"))
}

/// Reason of the MCAP writer, which is that of the file system if it has one.
pub(crate) fn reason(error: McapError) -> String {
    match error {
        McapError::Io(source) => source.to_string(),
        other => other.to_string(),
    }
}
