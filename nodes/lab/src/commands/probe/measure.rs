//! One packing: its structure and stiffness, its wave speeds, and the messages that the node would publish.

use crate::commands::packings::Measure;
use crate::results::acoustic::AcousticView;
use crate::results::probed::Probed;
use crate::results::state::State;
use grainlab_acoustic_probe::{Measured, Settings, messages};
use grainlab_acoustics::AcousticsError;
use grainlab_msgs::boundary::WaveSpeedsReading;
use grainlab_recordings::import::Imported;

/// How packings are measured.
#[derive(Clone, Debug)]
pub(super) struct Probe {
    pub(super) settings: Settings,
}

/// What was found of one packing.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) probed: Probed,
    /// As the node acoustic_probe would publish it; `None` where nothing carries a wave.
    pub(super) messages: Option<Measured>,
}

impl Measure for Probe {
    type Found = Found;

    fn measure(&self, source: &str, imported: &Imported) -> Result<Found, String> {
        let packing = &imported.packing;
        let named = |e: &dyn std::fmt::Display| format!("{source}, step {}: {e}", packing.step);
        let network = grainlab_micromechanics::analyse(
            packing,
            &grainlab_micromechanics::Settings { tangential: packing.friction > 0.0, ..Default::default() },
        )
        .map_err(|e| named(&e))?;
        let moduli = network.moduli.as_ref().ok();
        let mut state = State::new(source.to_owned(), packing, &network.fabric, moduli);
        state.step = imported.step;
        state.warnings.clone_from(&imported.notes);
        let found = match grainlab_acoustics::measure(packing, &self.settings.0) {
            Ok(found) => found,
            Err(AcousticsError::NoNetwork(none)) => {
                state.warnings.push(none.to_string());
                return Ok(Found { probed: Probed { state, acoustic: None }, messages: None });
            }
            Err(error) => return Err(named(&error)),
        };
        let messages = messages(&imported.header, packing, &found).map_err(|e| named(&e))?;
        let reading = WaveSpeedsReading::try_from(&messages.wave_speeds).map_err(|e| named(&e))?;
        let acoustic = Some(AcousticView::new(packing, &reading));
        Ok(Found { probed: Probed { state, acoustic }, messages: Some(messages) })
    }
}
