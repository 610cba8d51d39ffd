//! The servo as a node.

use crate::{Refusal, answer};
use grainlab_msgs::msg::{StrainRate, Stress};
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Bus, BusError, Demand, Health, Next, Node, NodeError, ParameterSpec, Publisher, Range, SampleId,
    Subscription,
};
use std::collections::VecDeque;
use std::time::Duration;

/// The node does nothing between two stresses.
const IDLE: Duration = Duration::from_secs(3600);

/// Capacity of the queue of stresses; the simulator sends one at a time, and a few ahead in free run.
const BACKLOG: u32 = 16;

/// The parameters of the node.
pub fn parameters() -> Vec<ParameterSpec> {
    let most = i64::from(u8::MAX);
    vec![
        ParameterSpec::new(
            "min_readers",
            1_i64,
            "number of readers of strain_rate to wait for before the first answer, 1",
        )
        .within(Range::Integer { min: 0, max: most }),
    ]
}

/// The servo: answers every stress and has no state that matters.
#[derive(Debug)]
pub struct ServoController {
    min_readers: usize,
    /// True once the readers to wait for have been present.
    ready: bool,
    /// Stresses received before that.
    early: VecDeque<(Stress, SampleId)>,
    stress: Subscription<Stress>,
    strain_rate: Publisher<StrainRate>,
    answered: u64,
    unanswered: u64,
    /// Sequence number of the next stress, and the number of those before it that did not arrive.
    next: Option<u64>,
    missed: u64,
    /// The fault of the latest stress, if any.
    trouble: Option<String>,
}

impl ServoController {
    /// Creates the publisher and the subscription. The latter is best effort: the simulator repeats lost stresses, and
    /// a servo that stopped must not fill the simulator's window. No answer precedes `min_readers` readers of `strain_rate`, so
    /// that a recorder does not miss one.
    pub fn new(bus: &mut dyn Bus, min_readers: usize) -> Result<Self, BusError> {
        Ok(Self {
            min_readers,
            ready: false,
            early: VecDeque::new(),
            stress: Subscription::subscribe(bus, &topics::STRESS, Demand::best_effort(BACKLOG))?,
            strain_rate: Publisher::advertise(bus, &topics::STRAIN_RATE)?,
            answered: 0,
            unanswered: 0,
            next: None,
            missed: 0,
            trouble: None,
        })
    }

    /// Counts stresses that did not arrive. The lockstep repeats them; a player does not.
    fn note_gap(&mut self, sequence: u64) {
        let gap = self.next.map_or(0, |next| sequence.saturating_sub(next));
        self.next = Some(sequence.wrapping_add(1));
        self.missed += gap;
        // Not every time, for a reader that is always behind.
        if gap > 0 && self.missed >= 2 * (self.missed - gap) {
            log::warn!(
                "{gap} stresses before {sequence} did not arrive ({} so far): they are not answered",
                self.missed
            );
        }
    }

    fn reply(&mut self, bus: &mut dyn Bus, stress: &Stress, request: SampleId) -> Result<(), BusError> {
        match answer(stress) {
            Ok(message) => match self.strain_rate.publish_about(bus, &message, request) {
                Ok(_) => {
                    self.answered += 1;
                    self.trouble = None;
                }
                // The stress will be repeated; the kit counts the lost answer.
                Err(full @ BusError::Full { .. }) => self.trouble = Some(full.to_string()),
                Err(error) => return Err(error),
            },
            Err(refusal) => self.refuse(bus, &refusal),
        }
        Ok(())
    }

    fn refuse(&mut self, bus: &mut dyn Bus, refusal: &Refusal) {
        if matches!(refusal, Refusal::Boundary(_)) {
            bus.count_refused(self.stress.id());
        }
        self.unanswered += 1;
        // Not every time: a repeated stress would fill the log with the same line.
        if self.unanswered.is_power_of_two() {
            log::warn!("{refusal} ({} unanswered so far)", self.unanswered);
        }
        self.trouble = Some(refusal.to_string());
    }
}

impl Node for ServoController {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        self.ready = self.ready || bus.readers(self.strain_rate.id()) >= self.min_readers;
        if self.ready {
            while let Some((stress, request)) = self.early.pop_front() {
                self.reply(bus, &stress, request)?;
            }
        }
        while let Some((stress, info)) = self.stress.take_valid(bus)? {
            self.note_gap(stress.sequence);
            if self.ready {
                self.reply(bus, &stress, info.id())?;
            } else {
                if self.early.len() >= BACKLOG as usize {
                    self.early.pop_front();
                }
                self.early.push_back((stress, info.id()));
            }
        }
        Ok(Next::Wait(IDLE))
    }

    fn health(&self) -> Health {
        let health = match &self.trouble {
            None if self.missed > 0 => Health::warn(format!("{} stresses did not arrive", self.missed)),
            None => Health::ok(format!("{} answers", self.answered)),
            Some(trouble) => Health::warn(trouble.clone()),
        };
        health.with("answered", self.answered).with("unanswered", self.unanswered).with("missed", self.missed)
    }
}
