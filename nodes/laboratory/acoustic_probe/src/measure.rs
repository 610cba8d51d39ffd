//! From one `Packing` to one `WaveSpeeds` and its `Waveform`s.

use crate::Settings;
use grainlab_acoustics::{AcousticsError, Measurement, Trace};
use grainlab_core::notes::Note;
use grainlab_core::results::NoStiffness;
use grainlab_core::{Packing, Vec3, stress};
use grainlab_msgs::boundary::{BoundaryError, WaveSpeedsReading, vector_message, wave_speeds_message};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{DecodeError, msg};

/// The messages published for one packing.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Wave speeds of the packing.
    pub wave_speeds: msg::WaveSpeeds,
    /// The recorded traces, one message per wave; empty for dispersion.
    pub waveforms: Vec<msg::Waveform>,
    /// Why there are no speeds.
    pub declined: Option<MeasureError>,
}

/// Why a packing has no wave speeds.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeasureError {
    /// The message cannot be decoded.
    #[error("a packing cannot be decoded: {0}")]
    Undecodable(#[from] DecodeError),
    /// The message is not a valid packing.
    #[error(transparent)]
    Refused(BoundaryError),
    /// No wave propagates. Not a fault: a gas of grains does not transmit sound.
    #[error("packing of step {step} has no wave speeds: {reason}")]
    NoStiffness {
        /// Step of the packing.
        step: u64,
        /// Reason of the failure.
        reason: NoStiffness,
    },
    /// The measurement failed.
    #[error("wave speeds of the packing of step {step} are not measured: {reason}")]
    Acoustics {
        /// Step of the packing.
        step: u64,
        /// Reason of the failure.
        reason: AcousticsError,
    },
    /// The result is not a valid message.
    #[error("wave speeds of the packing of step {step} are measured, but cannot be published: {reason}")]
    Result {
        /// Step of the packing.
        step: u64,
        /// Reason of the failure.
        reason: BoundaryError,
    },
}

/// Measures one packing; a packing that carries no wave gets a message without speeds. Header and step are copied. The result depends
/// only on the two arguments.
pub fn measure(message: &msg::Packing, settings: &Settings) -> Result<Measured, MeasureError> {
    let packing = Packing::try_from(message).map_err(MeasureError::Refused)?;
    let step = packing.step;
    let why = match grainlab_acoustics::measure(&packing, &settings.0) {
        Ok(found) => {
            let messages = messages(&message.header, &packing, &found);
            return messages.map_err(|reason| MeasureError::Result { step, reason });
        }
        Err(AcousticsError::NoStiffness(reason)) => MeasureError::NoStiffness { step, reason },
        Err(reason) => MeasureError::Acoustics { step, reason },
    };
    declined(&message.header, &packing, why)
}

/// Returns the messages for a measured packing; `header` is the header of the packing's message.
pub fn messages(header: &Header, packing: &Packing, found: &Measurement) -> Result<Measured, BoundaryError> {
    let reading = WaveSpeedsReading {
        density: found.density,
        density_stddev: Some(found.density_stddev).filter(|s| *s > 0.0),
        axis: found.axis,
        stress_ratio: stress::stress(packing).tensor.axial_ratio(&found.axis.unwrap_or_else(Vec3::z)),
        smooth: found.smooth,
        speeds: found.waves.clone(),
        notes: found.notes.clone(),
        ..reading(header, packing)
    };
    let wave_speeds = wave_speeds_message(header.clone(), &reading)?;
    let traces = found.traces.iter().map(|trace| waveform(header, packing.step, trace));
    Ok(Measured { wave_speeds, waveforms: traces.collect::<Result<_, _>>()?, declined: None })
}

/// Returns the message for a packing without wave speeds, which says why.
fn declined(header: &Header, packing: &Packing, why: MeasureError) -> Result<Measured, MeasureError> {
    let note = match &why {
        MeasureError::NoStiffness { reason, .. } => Note::from(reason),
        other => Note::no_answer(other.to_string()),
    };
    let reading = WaveSpeedsReading { notes: vec![note], ..reading(header, packing) };
    match wave_speeds_message(header.clone(), &reading) {
        Ok(wave_speeds) => Ok(Measured { wave_speeds, waveforms: Vec::new(), declined: Some(why) }),
        Err(_) => Err(why),
    }
}

/// Returns the state of a packing, without speeds.
fn reading(header: &Header, packing: &Packing) -> WaveSpeedsReading {
    let stress = stress::stress(packing).tensor;
    WaveSpeedsReading {
        stamp: header.stamp,
        name: String::new(),
        source_step: Some(packing.step).filter(|step| *step > 0),
        grains: u32::try_from(packing.grains()).ok(),
        density: packing.material.density * packing.solid_fraction(),
        density_stddev: None,
        pressure: stress.mean(),
        pressure_stddev: 0.0,
        solid_fraction: Some(packing.solid_fraction()),
        stress_ratio: stress.axial_ratio(&Vec3::z()),
        stress_ratio_stddev: 0.0,
        size_spread: Some(packing.size_spread()),
        axis: None,
        grain_shear_modulus: packing.material.shear_modulus,
        grain_shear_modulus_stddev: 0.0,
        grain_poisson_ratio: packing.material.poisson_ratio,
        grain_poisson_ratio_stddev: 0.0,
        contact_law: Some(packing.law),
        smooth: false,
        speeds: Vec::new(),
        notes: Vec::new(),
    }
}

fn waveform(header: &Header, source_step: u64, trace: &Trace) -> Result<msg::Waveform, BoundaryError> {
    let message = msg::Waveform {
        header: header.clone(),
        source_step,
        method: msg::WaveSpeed::code(trace.method),
        direction: vector_message(&trace.direction),
        polarization: vector_message(&trace.polarization),
        frequency: trace.frequency,
        sample_rate: trace.sample_rate,
        start: trace.start,
        quantity: msg::Waveform::QUANTITY.to_owned(),
        unit: msg::Waveform::UNIT.to_owned(),
        channel: (1..=trace.channels.len()).map(|n| format!("receiver {n}")).collect(),
        distance: trace.channels.iter().map(|c| c.distance).collect(),
        // Single precision is that of a good digitiser, and far finer than any noise.
        sample: trace.channels.iter().flat_map(|c| &c.samples).map(|s| *s as f32).collect(),
    };
    message.checked()?;
    Ok(message)
}
