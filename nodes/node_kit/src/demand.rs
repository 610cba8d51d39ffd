//! Quality of service of a subscription.

use grainlab_msgs::Topic;

/// What a subscription asks of its writers. It asks at most what the topic offers, so that it always matches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Demand {
    /// Lost samples are sent again, and a latched topic's last samples come to a late joiner.
    pub reliable: bool,
    /// Samples kept between two takes; older ones give way. At least the worst backlog.
    pub depth: u32,
}

impl Demand {
    /// Every sample, and the latched ones for a late joiner: at least the topic's depth of them, possibly more.
    pub const fn reliable(depth: u32) -> Self {
        Self { reliable: true, depth }
    }

    /// No repetition by the bus: for partners that repeat by themselves, and that must not hold up a writer when dead.
    pub const fn best_effort(depth: u32) -> Self {
        Self { reliable: false, depth }
    }

    /// The demand that `topic` can meet.
    pub fn within(self, topic: &Topic) -> Self {
        Self { reliable: self.reliable && topic.qos.reliable, depth: self.depth.max(1) }
    }

    /// Whether a subscription with this demand also serves `other`.
    pub fn covers(self, other: Self) -> bool {
        self.reliable >= other.reliable && self.depth >= other.depth
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
