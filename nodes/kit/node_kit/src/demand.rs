//! Quality of service of a subscription.

use grainlab_msgs::Topic;

/// The requested quality of service: at most what the topic offers, so that it always matches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Demand {
    /// True if lost samples are repeated and a late reader receives the last samples of a latched topic.
    pub reliable: bool,
    /// Maximum number of queued samples; a full queue drops the oldest. At least the largest backlog.
    pub depth: u32,
    /// Maximum number of queued samples while they are small: `depth`, or more to take bursts.
    pub burst: u32,
}

impl Demand {
    /// Every sample, and for a late reader the latched ones: at least the topic's depth of them, possibly more.
    pub const fn reliable(depth: u32) -> Self {
        Self { reliable: true, depth, burst: depth }
    }

    /// No repetition by the bus: for nodes that repeat by themselves and must not block a writer when they crash.
    pub const fn best_effort(depth: u32) -> Self {
        Self { reliable: false, depth, burst: depth }
    }

    /// Queues up to `burst` samples instead of `depth` as long as they are small: some megabytes in all.
    pub const fn with_burst(self, burst: u32) -> Self {
        Self { burst, ..self }
    }

    /// The demand that `topic` can meet.
    pub fn within(self, topic: &Topic) -> Self {
        let depth = self.depth.max(1);
        Self { reliable: self.reliable && topic.qos.reliable, depth, burst: self.burst.max(depth) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::topics;

    #[test]
    fn a_demand_never_exceeds_what_the_topic_offers() {
        let of_clock = Demand::reliable(20_000).within(&topics::CLOCK);
        assert_eq!(of_clock.reliable, topics::CLOCK.qos.reliable);
        assert!(Demand::reliable(10).within(&topics::PACKING).reliable);
        assert_eq!(Demand::best_effort(0).within(&topics::PACKING), Demand::best_effort(1));
    }
}
