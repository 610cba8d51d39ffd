//! The node of the inversion.

use crate::{Answer, Settings, microstructure_of_moduli, microstructure_of_report, microstructure_of_speeds};
use grainlab_msgs::msg::{Estimate, Microstructure, Moduli, PackingReport, WaveSpeeds};
use grainlab_msgs::{Guid, Message, Topic, topics};
use grainlab_node_kit::{
    Bus, BusError, Demand, Health, Next, Node, NodeError, Publisher, SampleInfo, Subscription,
};
use std::collections::BTreeMap;
use std::time::Duration;

/// The node does nothing between two sets of data.
const IDLE: Duration = Duration::from_secs(3600);

/// Capacity of the queue of one topic: an instrument may send hundreds of shots at once.
const BACKLOG: u32 = 1024;

/// One topic of data, and the function that inverts its messages.
#[derive(Debug)]
struct Source<T> {
    topic: &'static str,
    messages: Subscription<T>,
    invert: fn(&T, &Settings) -> Answer,
}

/// Counts of the data so far.
#[derive(Debug, Default)]
struct Tally {
    inverted: u64,
    without_solution: u64,
    last_step: Option<u64>,
    /// Data that were sent and did not arrive, by the gaps in the numbers of their writers.
    missed: u64,
    /// Number of the last data of each writer.
    numbers: BTreeMap<Guid, i64>,
    /// The fault of the latest data, if any.
    trouble: Option<String>,
}

/// The inversion: applies every model to every set of data.
#[derive(Debug)]
pub struct EmtInversion {
    settings: Settings,
    reports: Source<PackingReport>,
    moduli: Source<Moduli>,
    wave_speeds: Source<WaveSpeeds>,
    microstructure: Publisher<Microstructure>,
    tally: Tally,
}

impl EmtInversion {
    /// Receives the latest latched data, if any, and all data after them.
    pub fn new(bus: &mut dyn Bus, settings: Settings) -> Result<Self, BusError> {
        Ok(Self {
            settings,
            reports: Source::subscribe(bus, &topics::PACKING_REPORT, microstructure_of_report)?,
            moduli: Source::subscribe(bus, &topics::MODULI, microstructure_of_moduli)?,
            wave_speeds: Source::subscribe(bus, &topics::WAVE_SPEEDS, microstructure_of_speeds)?,
            microstructure: Publisher::advertise(bus, &topics::MICROSTRUCTURE)?,
            tally: Tally::default(),
        })
    }
}

impl<T: Message> Source<T> {
    fn subscribe(
        bus: &mut dyn Bus,
        topic: &Topic,
        invert: fn(&T, &Settings) -> Answer,
    ) -> Result<Self, BusError> {
        let messages = Subscription::subscribe(bus, topic, Demand::reliable(BACKLOG))?;
        Ok(Self { topic: topic.name, messages, invert })
    }

    /// Answers all received data, also those that are refused or have nothing to invert.
    fn answer(
        &self,
        bus: &mut dyn Bus,
        settings: &Settings,
        microstructure: &Publisher<Microstructure>,
        tally: &mut Tally,
    ) -> Result<(), BusError> {
        while let Some((data, info)) = self.messages.take_valid(bus)? {
            tally.note_gap(self.topic, &info);
            let Answer { message, refused } = (self.invert)(&data, settings);
            match (microstructure.publish_about(bus, &message, info.origin()), refused) {
                (Ok(_), None) => tally.count(&message),
                (Ok(_), Some(error)) => {
                    bus.count_refused(self.messages.id());
                    tally.complain(error.to_string());
                }
                // This reader is hundreds of results behind and counts as failed; the node continues.
                (Err(full @ BusError::Full { .. }), _) => tally.complain(full.to_string()),
                (Err(error), _) => return Err(error),
            }
        }
        Ok(())
    }
}

impl Tally {
    /// Counts the data between these and those before them of the same writer.
    fn note_gap(&mut self, topic: &str, info: &SampleInfo) {
        let before = self.numbers.insert(info.writer, info.sequence);
        let gap = before.map_or(0, |before| (info.sequence - before - 1).max(0)) as u64;
        if gap > 0 {
            self.missed += gap;
            self.complain(format!(
                "{gap} sets of {topic} were sent faster than they were inverted, and are not"
            ));
        }
    }

    fn complain(&mut self, trouble: String) {
        log::error!("{trouble}");
        self.trouble = Some(trouble);
    }

    fn count(&mut self, message: &Microstructure) {
        // Nothing is inferred from a packing that is not jammed.
        if message.estimates.is_empty() {
            return;
        }
        self.inverted += 1;
        self.last_step = Some(message.source_step);
        self.trouble = None;
        for unsolved in message.estimates.iter().filter(|e| e.status == Estimate::STATUS_UNKNOWN) {
            self.without_solution += 1;
            let (source, step, model) = (&message.source, message.source_step, &unsolved.model);
            let trouble = format!("{source} of step {step}, model {model}: {}", unsolved.warnings.join("; "));
            log::warn!("no estimate from {trouble}");
            self.trouble = Some(trouble);
        }
    }
}

impl Node for EmtInversion {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let Self { settings, reports, moduli, wave_speeds, microstructure, tally } = self;
        reports.answer(bus, settings, microstructure, tally)?;
        moduli.answer(bus, settings, microstructure, tally)?;
        wave_speeds.answer(bus, settings, microstructure, tally)?;
        Ok(Next::Wait(IDLE))
    }

    fn health(&self) -> Health {
        let tally = &self.tally;
        let health = match &tally.trouble {
            None => Health::ok(format!("{} sets of data", tally.inverted)),
            Some(trouble) => Health::warn(trouble.clone()),
        };
        health
            .with("inverted", tally.inverted)
            .with("without_solution", tally.without_solution)
            .with("missed", tally.missed)
            .with("last_step", tally.last_step.map_or("none".into(), |s| s.to_string()))
    }
}
