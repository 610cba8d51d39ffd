//! Time limits at the end of a run for its pending results.

use super::pending_results::{ResultState, Source};
use super::time_limit::TimeLimit;
use crate::nodes::NodeKind;
use grainlab_node_kit::Exit;
use std::time::Duration;

/// Time limit for the measurement of the last packing, and for the inversion of a measurement.
const MEASURED_WITHIN: Duration = Duration::from_secs(600);
const INVERTED_WITHIN: Duration = Duration::from_secs(30);

/// Time limit for the measurement of the last packing by a third-party program that measured others.
const INSTRUMENT_WITHIN: Duration = Duration::from_secs(60);

/// Why a run is not complete whose instruments measured other packings.
const NONE_OF_LAST: &str = "a program that the launch file lists sent wave speeds of other packings, and none or fewer of the last arrived";

/// Time without further data of a program after which there are none.
const QUIET: Duration = Duration::from_secs(2);

/// Time for the last data of a program that has ended to arrive.
const ARRIVES_WITHIN: Duration = Duration::from_secs(5);

/// The pending result, and its time limit.
pub(super) struct Deadline {
    pub(super) of: ResultState,
    pub(super) limit: TimeLimit,
    pub(super) exit: Exit,
    pub(super) message: String,
}

impl Deadline {
    /// For a last packing that was published within a phase: it may have no results.
    pub(super) fn within_a_phase(standing: ResultState) -> Self {
        let whole = Self::of(standing);
        match standing {
            ResultState::Measured(_) => whole,
            ResultState::Open(_) => {
                Self { limit: TimeLimit::new(INSTRUMENT_WITHIN), exit: Exit::Done, ..whole }
            }
            _ => Self { exit: Exit::Done, ..whole },
        }
    }

    pub(super) fn of(standing: ResultState) -> Self {
        let (time, exit, message) = match standing {
            ResultState::Measured(node) => {
                let message = format!(
                    "what {node} measured of the last packing was not inverted: see logs/{}.log",
                    NodeKind::EmtInversion
                );
                (INVERTED_WITHIN, Exit::Failure, message)
            }
            ResultState::Open(Source::Instrument) => {
                (INSTRUMENT_WITHIN, Exit::DataLoss, NONE_OF_LAST.to_owned())
            }
            ResultState::Open(node) | ResultState::Declined(node) => {
                let message = format!("the last packing was not measured: see logs/{node}.log");
                (MEASURED_WITHIN, Exit::Failure, message)
            }
            ResultState::Left => (ARRIVES_WITHIN, Exit::DataLoss, format!("{NONE_OF_LAST}: it has ended")),
            ResultState::Settling => (QUIET, Exit::Done, String::new()),
            ResultState::Complete => (Duration::ZERO, Exit::Done, String::new()),
        };
        Self { of: standing, limit: TimeLimit::new(time), exit, message }
    }
}

/// The result that a node does not have for a packing, and the log with the reason.
pub(super) fn nothing(source: Source) -> String {
    let data = match source {
        Source::Node(NodeKind::AcousticProbe) => "wave speeds",
        _ => "stiffness",
    };
    format!("{data} to invert: see logs/{source}.log")
}
