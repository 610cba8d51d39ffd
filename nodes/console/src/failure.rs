//! How a command that could not do what was asked ends.

use grainlab_node_kit::Exit;
use std::fmt;

/// A message for stderr and the exit code that goes with it.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub exit: Exit,
    message: String,
}

impl Failure {
    /// Ends with `exit` and says why.
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
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// The worse of two ends: a failure over lost data over a good end; an interruption over all.
pub fn worse(a: Exit, b: Exit) -> Exit {
    let rank = |e: Exit| match e {
        Exit::Done => 0,
        Exit::DataLoss => 1,
        Exit::PhysicsInvalid => 2,
        Exit::Usage => 3,
        Exit::Failure => 4,
        Exit::Interrupted => 5,
    };
    if rank(b) > rank(a) { b } else { a }
}
