//! One packing: its structure and stiffness, its wave speeds, and the messages that the node would publish.

use crate::commands::packings::bar::Bar;
use crate::commands::packings::{self, Measure};
use crate::tape::Tape;
use grainlab_acoustic_probe::{Measured, Settings, messages};
use grainlab_acoustics::AcousticsError;
use grainlab_console::Failure;
use grainlab_core::Vec3;
use grainlab_micromechanics::analyze;
use grainlab_msgs::boundary::WaveSpeedsReading;
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use grainlab_recordings::import::Imported;
use grainlab_results::{AcousticReport, MeasuredPacking, Probed, state_warnings};

/// Settings of the measurement.
#[derive(Clone, Debug)]
pub(super) struct Probe {
    pub(super) settings: Settings,
}

/// The result for one packing.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) probed: Probed,
    /// The messages that the node acoustic_probe would publish; `None` if no wave propagates.
    pub(super) messages: Option<Measured>,
}

impl packings::Found for Found {
    type Shown = Probed;

    fn shown(&self) -> &Probed {
        &self.probed
    }

    fn is_without(&self) -> bool {
        self.messages.is_none()
    }

    fn record(&self, tape: &mut Tape, _: &Bar) -> Result<Exit, Failure> {
        let Some(messages) = &self.messages else { return Ok(Exit::Done) };
        for waveform in &messages.waveforms {
            tape.put(&topics::WAVEFORM, &waveform.header, waveform)?;
        }
        let speeds = &messages.wave_speeds;
        tape.put(&topics::WAVE_SPEEDS, &speeds.header, speeds)?;
        Ok(Exit::Done)
    }
}

impl Measure for Probe {
    type Found = Found;

    fn measure(&self, source: &str, imported: &Imported) -> Result<Found, String> {
        let packing = &imported.packing;
        let named = |e: &dyn std::fmt::Display| format!("{source}, step {}: {e}", packing.step);
        let measured = |axis: Vec3| {
            let settings = grainlab_micromechanics::Settings { axis, ..Default::default() };
            let report = analyze(packing, &settings).map_err(|e| named(&e))?.report;
            let mut measured = MeasuredPacking::new(source.to_owned(), report);
            measured.step = imported.step;
            measured.warnings.clone_from(&imported.notes);
            measured.warnings.extend(state_warnings(packing, &measured.report, None, &imported.notes));
            Ok::<_, String>(measured)
        };
        let found = match grainlab_acoustics::measure(packing, &self.settings.0) {
            Ok(found) => found,
            Err(AcousticsError::NotJammed(why)) => {
                let mut measured = measured(self.settings.0.axis.unwrap_or_else(Vec3::z))?;
                measured.warnings.push(why.to_string());
                return Ok(Found { probed: Probed { packing: measured, acoustic: None }, messages: None });
            }
            Err(error) => return Err(named(&error)),
        };
        let messages = messages(&imported.header, packing, &found).map_err(|e| named(&e))?;
        let reading = WaveSpeedsReading::try_from(&messages.wave_speeds).map_err(|e| named(&e))?;
        let density = packing.solid_fraction() * packing.material.density;
        let mut acoustic = AcousticReport::new(packing.grains() as u32, density, reading);
        acoustic.modes = found.modes;
        // The axis of the rays, or the one inferred from the speeds.
        let measured = measured(acoustic.medium.axis)?;
        let acoustic = Some(acoustic);
        Ok(Found { probed: Probed { packing: measured, acoustic }, messages: Some(messages) })
    }
}
