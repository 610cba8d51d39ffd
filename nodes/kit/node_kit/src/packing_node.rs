//! The template of a node that measures packings: one packing after the other, on a worker thread.
//!
//! A node is a type that implements [`Measure`], wrapped in `PackingNode`.

use crate::bulk::BulkSubscription;
use crate::worker::Worker;
use crate::{Bus, BusError, Demand, SampleId};
use crate::{Next, Node, NodeError};
use grainlab_msgs::msg::Packing;
use grainlab_msgs::{DecodeError, Exit, Health, from_cdr, topics};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Maximum number of queued packings while one is measured; megabytes each.
const BACKLOG: u32 = 64;

/// A step that no packing has.
const UNKNOWN: u64 = u64::MAX;

/// The measurement of a node and its reports: all differences between such nodes. A value contains the
/// publishers of the results and its counters.
pub trait Measure: Sized + 'static {
    /// Settings of the measurement.
    type Settings: Send + 'static;
    /// Result of the measurement of a packing.
    type Found: Send + 'static;
    /// Why there is no result.
    type Error: std::error::Error + From<DecodeError> + Send + 'static;

    /// Texts of the diagnostics.
    const WORDS: Words;

    /// Advertises the topics of the results.
    fn advertise(bus: &mut dyn Bus) -> Result<Self, BusError>;

    /// Measures one packing, on the worker thread: a pure function.
    fn measure(packing: &Packing, settings: &Self::Settings) -> Result<Self::Found, Self::Error>;

    /// Publishes the result for the packing in the sample `about`, and counts it.
    fn publish(
        &mut self,
        bus: &mut dyn Bus,
        found: &Self::Found,
        about: SampleId,
        tally: &mut Tally,
    ) -> Result<(), BusError>;

    /// The counter for a packing without a result.
    fn decline(&mut self, error: &Self::Error) -> Declined;

    /// The counters for the diagnostics, added to `health`.
    fn values(&self, tally: &Tally, health: Health) -> Health;
}

/// Texts of the diagnostics.
#[derive(Clone, Copy, Debug)]
pub struct Words {
    /// Name of the worker thread.
    pub thread: &'static str,
    /// The activity, as in "measuring"; key of the step of the packing being measured.
    pub activity: &'static str,
    /// Key of the duration of the latest measurement.
    pub seconds: &'static str,
}

/// Why a packing has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Declined {
    /// The message is not a valid packing.
    Refused,
    /// The packing has no contact network, which is not a fault.
    NoNetwork,
    /// The measurement failed.
    Failed,
}

/// Counts of the packings so far.
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
    /// The fault of the latest packing, if any.
    pub trouble: Option<String>,
}

impl Tally {
    /// Counts the packing of `step`, which has a result.
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

    /// Counts a packing whose measurement failed in part, for this reason.
    pub fn count_failed(&mut self, reason: String) {
        self.failed += 1;
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
    /// The sample of the packing being measured: its results refer to it.
    origin: SampleId,
    /// Step of the packing being measured, once it is decoded.
    step: Arc<AtomicU64>,
    began: Duration,
    tally: Tally,
    /// Duration of the latest measurement, s, and of the present one at the latest step.
    seconds: f64,
    under_way: f64,
}

impl<M: Measure> PackingNode<M> {
    /// Receives the latest packing, if one is latched, and every one after it.
    ///
    /// # Errors
    /// If a topic is refused, or the system cannot start a thread.
    pub fn new(bus: &mut dyn Bus, settings: M::Settings) -> Result<Self, NodeError> {
        Self::measuring(bus, move |packing| M::measure(packing, &settings))
    }

    /// With another measurement instead of [`Measure::measure`].
    ///
    /// # Errors
    /// If a topic is refused, or the system cannot start a thread.
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

    fn conclude(&mut self, bus: &mut dyn Bus, outcome: Result<M::Found, M::Error>) -> Result<(), BusError> {
        self.seconds = bus.now().saturating_sub(self.began).as_secs_f64();
        match outcome {
            Ok(found) => match self.results.publish(bus, &found, self.origin, &mut self.tally) {
                // A reader that is hundreds of results behind must not stop this node.
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
    /// At most one packing: the next one waits for the worker. Results are in the order of the packings.
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
            .with_measuring(self.worker.is_busy() || self.packing.waiting() > 0)
    }

    /// Ends at once: the next process of this node measures the present packing again, with the same bytes.
    fn on_shutdown(&mut self, _: &mut dyn Bus) -> Result<Exit, NodeError> {
        let complete = !self.worker.is_busy() && self.packing.waiting() == 0;
        Ok(if complete { Exit::Done } else { Exit::Interrupted })
    }
}
