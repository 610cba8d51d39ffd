//! QoS on the command line, in the words of ROS 2.

use crate::graph::{Endpoint, is_reliable, is_transient_local};
use clap::ValueEnum;
use grainlab_msgs::Qos;

/// Samples kept for a late or slow reader of what `pub` sends.
const DEPTH: u32 = 10;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum Profile {
    Default,
    SensorData,
    ServicesDefault,
    SystemDefault,
    Parameters,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum Reliability {
    Reliable,
    BestEffort,
    SystemDefault,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum Durability {
    TransientLocal,
    Volatile,
    SystemDefault,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
enum History {
    KeepLast,
    KeepAll,
    SystemDefault,
}

/// Policies that are set, and not adapted to the other side.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub(crate) struct QosArgs {
    /// Profile from which the other policies differ
    #[arg(long, value_enum, value_name = "PROFILE")]
    qos_profile: Option<Profile>,
    /// Reliability [default: for a subscription, that of the publishers]
    #[arg(long, value_enum, value_name = "KIND")]
    qos_reliability: Option<Reliability>,
    /// Durability [default: for a subscription, that of the publishers]
    #[arg(long, value_enum, value_name = "KIND")]
    qos_durability: Option<Durability>,
    /// History; all is the last 10000
    #[arg(long, value_enum, value_name = "KIND")]
    qos_history: Option<History>,
    /// Number of messages of the history
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    qos_depth: Option<u32>,
}

impl QosArgs {
    fn with(&self, adapted: Qos) -> Qos {
        let from = match self.qos_profile {
            None => adapted,
            Some(Profile::SensorData) => Qos { reliable: false, depth: 5, transient_local: false },
            Some(Profile::Parameters) => Qos { reliable: true, depth: 1000, transient_local: false },
            Some(_) => Qos { reliable: true, depth: DEPTH, transient_local: false },
        };
        let all = matches!(self.qos_history, Some(History::KeepAll)).then_some(10_000);
        Qos {
            reliable: self.qos_reliability.map_or(from.reliable, |r| r != Reliability::BestEffort),
            transient_local: self
                .qos_durability
                .map_or(from.transient_local, |d| d == Durability::TransientLocal),
            depth: all.or(self.qos_depth).unwrap_or(from.depth),
        }
    }

    /// Policies of a publisher.
    pub(super) fn offered(&self) -> Qos {
        self.with(Qos { reliable: true, depth: DEPTH, transient_local: false })
    }

    /// Policies of a subscription that takes `whole` messages of these publishers: as strict as all of them allow.
    pub(super) fn requested(&self, publishers: &[&Endpoint], whole: bool, depth: u32) -> Qos {
        let offer = |policy: fn(&ros2_client::QosProfile) -> bool| {
            whole && !publishers.is_empty() && publishers.iter().all(|p| policy(&p.qos))
        };
        let reliable = offer(is_reliable);
        self.with(Qos { reliable, depth, transient_local: reliable && offer(is_transient_local) })
    }
}
