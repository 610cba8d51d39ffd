//! Failures of a command.

use grainlab_msgs::Exit;
use std::fmt;
use std::path::Path;

/// A message for stderr and its exit code.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub exit: Exit,
    message: String,
}

impl Failure {
    /// A failure with exit code `exit` and this message.
    pub fn new(exit: Exit, message: impl fmt::Display) -> Self {
        Self { exit, message: message.to_string() }
    }

    /// Wrong usage: exit 2.
    pub fn usage(message: impl fmt::Display) -> Self {
        Self::new(Exit::Usage, message)
    }

    /// Something failed: exit 1.
    pub fn failed(message: impl fmt::Display) -> Self {
        Self::new(Exit::Failure, message)
    }

    /// A failure about this file or folder: exit 1.
    pub fn at<E: fmt::Display>(path: &Path) -> impl Fn(E) -> Self {
        move |e| Self::failed(format!("{}: {e}", path.display()))
    }
}

impl std::error::Error for Failure {}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// The worse of two results: a failure over lost data over success; an interruption over all.
pub fn worse(a: Exit, b: Exit) -> Exit {
    use Exit::*;
    let ranks = [Done, DataLoss, PhysicsInvalid, Usage, Failure, Interrupted];
    ranks.into_iter().rfind(|e| [a, b].contains(e)).unwrap_or(a)
}
