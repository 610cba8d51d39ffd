//! The node of the probe.

use crate::{MeasureError, Measured, Settings, measure};
use grainlab_msgs::msg::{Packing, WaveSpeeds, Waveform};
use grainlab_msgs::topics;
use grainlab_node_kit::{
    Bus, BusError, Declined, Health, Measure, PackingNode, Publisher, SampleId, Tally, Words, step_or_none,
};

/// The probe: measures every packing, one after the other, on a worker thread.
pub type AcousticProbe = PackingNode<Probe>;

/// Publishers and counts of the probe.
#[derive(Debug)]
pub struct Probe {
    wave_speeds: Publisher<WaveSpeeds>,
    waveform: Publisher<Waveform>,
    speeds: u64,
    warnings: u64,
}

impl Measure for Probe {
    type Settings = Settings;
    type Found = Measured;
    type Error = MeasureError;

    const WORDS: Words =
        Words { thread: "measurement", activity: "measuring", seconds: "last_measurement_s" };

    fn advertise(bus: &mut dyn Bus) -> Result<Self, BusError> {
        Ok(Self {
            wave_speeds: Publisher::advertise(bus, &topics::WAVE_SPEEDS)?,
            waveform: Publisher::advertise(bus, &topics::WAVEFORM)?,
            speeds: 0,
            warnings: 0,
        })
    }

    fn measure(packing: &Packing, settings: &Settings) -> Result<Measured, MeasureError> {
        measure(packing, settings)
    }

    /// The traces first, so that a reader that has the speeds also has the traces.
    fn publish(
        &mut self,
        bus: &mut dyn Bus,
        found: &Measured,
        about: SampleId,
        tally: &mut Tally,
    ) -> Result<(), BusError> {
        for waveform in &found.waveforms {
            self.waveform.publish_about(bus, waveform, about)?;
        }
        self.wave_speeds.publish_about(bus, &found.wave_speeds, about)?;
        if let Some(why) = &found.declined {
            match self.decline(why) {
                Declined::NoNetwork => tally.count_without_network(why.to_string()),
                Declined::Refused | Declined::Failed => tally.count_failed(why.to_string()),
            }
            log::warn!("{why}");
            return Ok(());
        }
        let WaveSpeeds { source_step: step, speeds, warnings, density, .. } = &found.wave_speeds;
        tally.count(*step);
        self.speeds += speeds.len() as u64;
        self.warnings += warnings.len() as u64;
        log::info!("packing of step {step}: {} wave speeds, density {density:.1} kg/m3", speeds.len());
        for warning in warnings {
            log::warn!("packing of step {step}: {warning}");
        }
        Ok(())
    }

    fn decline(&mut self, error: &MeasureError) -> Declined {
        match error {
            MeasureError::Undecodable(_) | MeasureError::Refused(_) => Declined::Refused,
            MeasureError::NoStiffness { .. } => Declined::NoNetwork,
            MeasureError::Acoustics { .. } | MeasureError::Result { .. } => Declined::Failed,
        }
    }

    fn values(&self, tally: &Tally, health: Health) -> Health {
        health
            .with("measured", tally.measured)
            .with("speeds", self.speeds)
            .with("warnings", self.warnings)
            .with("without_network", tally.without_network)
            .with("failed", tally.failed)
            .with("last_step", step_or_none(tally.last_step))
    }
}
