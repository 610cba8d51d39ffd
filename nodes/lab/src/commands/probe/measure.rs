//! One packing: its structure and stiffness, its wave speeds, and the messages that the node would publish.

use crate::commands::packings::Measure;
use grainlab_acoustic_probe::{Measured, Settings, messages};
use grainlab_acoustics::dispersion::AttenuationSettings;
use grainlab_acoustics::{AcousticsError, measure_attenuation};
use grainlab_micromechanics::analyze;
use grainlab_micromechanics::network::Springs;
use grainlab_msgs::boundary::WaveSpeedsReading;
use grainlab_recordings::import::Imported;
use grainlab_results::{AcousticReport, AttenuationReport, MeasuredPacking, Probed};

/// Settings of the measurement.
#[derive(Clone, Debug)]
pub(super) struct Probe {
    pub(super) settings: Settings,
    /// Settings of the attenuation, if it is computed.
    pub(super) attenuation: Option<AttenuationSettings>,
}

/// The result for one packing.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) probed: Probed,
    /// The messages that the node acoustic_probe would publish; `None` if no wave propagates.
    pub(super) messages: Option<Measured>,
}

impl Measure for Probe {
    type Found = Found;

    fn measure(&self, source: &str, imported: &Imported) -> Result<Found, String> {
        let packing = &imported.packing;
        let named = |e: &dyn std::fmt::Display| format!("{source}, step {}: {e}", packing.step);
        let springs = Springs::with_friction(packing.friction);
        let network = analyze(packing, &grainlab_micromechanics::Settings { springs, ..Default::default() });
        let mut measured = MeasuredPacking::new(source.to_owned(), network.map_err(|e| named(&e))?.report);
        measured.step = imported.step;
        measured.warnings.clone_from(&imported.notes);
        let found = match grainlab_acoustics::measure(packing, &self.settings.0) {
            Ok(found) => found,
            Err(AcousticsError::NotJammed(why)) => {
                measured.warnings.push(why.to_string());
                return Ok(Found { probed: Probed { packing: measured, acoustic: None }, messages: None });
            }
            Err(error) => return Err(named(&error)),
        };
        let messages = messages(&imported.header, packing, &found).map_err(|e| named(&e))?;
        let reading = WaveSpeedsReading::try_from(&messages.wave_speeds).map_err(|e| named(&e))?;
        let mut acoustic = AcousticReport::new(packing, reading);
        acoustic.modes = found.modes;
        if let Some(settings) = &self.attenuation {
            let curves = measure_attenuation(packing, &self.settings.0, settings).map_err(|e| named(&e))?;
            acoustic.attenuation = Some(AttenuationReport::new(packing, settings, curves));
        }
        let acoustic = Some(acoustic);
        Ok(Found { probed: Probed { packing: measured, acoustic }, messages: Some(messages) })
    }
}
