//! One packing: its structure and stiffness, its wave speeds, and the messages that the node would publish.

use crate::commands::packings::Found;
use crate::offline_recording::Recorded;
use grainlab_acoustic_probe::{Settings, messages};
use grainlab_acoustics::AcousticsError;
use grainlab_core::Vec3;
use grainlab_core::notes::Note;
use grainlab_micromechanics::analyze;
use grainlab_msgs::boundary::WaveSpeedsReading;
use grainlab_msgs::topics;
use grainlab_recordings::import::Imported;
use grainlab_results::{AcousticReport, MeasuredPacking, Probed};

/// Measures one packing of `source`; the error names both.
pub(crate) fn measure(
    settings: &Settings,
    source: &str,
    imported: &Imported,
) -> Result<Found<Probed>, String> {
    let packing = &imported.packing;
    let named = |e: &dyn std::fmt::Display| format!("{source}, step {}: {e}", packing.step);
    let measured = |axis: Vec3| {
        let settings = grainlab_micromechanics::Settings { axis, ..Default::default() };
        let found = analyze(packing, &settings).map_err(|e| named(&e))?;
        let why_none = found.why_no_stiffness();
        let mut measured =
            MeasuredPacking::new(source.to_owned(), found.report).doubted(packing, &imported.notes);
        measured.step = imported.step;
        measured.notes.extend(why_none.map(Note::remark));
        Ok::<_, String>(measured)
    };
    let found = match grainlab_acoustics::measure(packing, &settings.0) {
        Ok(found) => found,
        Err(error @ AcousticsError::Setting { .. }) => return Err(named(&error)),
        // Structure and stress are known all the same.
        Err(why) => {
            let mut packing = measured(settings.0.axis.unwrap_or_else(Vec3::z))?;
            let is_fault = !matches!(&why, AcousticsError::NoStiffness(why) if !why.is_fault());
            if packing.report.elasticity.as_ref().err().is_none_or(|none| none.to_string() != why.to_string())
            {
                packing.notes.push(Note::remark(format!("no wave speeds: {why}")));
            }
            let shown = Probed { packing, acoustic: None };
            return Ok(Found { shown, is_without: true, is_fault, messages: Ok(Vec::new()) });
        }
    };
    let sent = messages(&imported.header, packing, &found).map_err(|e| named(&e))?;
    let reading = WaveSpeedsReading::try_from(&sent.wave_speeds).map_err(|e| named(&e))?;
    let density = packing.solid_fraction() * packing.material.density;
    let mut acoustic = AcousticReport::new(packing.grains() as u32, density, reading);
    acoustic.modes = found.modes;
    // The axis of the rays, or the one inferred from the speeds.
    let measured = measured(acoustic.medium.axis)?;
    let waveforms = sent.waveforms.iter().map(|w| Recorded::new(topics::WAVEFORM, &w.header, w));
    let speeds = Recorded::new(topics::WAVE_SPEEDS, &sent.wave_speeds.header, &sent.wave_speeds);
    let shown = Probed { packing: measured, acoustic: Some(acoustic) };
    Ok(Found { shown, is_without: false, is_fault: false, messages: Ok(waveforms.chain([speeds]).collect()) })
}
