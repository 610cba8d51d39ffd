//! A process that is not part of the run and publishes forged messages on its topics.

use super::plan;
use grainlab_node_kit::{
    Bus, BusError, Demand, Dice, Hub, Identity, MemoryBus, Names, PublisherId, RunId, SubscriptionId, run_of,
};

/// One stranger on its bus.
pub(super) struct Stranger {
    plan: plan::Stranger,
    bus: MemoryBus,
    input: SubscriptionId,
    output: PublisherId,
    /// The run whose messages it forges.
    run: RunId,
    dice: Dice,
    pub(super) forged: u64,
}

impl Stranger {
    /// Publishes a message before any request: an answer of zeros, an old result.
    pub(super) fn join(hub: &Hub, run: RunId, plan: plan::Stranger, seed: u64) -> Result<Self, BusError> {
        let identity = match plan.of_a_run {
            true => Identity::member_of(RunId::named("another"), 1),
            false => Identity::default(),
        };
        let mut bus = hub.bus_as(Names::new("stranger")?, identity);
        let input = bus.subscribe(&plan.forgery.from, Demand::best_effort(1000))?;
        let output = bus.advertise(&plan.forgery.to)?;
        let mut stranger = Self { plan, bus, input, output, run, dice: Dice::new(seed), forged: 0 };
        if let Some(early) = plan.forgery.early {
            stranger.publish(&early(), None)?;
        }
        Ok(stranger)
    }

    fn publish(&mut self, body: &[u8], about: Option<grainlab_node_kit::SampleId>) -> Result<(), BusError> {
        self.forged += 1;
        self.bus.publish_about(self.output, body, about).map(drop)
    }

    /// Forges a fraction of the received messages; true if any arrived.
    pub(super) fn step(&mut self) -> Result<bool, BusError> {
        let mut received = false;
        while let Some(sample) = self.bus.take(self.input)? {
            received = true;
            // Two strangers that forge each other's messages would never end.
            let of_the_run = run_of(&sample.info.writer.participant()) == Some(self.run);
            if !of_the_run || self.dice.unit() >= self.plan.share {
                continue;
            }
            let by = 0.5 + self.dice.unit();
            if let Some(body) = (self.plan.forgery.forged)(&sample.body, by) {
                // Refers to the request, like the answer of a servo.
                let about = (self.dice.below(2) == 0).then(|| sample.info.id());
                self.publish(&body, about)?;
            }
        }
        Ok(received)
    }
}
