//! The QoS of the topic table as policies of RustDDS.

use crate::demand::Demand;
use grainlab_msgs::Topic;
use rustdds::policy::{Deadline, Durability, History, Lifespan, Liveliness, Reliability, ResourceLimits};
use rustdds::{Duration, QosPolicies, QosPolicyBuilder};

/// How long a reliable write waits while its window is full. Longer than one repair round (10 ms), much shorter than a
/// step of the slowest node, so that a crashed reader delays a writer but never stops it.
const MAX_BLOCKING: Duration = Duration::from_millis(20);

/// Unacknowledged samples of a stream. A crashed reader stays matched for up to a minute; at a servo's highest rate of
/// some kHz the window fills within seconds, and then each sample costs [`MAX_BLOCKING`].
const STREAM_WINDOW: u32 = 8192;

/// Unacknowledged samples of a latched topic: these are megabytes each, and a few per minute.
const LATCHED_WINDOW: u32 = 256;

/// Maximum number of unacknowledged samples of a writer of `topic`.
pub(super) fn window(topic: &Topic) -> u32 {
    let window = if topic.qos.transient_local && topic.qos.depth < LATCHED_WINDOW {
        LATCHED_WINDOW
    } else {
        STREAM_WINDOW
    };
    window.max(topic.qos.depth)
}

/// The policies that a writer of `topic` offers.
pub(super) fn offered(topic: &Topic) -> QosPolicies {
    let qos = topic.qos;
    policies(qos.reliable, qos.transient_local, qos.depth, window(topic))
}

/// The policies that a reader requests; `demand` is within the topic's QoS already.
pub(super) fn requested(topic: &Topic, demand: Demand) -> QosPolicies {
    // RustDDS keeps 64 samples by default: too few for a recorder, too many for packings of megabytes.
    policies(demand.reliable, demand.reliable && topic.qos.transient_local, demand.depth, demand.depth)
}

fn policies(reliable: bool, transient_local: bool, depth: u32, max_samples: u32) -> QosPolicies {
    let clamped = |n: u32| i32::try_from(n).unwrap_or(i32::MAX);
    QosPolicyBuilder::new()
        .reliability(if reliable {
            Reliability::Reliable { max_blocking_time: MAX_BLOCKING }
        } else {
            Reliability::BestEffort
        })
        .durability(if transient_local { Durability::TransientLocal } else { Durability::Volatile })
        .history(History::KeepLast { depth: clamped(depth) })
        .resource_limits(ResourceLimits {
            max_samples: clamped(max_samples),
            max_instances: 1,
            max_samples_per_instance: clamped(max_samples),
        })
        .deadline(Deadline(Duration::INFINITE))
        .lifespan(Lifespan { duration: Duration::INFINITE })
        .liveliness(Liveliness::Automatic { lease_duration: Duration::INFINITE })
        .build()
}
