//! QoS on the command line, in the words of ROS 2.

use crate::graph::{Endpoint, is_reliable, is_transient_local};
use grainlab_msgs::Qos;

/// Samples kept for a late or slow reader of what `pub` sends.
const DEPTH: u32 = 10;

/// Policies that are set, and not adapted to the other side.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct QosArgs {
    /// Reliability [default: for a subscription, that of the publishers]
    #[arg(long, value_parser = ["reliable", "best_effort"], value_name = "KIND")]
    qos_reliability: Option<String>,
    /// Durability [default: for a subscription, that of the publishers]
    #[arg(long, value_parser = ["transient_local", "volatile"], value_name = "KIND")]
    qos_durability: Option<String>,
    /// Number of messages kept for a slow or late reader
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    qos_depth: Option<u32>,
}

impl QosArgs {
    fn with(&self, adapted: Qos) -> Qos {
        let is = |policy: &Option<String>, default, word| policy.as_ref().map_or(default, |p| p == word);
        Qos {
            reliable: is(&self.qos_reliability, adapted.reliable, "reliable"),
            transient_local: is(&self.qos_durability, adapted.transient_local, "transient_local"),
            depth: self.qos_depth.unwrap_or(adapted.depth),
        }
    }

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
