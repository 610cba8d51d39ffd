//! The node.

use crate::{MeasureError, Measured, Settings, measure};
use grainlab_msgs::msg::{Fabric, Moduli, Packing};
use grainlab_msgs::topics;
use node_kit::{Bus, BusError, Demand, Health, Next, Node, NodeError, Publisher, Subscription};
use std::time::Duration;

/// There is nothing to do between two packings.
const IDLE: Duration = Duration::from_secs(3600);

/// Packings that may wait while one is analysed; megabytes each.
const BACKLOG: u32 = 64;

/// The analyzer: measures every packing.
#[derive(Debug)]
pub struct FabricAnalyzer {
    settings: Settings,
    packing: Subscription<Packing>,
    fabric: Publisher<Fabric>,
    moduli: Publisher<Moduli>,
    analysed: u64,
    without_network: u64,
    failed: u64,
    last_step: Option<u64>,
    seconds: f64,
    /// What was wrong with the latest packing, if something was.
    trouble: Option<String>,
}

impl FabricAnalyzer {
    /// Takes the latest packing, where one is latched, and every one after it.
    pub fn new(bus: &mut dyn Bus, settings: Settings) -> Result<Self, BusError> {
        Ok(Self {
            settings,
            packing: Subscription::subscribe(bus, &topics::PACKING, Demand::reliable(BACKLOG))?,
            fabric: Publisher::advertise(bus, &topics::FABRIC)?,
            moduli: Publisher::advertise(bus, &topics::MODULI)?,
            analysed: 0,
            without_network: 0,
            failed: 0,
            last_step: None,
            seconds: 0.0,
            trouble: None,
        })
    }

    fn publish(&mut self, bus: &mut dyn Bus, measured: &Measured) -> Result<(), BusError> {
        let step = measured.fabric.source_step;
        self.fabric.publish(bus, &measured.fabric)?;
        self.analysed += 1;
        self.last_step = Some(step);
        self.trouble = None;
        match &measured.moduli {
            Ok(moduli) => {
                self.moduli.publish(bus, moduli)?;
                let (k, z, eps) = (moduli.k, moduli.z, moduli.eps);
                log::info!(
                    "packing of step {step}: k {k:.3}, z {z:.3}, eps {eps:.4}, p {:.4e} Pa",
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
            MeasureError::Refused(_) => bus.count_refused(self.packing.id()),
            MeasureError::Analysis { .. } | MeasureError::Result { .. } => self.failed += 1,
        }
        log::error!("{error}");
        self.trouble = Some(error.to_string());
    }
}

impl Node for FabricAnalyzer {
    /// One packing at most: an analysis takes seconds.
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        let Some((packing, _)) = self.packing.take_valid(bus)? else { return Ok(Next::Wait(IDLE)) };
        let began = bus.now();
        let measured = measure(&packing, &self.settings);
        self.seconds = bus.now().saturating_sub(began).as_secs_f64();
        match measured {
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
        Ok(Next::Again)
    }

    fn health(&self) -> Health {
        let health = match &self.trouble {
            None => Health::ok(format!("{} packings", self.analysed)),
            Some(trouble) => Health::warn(trouble.clone()),
        };
        health
            .with("analysed", self.analysed)
            .with("without_network", self.without_network)
            .with("failed", self.failed)
            .with("last_step", self.last_step.map_or("none".into(), |s| s.to_string()))
            .with("last_analysis_s", self.seconds)
    }
}
