//! The node.

use crate::{MeasureError, Measured, Settings, measure};
use grainlab_msgs::msg::{Fabric, Moduli, Packing};
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Bus, BusError, Declined, Health, Measure, PackingNode, Publisher, SampleId, Tally, Words, step_or_none,
};

/// Key of the diagnostics with the step of the last packing that was measured and has no moduli.
pub const WITHOUT_MODULI: &str = "step_without_moduli";

/// The analyzer: measures every packing, one after the other, on a worker thread.
pub type FabricAnalyzer = PackingNode<Analysis>;

/// The publishers.
#[derive(Debug)]
pub struct Analysis {
    fabric: Publisher<Fabric>,
    moduli: Publisher<Moduli>,
    without_moduli: Option<u64>,
}

impl Measure for Analysis {
    type Settings = Settings;
    type Found = Measured;
    type Error = MeasureError;

    const WORDS: Words = Words { thread: "analysis", activity: "analysing", seconds: "last_analysis_s" };

    fn advertise(bus: &mut dyn Bus) -> Result<Self, BusError> {
        Ok(Self {
            fabric: Publisher::advertise(bus, &topics::FABRIC)?,
            moduli: Publisher::advertise(bus, &topics::MODULI)?,
            without_moduli: None,
        })
    }

    fn measure(packing: &Packing, settings: &Settings) -> Result<Measured, MeasureError> {
        measure(packing, settings)
    }

    fn publish(
        &mut self,
        bus: &mut dyn Bus,
        measured: &Measured,
        about: SampleId,
        tally: &mut Tally,
    ) -> Result<(), BusError> {
        let step = measured.fabric.source_step;
        self.fabric.publish_about(bus, &measured.fabric, about)?;
        tally.count(step);
        match &measured.moduli {
            Ok(moduli) => {
                self.moduli.publish_about(bus, moduli, about)?;
                for note in &measured.notes {
                    log::warn!("packing of step {step}: {note}");
                }
                let fabric = &measured.fabric;
                let (k, z) = (fabric.contacts.coordination, fabric.contacts.mechanical_coordination);
                log::info!(
                    "packing of step {step}: k {k:.3}, z {z:.3}, eps {:.4}, p {:.4e} Pa",
                    fabric.contact_anisotropy,
                    moduli.pressure
                );
            }
            Err(none) => {
                log::warn!("packing of step {step} has a fabric but no moduli: {none}");
                tally.count_without_network(none.to_string());
                self.without_moduli = Some(step);
            }
        }
        Ok(())
    }

    fn decline(&mut self, error: &MeasureError) -> Declined {
        match error {
            MeasureError::Undecodable(_) | MeasureError::Refused(_) => Declined::Refused,
            MeasureError::Analysis { .. } | MeasureError::Result { .. } => Declined::Failed,
        }
    }

    fn values(&self, tally: &Tally, health: Health) -> Health {
        health
            .with("analysed", tally.measured)
            .with("without_network", tally.without_network)
            .with(WITHOUT_MODULI, step_or_none(self.without_moduli))
            .with("failed", tally.failed)
            .with("last_step", step_or_none(tally.last_step))
    }
}
