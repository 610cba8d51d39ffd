//! A kit for tests: the laboratory in one thread, its record, its faults, and processes that forge its messages.
//!
//! - [`Bench`]: the nodes of a laboratory on the bus in memory, of each [`Kind`]; [`Record`]: what they published
//! - [`run_with`]: a whole run under the faults of a [`Plan`]; `process`: one of its processes
//! - [`pingpong`]: the exchange of the lockstep alone, for measurements
//! - [`Forgery`]: kinds of forged messages; `stranger`: a participant that publishes them; [`Forger`]: the same over DDS

mod bench;
mod faulty;
mod forger;
mod forgery;
pub mod pingpong;
mod plan;
mod process;
mod record;
mod stranger;

pub use bench::{Bench, Kind, exit_of, tiny};
pub use faulty::{Done, Outcome, run_with};
pub use forger::Forger;
pub use forgery::{EARLY_ANSWER, ESTIMATES, FORGERIES, Forgery, OLD_RESULT};
pub use plan::Plan;
pub use record::Record;
