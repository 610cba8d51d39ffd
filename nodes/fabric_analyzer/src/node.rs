//! The node.

use crate::{MeasureError, Measured, Settings, measure};
use grainlab_msgs::msg::{Fabric, Moduli, Packing};
use grainlab_msgs::{from_cdr, topics};
use grainlab_node_kit::{
    BulkSubscription, Bus, BusError, Demand, Exit, Health, Next, Node, NodeError, Publisher, SampleId, Worker,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Packings that may wait while one is analysed; megabytes each.
const BACKLOG: u32 = 64;

/// No step that a packing has.
const UNKNOWN: u64 = u64::MAX;

type Outcome = Result<Measured, MeasureError>;

/// The analyzer: measures every packing, one after the other, on a thread of its own.
#[derive(Debug)]
pub struct FabricAnalyzer {
    packing: BulkSubscription,
    fabric: Publisher<Fabric>,
    moduli: Publisher<Moduli>,
    worker: Worker<Vec<u8>, Outcome>,
    /// The sample of the packing that is analysed: what its results are about.
    origin: SampleId,
    /// Step of the packing that is analysed, as soon as it is decoded.
    step: Arc<AtomicU64>,
    began: Duration,
    analysed: u64,
    without_network: u64,
    failed: u64,
    last_step: Option<u64>,
    /// Of the latest analysis; of the one under way at the latest look.
    seconds: f64,
    under_way: f64,
    /// What was wrong with the latest packing, if something was.
    trouble: Option<String>,
}

impl FabricAnalyzer {
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
            fabric: Publisher::advertise(bus, &topics::FABRIC)?,
            moduli: Publisher::advertise(bus, &topics::MODULI)?,
            worker: Worker::new(bus, "analysis", work).map_err(failed)?,
            origin: SampleId::default(),
            step,
            began: Duration::ZERO,
            analysed: 0,
            without_network: 0,
            failed: 0,
            last_step: None,
            seconds: 0.0,
            under_way: 0.0,
            trouble: None,
        })
    }

    fn publish(&mut self, bus: &mut dyn Bus, measured: &Measured) -> Result<(), BusError> {
        let step = measured.fabric.source_step;
        self.fabric.publish_about(bus, &measured.fabric, self.origin)?;
        self.analysed += 1;
        self.last_step = Some(step);
        self.trouble = None;
        match &measured.moduli {
            Ok(moduli) => {
                self.moduli.publish_about(bus, moduli, self.origin)?;
                let fabric = &measured.fabric;
                let (k, z) = (fabric.contacts.coordination, fabric.contacts.mechanical_coordination);
                log::info!(
                    "packing of step {step}: k {k:.3}, z {z:.3}, eps {:.4}, p {:.4e} Pa",
                    fabric.contact_anisotropy,
                    moduli.pressure
                );
            }
            Err(none) => {
                self.without_network += 1;
                log::warn!("packing of step {step} has a fabric and no moduli: {none}");
                self.trouble = Some(none.to_string());
            }
        }
        Ok(())
    }

    fn refuse(&mut self, bus: &mut dyn Bus, error: &MeasureError) {
        match error {
            MeasureError::Undecodable(_) | MeasureError::Refused(_) => bus.count_refused(self.packing.id()),
            MeasureError::Analysis { .. } | MeasureError::Result { .. } => self.failed += 1,
        }
        log::error!("{error}");
        self.trouble = Some(error.to_string());
    }

    /// Publishes a result.
    fn conclude(&mut self, bus: &mut dyn Bus, outcome: Outcome) -> Result<(), BusError> {
        self.seconds = bus.now().saturating_sub(self.began).as_secs_f64();
        match outcome {
            Ok(measured) => match self.publish(bus, &measured) {
                // A reader is hundreds of results behind: it is as good as dead, and this node is not.
                Err(full @ BusError::Full { .. }) => {
                    log::error!("{full}");
                    self.trouble = Some(full.to_string());
                }
                published => published?,
            },
            Err(error) => self.refuse(bus, &error),
        }
        Ok(())
    }
}

impl Node for FabricAnalyzer {
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
        let health = match (&self.trouble, step) {
            (Some(trouble), _) => Health::warn(trouble.clone()),
            (None, Some(step)) => Health::ok(format!("analysing the packing of step {step}")),
            (None, None) => Health::ok(format!("{} packings", self.analysed)),
        };
        health
            .with("analysed", self.analysed)
            .with("without_network", self.without_network)
            .with("failed", self.failed)
            .with("last_step", self.last_step.map_or("none".into(), |s| s.to_string()))
            .with("last_analysis_s", self.seconds)
            .with("analysing", step.map_or("none".into(), |s| s.to_string()))
            .with("analysing_s", if self.worker.is_busy() { self.under_way } else { 0.0 })
            .with("waiting", self.packing.waiting())
    }

    /// Leaves at once: what is being analysed is analysed again, with the same bytes, by whoever starts next.
    fn on_shutdown(&mut self, _: &mut dyn Bus) -> Result<Exit, NodeError> {
        let complete = !self.worker.is_busy() && self.packing.waiting() == 0;
        Ok(if complete { Exit::Done } else { Exit::Interrupted })
    }
}
