//! A participant that is not part of a run and publishes forged messages on its topics.

use crate::forgery::Forgery;
use grainlab_node_kit::{Bus, BusError, Demand, Dice, PublisherId, SampleId, SubscriptionId};

/// Returns true for a participant whose messages are forged.
type Victims = dyn Fn(&[u8; 12]) -> bool;

pub(crate) struct Stranger<B> {
    pub(crate) bus: B,
    forgery: Forgery,
    input: SubscriptionId,
    output: PublisherId,
    victims: Box<Victims>,
    /// Fraction of the received messages that it forges.
    share: f64,
    dice: Dice,
    pub(crate) forged: u64,
}

impl<B: Bus> Stranger<B> {
    pub(crate) fn join(
        mut bus: B,
        forgery: Forgery,
        victims: impl Fn(&[u8; 12]) -> bool + 'static,
        share: f64,
        seed: u64,
    ) -> Result<Self, BusError> {
        let input = bus.subscribe(&forgery.from, Demand::best_effort(1000))?;
        let output = bus.advertise(&forgery.to)?;
        let (victims, dice) = (Box::new(victims), Dice::new(seed));
        Ok(Self { bus, forgery, input, output, victims, share, dice, forged: 0 })
    }

    /// Publishes the message that needs no request, if the forgery has one: an answer of zeros, an old result.
    pub(crate) fn publish_early(&mut self) -> Result<(), BusError> {
        self.forgery.early.map_or(Ok(()), |early| self.publish(&early(), None))
    }

    pub(crate) fn publish(&mut self, body: &[u8], about: Option<SampleId>) -> Result<(), BusError> {
        self.forged += 1;
        self.bus.publish_about(self.output, body, about).map(drop)
    }

    /// Forges a fraction of the received messages; true if any arrived.
    pub(crate) fn step(&mut self) -> Result<bool, BusError> {
        let mut received = false;
        while let Some(sample) = self.bus.take(self.input)? {
            received = true;
            // Two strangers that forge each other's messages would never end.
            if !(self.victims)(&sample.info.writer.participant()) || self.dice.unit() >= self.share {
                continue;
            }
            let by = 0.5 + self.dice.unit();
            if let Some(body) = (self.forgery.forged)(&sample.body, by) {
                // Refers to the request, like the answer of a servo, or to what the message refers to.
                let is_answer = self.forgery.from.name != self.forgery.to.name;
                let about = if is_answer { Some(sample.info.id()) } else { sample.info.about };
                let refers = self.dice.below(2) == 0;
                self.publish(&body, about.filter(|_| refers))?;
            }
        }
        Ok(received)
    }
}
