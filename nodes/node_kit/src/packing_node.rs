//! The template of a node that turns packings into results: one packing after the other, on a thread of its own.
//!
//! A node is a type that implements [`Measure`], and `PackingNode` of it.

use crate::bulk::BulkSubscription;
use crate::exit::Exit;
use crate::worker::Worker;
use crate::{Bus, BusError, Demand, SampleId};
use crate::{Health, Next, Node, NodeError};
use grainlab_msgs::msg::Packing;
use grainlab_msgs::{DecodeError, from_cdr, topics};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Packings that may wait while one is measured; megabytes each.
const BACKLOG: u32 = 64;

/// No step that a packing has.
const UNKNOWN: u64 = u64::MAX;

/// What a node measures of a packing, and what it reports: all that differs between such nodes. A value has the publishers
/// of the results and the counts of its own.
pub trait Measure: Sized + 'static {
    /// How packings are measured.
    type Settings: Send + 'static;
    /// What is found of a packing.
    type Found: Send + 'static;
    /// Why nothing is found of a packing.
    type Error: std::error::Error + From<DecodeError> + Send + 'static;

    /// Words of the diagnostics.
    const WORDS: Words;

    /// Advertises the topics of the results.
    fn advertise(bus: &mut dyn Bus) -> Result<Self, BusError>;

    /// Measures one packing, on the thread of the worker: a pure function.
    fn measure(packing: &Packing, settings: &Self::Settings) -> Result<Self::Found, Self::Error>;

    /// Publishes what was found of the packing that is the sample `about`, and counts it.
    fn publish(
        &mut self,
        bus: &mut dyn Bus,
        found: &Self::Found,
        about: SampleId,
        tally: &mut Tally,
    ) -> Result<(), BusError>;

    /// How it is counted that a packing has no result.
    fn decline(&mut self, error: &Self::Error) -> Declined;

    /// The counts for the diagnostics, added to `health`.
    fn values(&self, tally: &Tally, health: Health) -> Health;
}

/// Words of the diagnostics.
#[derive(Clone, Copy, Debug)]
pub struct Words {
    /// Name of the worker's thread.
    pub thread: &'static str,
    /// What is done with a packing, as in "measuring"; key of the step of the packing that is being measured.
    pub activity: &'static str,
    /// Key of the duration of the latest measurement.
    pub seconds: &'static str,
}

/// Why a packing has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Declined {
    /// The message is not a packing.
    Refused,
    /// The packing has no contact network, which is no fault.
    NoNetwork,
    /// The measurement failed.
    Failed,
}

/// What became of the packings so far.
#[derive(Debug, Default)]
pub struct Tally {
    /// Packings with a result.
    pub measured: u64,
    /// Packings without a contact network.
    pub without_network: u64,
    /// Packings whose measurement failed.
    pub failed: u64,
    /// Step of the last packing with a result.
    pub last_step: Option<u64>,
    /// What was wrong with the latest packing, if something was.
    pub trouble: Option<String>,
}

impl Tally {
    /// Counts the packing of `step`, of which there is a result.
    pub fn count(&mut self, step: u64) {
        self.measured += 1;
        self.last_step = Some(step);
        self.trouble = None;
    }

    /// Counts a packing without a contact network, for this reason.
    pub fn count_without_network(&mut self, reason: String) {
        self.without_network += 1;
        self.trouble = Some(reason);
    }
}

/// A step as a value of the diagnostics.
pub fn step_or_none(step: Option<u64>) -> String {
    step.map_or_else(|| "none".into(), |s| s.to_string())
}

/// The node: measures every packing, in their order.
#[derive(Debug)]
pub struct PackingNode<M: Measure> {
    packing: BulkSubscription,
    results: M,
    worker: Worker<Vec<u8>, Result<M::Found, M::Error>>,
    /// The sample of the packing that is measured: what its results are about.
    origin: SampleId,
    /// Step of the packing that is measured, as soon as it is decoded.
    step: Arc<AtomicU64>,
    began: Duration,
    tally: Tally,
    /// Duration of the latest measurement, s, and of the one under way at the latest step.
    seconds: f64,
    under_way: f64,
}

impl<M: Measure> PackingNode<M> {
    /// Takes the latest packing, where one is latched, and every one after it.
    ///
    /// # Errors
    /// If a topic is refused, or the system has no thread left.
    pub fn new(bus: &mut dyn Bus, settings: M::Settings) -> Result<Self, NodeError> {
        Self::measuring(bus, move |packing| M::measure(packing, &settings))
    }

    /// With another measurement than [`Measure::measure`].
    ///
    /// # Errors
    /// If a topic is refused, or the system has no thread left.
    pub fn measuring<F>(bus: &mut dyn Bus, measure: F) -> Result<Self, NodeError>
    where
        F: Fn(&Packing) -> Result<M::Found, M::Error> + Send + 'static,
    {
        let step = Arc::new(AtomicU64::new(UNKNOWN));
        let shown = Arc::clone(&step);
        let work = move |body: Vec<u8>| {
            let packing: Packing = from_cdr(&body)?;
            shown.store(packing.step, Ordering::Relaxed);
            measure(&packing)
        };
        let failed = |e: std::io::Error| NodeError::new(Exit::Failure, format!("thread: {e}"));
        Ok(Self {
            packing: BulkSubscription::subscribe(bus, &topics::PACKING, Demand::reliable(BACKLOG))?,
            results: M::advertise(bus)?,
            worker: Worker::new(bus, M::WORDS.thread, work).map_err(failed)?,
            origin: SampleId::default(),
            step,
            began: Duration::ZERO,
            tally: Tally::default(),
            seconds: 0.0,
            under_way: 0.0,
        })
    }

    /// Publishes a result.
    fn conclude(&mut self, bus: &mut dyn Bus, outcome: Result<M::Found, M::Error>) -> Result<(), BusError> {
        self.seconds = bus.now().saturating_sub(self.began).as_secs_f64();
        match outcome {
            Ok(found) => match self.results.publish(bus, &found, self.origin, &mut self.tally) {
                // A reader that is hundreds of results behind must not end this node.
                Err(full @ BusError::Full { .. }) => {
                    log::error!("{full}");
                    self.tally.trouble = Some(full.to_string());
                }
                published => published?,
            },
            Err(error) => self.decline(bus, &error),
        }
        Ok(())
    }

    fn decline(&mut self, bus: &mut dyn Bus, error: &M::Error) {
        let declined = self.results.decline(error);
        match declined {
            Declined::Refused => bus.count_refused(self.packing.id()),
            Declined::NoNetwork => self.tally.without_network += 1,
            Declined::Failed => self.tally.failed += 1,
        }
        match declined {
            Declined::NoNetwork => log::warn!("{error}"),
            Declined::Refused | Declined::Failed => log::error!("{error}"),
        }
        self.tally.trouble = Some(error.to_string());
    }
}

impl<M: Measure> Node for PackingNode<M> {
    /// One packing at most: the next one waits for the worker. Results come in the order of the packings.
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        self.packing.advance(bus)?;
        if !self.worker.is_busy()
            && let Some(sample) = self.packing.take(bus)?
        {
            self.step.store(UNKNOWN, Ordering::Relaxed);
            self.began = bus.now();
            self.origin = sample.info.origin();
            self.worker.give(sample.body);
        }
        let now = bus.now();
        self.under_way = now.saturating_sub(self.began).as_secs_f64();
        let Some(outcome) = self.worker.result() else {
            return Ok(Next::Wait(self.packing.patience(now)));
        };
        self.conclude(bus, outcome)?;
        Ok(Next::Again)
    }

    fn health(&self) -> Health {
        let Words { activity, seconds, .. } = M::WORDS;
        let step = Some(self.step.load(Ordering::Relaxed)).filter(|s| self.worker.is_busy() && *s != UNKNOWN);
        let health = match (&self.tally.trouble, step) {
            (Some(trouble), _) => Health::warn(trouble.clone()),
            (None, Some(step)) => Health::ok(format!("{activity} the packing of step {step}")),
            (None, None) => Health::ok(format!("{} packings", self.tally.measured)),
        };
        self.results
            .values(&self.tally, health)
            .with(seconds, self.seconds)
            .with(activity, step_or_none(step))
            .with(format!("{activity}_s"), if self.worker.is_busy() { self.under_way } else { 0.0 })
            .with("waiting", self.packing.waiting())
    }

    /// Leaves at once: what is being measured is measured again, with the same bytes, by the next process of this node.
    fn on_shutdown(&mut self, _: &mut dyn Bus) -> Result<Exit, NodeError> {
        let complete = !self.worker.is_busy() && self.packing.waiting() == 0;
        Ok(if complete { Exit::Done } else { Exit::Interrupted })
    }
}
