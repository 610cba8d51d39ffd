//! The analyzer as a node.

use crate::{MeasureError, Measured, Settings, measure};
use grainlab_msgs::msg::{Packing, PackingReport};
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Bus, BusError, Declined, Health, Measure, PackingNode, Publisher, SampleId, Tally, Words, step_or_none,
};

/// The analyzer: measures every packing, one after the other, on a worker thread.
pub type FabricAnalyzer = PackingNode<Analysis>;

/// Publisher of the reports.
#[derive(Debug)]
pub struct Analysis(Publisher<PackingReport>);

impl Measure for Analysis {
    type Settings = Settings;
    type Found = Measured;
    type Error = MeasureError;

    const WORDS: Words = Words { thread: "analysis", activity: "analysing", seconds: "last_analysis_s" };

    fn advertise(bus: &mut dyn Bus) -> Result<Self, BusError> {
        Ok(Self(Publisher::advertise(bus, &topics::PACKING_REPORT)?))
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
        let report = &measured.report;
        let step = report.step;
        self.0.publish_about(bus, &measured.message, about)?;
        tally.count(step);
        match report.elasticity.as_ref().err() {
            None => {
                for note in report.spring_notes() {
                    log::warn!("packing of step {step}: {note}");
                }
                let (k, z) = (report.contacts.coordination, report.contacts.mechanical_coordination);
                log::info!(
                    "packing of step {step}: k {k:.3}, z {z:.3}, eps {:.4}, p {:.4e} Pa",
                    report.fabric.contact_anisotropy,
                    report.pressure()
                );
            }
            Some(none) => {
                let why = measured.why_no_stiffness.clone().unwrap_or_else(|| none.to_string());
                if none.is_fault() {
                    log::error!("packing of step {step} has no stiffness: {why}");
                    tally.count_failed(why);
                } else {
                    log::warn!("packing of step {step} has no stiffness: {why}");
                    tally.count_without_network(why);
                }
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
            .with("failed", tally.failed)
            .with("last_step", step_or_none(tally.last_step))
    }
}
