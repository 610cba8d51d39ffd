//! Time limits at the end of a run for its pending results.

use super::pending_results::{ResultState, Source};
use super::plan::NodePlan;
use super::time_limit::TimeLimit;
use crate::nodes::NodeKind;
use grainlab_node_kit::Exit;
use std::time::Duration;

/// Time limit for the measurement of the last packing, and for the inversion of a measurement.
const MEASURED_WITHIN: Duration = Duration::from_secs(600);
const INVERTED_WITHIN: Duration = Duration::from_secs(30);

/// Time limit for the data of the last packing from a third-party program.
const INSTRUMENT_WITHIN: Duration = Duration::from_secs(60);

/// Reason of an incomplete run, whose instruments sent nothing of the last packing.
const NONE_OF_LAST: &str = "a program that the launch file lists sent data of other packings, or until_inverted awaits its data, and none or fewer of the last arrived";

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
    pub(super) fn within_a_phase(standing: ResultState, logs: &Logs) -> Self {
        let whole = Self::of(standing, logs);
        match standing {
            ResultState::Measured(_) => whole,
            ResultState::Open(_) => {
                Self { limit: TimeLimit::new(INSTRUMENT_WITHIN), exit: Exit::Done, ..whole }
            }
            _ => Self { exit: Exit::Done, ..whole },
        }
    }

    pub(super) fn of(standing: ResultState, logs: &Logs) -> Self {
        let (time, exit, message) = match standing {
            ResultState::Measured(node) => {
                let log = logs.of(Source::Node(NodeKind::EmtInversion));
                let message = format!("what {node} measured of the last packing was not inverted: {log}");
                (INVERTED_WITHIN, Exit::Failure, message)
            }
            ResultState::Open(Source::Instrument) => {
                (INSTRUMENT_WITHIN, Exit::DataLoss, NONE_OF_LAST.to_owned())
            }
            ResultState::Open(node) | ResultState::Declined(node) => {
                let message = format!("the last packing was not measured: {}", logs.of(node));
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
pub(super) fn nothing(source: Source, logs: &Logs) -> String {
    let data = match source {
        Source::Node(NodeKind::AcousticProbe) => "wave speeds",
        _ => "stiffness",
    };
    format!("{data} to invert: {}", logs.of(source))
}

/// The names of the processes of a run and of their logs: names and namespaces of the launch file are in them.
#[derive(Debug)]
pub(super) struct Logs(Vec<(Source, String)>);

impl Logs {
    pub(super) fn new(plans: &[NodePlan]) -> Self {
        let name = |p: &NodePlan| (p.node.map_or(Source::Instrument, Source::Node), p.name.clone());
        Self(plans.iter().map(name).collect())
    }

    pub(super) fn names(&self, source: Source) -> impl Iterator<Item = &str> {
        self.0.iter().filter(move |(of, _)| *of == source).map(|(_, name)| name.as_str())
    }

    /// Advice to read the logs of `source`.
    pub(super) fn of(&self, source: Source) -> String {
        let logs = self.names(source).map(|name| format!("logs/{name}.log"));
        match logs.collect::<Vec<_>>().join(", ") {
            none if none.is_empty() => format!("the launch file starts no {source}"),
            logs => format!("see {logs}"),
        }
    }
}
