//! The node.

use crate::{Settings, microstructure_message};
use grainlab_msgs::msg::{Estimate, Microstructure, Moduli};
use grainlab_msgs::topics;
use node_kit::{Bus, BusError, Demand, Health, Next, Node, NodeError, Publisher, Subscription};
use std::time::Duration;

/// There is nothing to do between two sets of moduli.
const IDLE: Duration = Duration::from_secs(3600);

/// Moduli that may wait.
const BACKLOG: u32 = 64;

/// The inversion: every model's word on every set of moduli.
#[derive(Debug)]
pub struct EmtInversion {
    settings: Settings,
    moduli: Subscription<Moduli>,
    microstructure: Publisher<Microstructure>,
    inverted: u64,
    without_solution: u64,
    last_step: Option<u64>,
    /// What was wrong with the latest moduli, if something was.
    trouble: Option<String>,
}

impl EmtInversion {
    /// Takes the latest moduli, where some are latched, and all after them.
    pub fn new(bus: &mut dyn Bus, settings: Settings) -> Result<Self, BusError> {
        Ok(Self {
            settings,
            moduli: Subscription::subscribe(bus, &topics::MODULI, Demand::reliable(BACKLOG))?,
            microstructure: Publisher::advertise(bus, &topics::MICROSTRUCTURE)?,
            inverted: 0,
            without_solution: 0,
            last_step: None,
            trouble: None,
        })
    }

    fn publish(&mut self, bus: &mut dyn Bus, message: &Microstructure) -> Result<(), BusError> {
        self.microstructure.publish(bus, message)?;
        self.inverted += 1;
        self.last_step = Some(message.source_step);
        self.trouble = None;
        let solved = |e: &&Estimate| matches!(e.status, Estimate::STATUS_OK | Estimate::STATUS_EXTRAPOLATED);
        for unsolved in message.estimates.iter().filter(|e| !solved(e)) {
            self.without_solution += 1;
            let reason = unsolved.warnings.join("; ");
            let trouble = format!("step {}, model {}: {reason}", message.source_step, unsolved.model);
            log::warn!("no estimate at {trouble}");
            self.trouble = Some(trouble);
        }
        Ok(())
    }
}

impl Node for EmtInversion {
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        while let Some((moduli, _)) = self.moduli.take_valid(bus)? {
            match microstructure_message(&moduli, &self.settings) {
                Ok(message) => match self.publish(bus, &message) {
                    // A reader is hundreds of results behind: it is as good as dead, and this node is not.
                    Err(full @ BusError::Full { .. }) => {
                        log::error!("{full}");
                        self.trouble = Some(full.to_string());
                    }
                    published => published?,
                },
                Err(error) => {
                    bus.count_refused(self.moduli.id());
                    log::error!("{error}");
                    self.trouble = Some(error.to_string());
                }
            }
        }
        Ok(Next::Wait(IDLE))
    }

    fn health(&self) -> Health {
        let health = match &self.trouble {
            None => Health::ok(format!("{} sets of moduli", self.inverted)),
            Some(trouble) => Health::warn(trouble.clone()),
        };
        health
            .with("inverted", self.inverted)
            .with("without_solution", self.without_solution)
            .with("last_step", self.last_step.map_or("none".into(), |s| s.to_string()))
    }
}
