//! The node.

use crate::{MeasureError, Measured, Settings, measure};
use grainlab_msgs::msg::{Packing, WaveSpeeds, Waveform};
use grainlab_msgs::{from_cdr, topics};
use grainlab_node_kit::{
    BulkSubscription, Bus, BusError, Demand, Exit, Health, Next, Node, NodeError, Publisher, SampleId, Worker,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Packings that may wait while one is measured; megabytes each.
const BACKLOG: u32 = 64;

/// No step that a packing has.
const UNKNOWN: u64 = u64::MAX;

/// Key of the diagnostics under which the step of the last packing without wave speeds stands.
pub const DECLINED_STEP: &str = "declined_step";

/// Key of the diagnostics under which the step of the packing that is being measured stands.
pub const MEASURING: &str = "measuring";

type Outcome = Result<Measured, MeasureError>;

/// The probe: measures every packing, one after the other, on a thread of its own.
#[derive(Debug)]
pub struct AcousticProbe {
    packing: BulkSubscription,
    wave_speeds: Publisher<WaveSpeeds>,
    waveform: Publisher<Waveform>,
    worker: Worker<Vec<u8>, Outcome>,
    /// The sample of the packing that is measured: what its results are about.
    origin: SampleId,
    /// Step of the packing that is measured, as soon as it is decoded.
    step: Arc<AtomicU64>,
    began: Duration,
    tally: Tally,
    /// Of the latest measurement; of the one under way at the latest look.
    seconds: f64,
    under_way: f64,
    /// What was wrong with the latest packing, if something was.
    trouble: Option<String>,
}

/// What became of the packings so far.
#[derive(Debug, Default)]
struct Tally {
    measured: u64,
    speeds: u64,
    warnings: u64,
    without_network: u64,
    failed: u64,
    last_step: Option<u64>,
    declined_step: Option<u64>,
}

impl AcousticProbe {
    /// Takes the latest packing, where one is latched, and every one after it.
    pub fn new(bus: &mut dyn Bus, settings: Settings) -> Result<Self, NodeError> {
        Self::measuring(bus, move |packing| measure(packing, &settings))
    }

    /// With another measurement than [`measure`].
    pub fn measuring<F>(bus: &mut dyn Bus, measure: F) -> Result<Self, NodeError>
    where
        F: Fn(&Packing) -> Outcome + Send + 'static,
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
            wave_speeds: Publisher::advertise(bus, &topics::WAVE_SPEEDS)?,
            waveform: Publisher::advertise(bus, &topics::WAVEFORM)?,
            worker: Worker::new(bus, "measurement", work).map_err(failed)?,
            origin: SampleId::default(),
            step,
            began: Duration::ZERO,
            tally: Tally::default(),
            seconds: 0.0,
            under_way: 0.0,
            trouble: None,
        })
    }

    /// The traces first: who has the speeds has what they stand on.
    fn publish(&mut self, bus: &mut dyn Bus, found: &Measured) -> Result<(), BusError> {
        for waveform in &found.waveforms {
            self.waveform.publish_about(bus, waveform, self.origin)?;
        }
        self.wave_speeds.publish_about(bus, &found.wave_speeds, self.origin)?;
        let WaveSpeeds { source_step: step, speeds, warnings, density, .. } = &found.wave_speeds;
        let tally = &mut self.tally;
        tally.measured += 1;
        tally.speeds += speeds.len() as u64;
        tally.warnings += warnings.len() as u64;
        tally.last_step = Some(*step);
        self.trouble = None;
        log::info!("packing of step {step}: {} wave speeds, density {density:.1} kg/m3", speeds.len());
        for warning in warnings {
            log::warn!("packing of step {step}: {warning}");
        }
        Ok(())
    }

    fn decline(&mut self, bus: &mut dyn Bus, error: &MeasureError) {
        match error {
            MeasureError::Undecodable(_) | MeasureError::Refused(_) => bus.count_refused(self.packing.id()),
            MeasureError::NotJammed { .. } => self.tally.without_network += 1,
            MeasureError::Acoustics { .. } | MeasureError::Result { .. } => self.tally.failed += 1,
        }
        match error {
            MeasureError::NotJammed { .. } => log::warn!("{error}"),
            _ => log::error!("{error}"),
        }
        self.tally.declined_step = error.step().or(self.tally.declined_step);
        self.trouble = Some(error.to_string());
    }

    /// Publishes a result.
    fn conclude(&mut self, bus: &mut dyn Bus, outcome: Outcome) -> Result<(), BusError> {
        self.seconds = bus.now().saturating_sub(self.began).as_secs_f64();
        match outcome {
            Ok(found) => match self.publish(bus, &found) {
                // A reader is hundreds of results behind: it is as good as dead, and this node is not.
                Err(full @ BusError::Full { .. }) => {
                    log::error!("{full}");
                    self.trouble = Some(full.to_string());
                }
                published => published?,
            },
            Err(error) => self.decline(bus, &error),
        }
        Ok(())
    }
}

impl Node for AcousticProbe {
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
        let step = Some(self.step.load(Ordering::Relaxed)).filter(|s| self.worker.is_busy() && *s != UNKNOWN);
        let t = &self.tally;
        let health = match (&self.trouble, step) {
            (Some(trouble), _) => Health::warn(trouble.clone()),
            (None, Some(step)) => Health::ok(format!("measuring the packing of step {step}")),
            (None, None) => Health::ok(format!("{} packings", t.measured)),
        };
        let or_none = |step: Option<u64>| step.map_or("none".into(), |s| s.to_string());
        health
            .with("measured", t.measured)
            .with("speeds", t.speeds)
            .with("warnings", t.warnings)
            .with("without_network", t.without_network)
            .with("failed", t.failed)
            .with("last_step", or_none(t.last_step))
            .with(DECLINED_STEP, or_none(t.declined_step))
            .with("last_measurement_s", self.seconds)
            .with(MEASURING, or_none(step))
            .with("measuring_s", if self.worker.is_busy() { self.under_way } else { 0.0 })
            .with("waiting", self.packing.waiting())
    }

    /// Leaves at once: what is being measured is measured again, with the same bytes, by whoever starts next.
    fn on_shutdown(&mut self, _: &mut dyn Bus) -> Result<Exit, NodeError> {
        let complete = !self.worker.is_busy() && self.packing.waiting() == 0;
        Ok(if complete { Exit::Done } else { Exit::Interrupted })
    }
}
