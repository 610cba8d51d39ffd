//! The exit codes of all processes.

use std::fmt;

/// The result of a process, as an exit code.
///
/// Launchers and scripts rely on the codes; they are the same for nodes, tools and the launcher.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Exit {
    /// 0: all was done.
    Done = 0,
    /// 1: an error while it ran: a file, the network, another process.
    Failure = 1,
    /// 2: wrong usage: an unknown option, scene key or parameter, or a value out of range. Nothing was started.
    Usage = 2,
    /// 3: done, but data was lost.
    DataLoss = 3,
    /// 4: the physics became invalid: unstable, not finite, or no contact network.
    PhysicsInvalid = 4,
    /// 130: interrupted before the result was complete (128 + SIGINT, as shells report it).
    Interrupted = 130,
}

impl Exit {
    /// All results, in the order of the codes.
    pub const ALL: [Exit; 6] =
        [Exit::Done, Exit::Failure, Exit::Usage, Exit::DataLoss, Exit::PhysicsInvalid, Exit::Interrupted];

    /// The exit code.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// The meaning of a child's exit code; `None` for an unknown code.
    pub fn from_code(code: i32) -> Option<Exit> {
        Self::ALL.into_iter().find(|exit| i32::from(exit.code()) == code)
    }
}

impl From<Exit> for std::process::ExitCode {
    fn from(exit: Exit) -> Self {
        std::process::ExitCode::from(exit.code())
    }
}

impl fmt::Display for Exit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Exit::Done => "done",
            Exit::Failure => "failure",
            Exit::Usage => "wrong usage",
            Exit::DataLoss => "done with data loss",
            Exit::PhysicsInvalid => "physics invalid",
            Exit::Interrupted => "interrupted",
        };
        write!(f, "{text} (exit {})", self.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_reads_back_and_no_other_is_known() {
        for exit in Exit::ALL {
            assert_eq!(Exit::from_code(i32::from(exit.code())), Some(exit));
        }
        for stranger in [-1, 5, 101, 137, 143] {
            assert_eq!(Exit::from_code(stranger), None, "{stranger} is not in the contract");
        }
    }
}
