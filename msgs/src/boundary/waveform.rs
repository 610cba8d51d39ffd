//! `Waveform`: the traces of one wave.

use super::check::{Check, vector_message};
use super::error::BoundaryError;
use super::wave_speeds::{code, method};
use crate::builtin_interfaces::Time;
use crate::msg;
use crate::std_msgs::Header;
use grainlab_core::{Vec3, WaveMethod};

const CHECK: Check = Check("Waveform");

/// The quantity of the samples, and its unit.
const QUANTITY: &str = "velocity";
const UNIT: &str = "m/s";

/// Checked traces of a wave.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveformReading {
    /// Stamp of the source.
    pub stamp: Time,
    /// Step of the packing probed; `None` if it is not from a simulation.
    pub source_step: Option<u64>,
    /// Method of their evaluation.
    pub method: WaveMethod,
    /// Unit direction of propagation.
    pub direction: Vec3,
    /// Unit particle motion, sent and received.
    pub polarization: Vec3,
    /// Dominant frequency sent, Hz, more than 0.
    pub frequency: f64,
    /// Sampling rate, Hz, more than 0.
    pub sample_rate: f64,
    /// Time of the first sample after the trigger, s.
    pub start: f64,
    /// One or more, all with the same number of samples.
    pub channels: Vec<TraceReading>,
}

/// Trace of one receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceReading {
    /// Name of the trace.
    pub name: String,
    /// Distance from the source along the direction, m, 0 or more; the wavelength of a standing wave.
    pub distance: f64,
    /// Particle velocity along the polarization, m/s.
    pub samples: Vec<f32>,
}

/// The message with the traces of one wave; `header` is that of the measured packing, and replaces the stamp
/// of the reading.
pub fn waveform_message(header: Header, found: &WaveformReading) -> Result<msg::Waveform, BoundaryError> {
    let each = found.channels.first().map_or(0, |c| c.samples.len());
    if let Some(other) = found.channels.iter().find(|c| c.samples.len() != each) {
        CHECK.length("sample", other.samples.len(), each, "as many in each channel")?;
    }
    let message = msg::Waveform {
        header,
        source_step: found.source_step.unwrap_or(0),
        method: code(found.method),
        direction: vector_message(&found.direction),
        polarization: vector_message(&found.polarization),
        frequency: found.frequency,
        sample_rate: found.sample_rate,
        start: found.start,
        quantity: QUANTITY.to_owned(),
        unit: UNIT.to_owned(),
        channel: found.channels.iter().map(|c| c.name.clone()).collect(),
        distance: found.channels.iter().map(|c| c.distance).collect(),
        sample: found.channels.iter().flat_map(|c| c.samples.iter().copied()).collect(),
    };
    WaveformReading::try_from(&message)?;
    Ok(message)
}

impl TryFrom<&msg::Waveform> for WaveformReading {
    type Error = BoundaryError;

    fn try_from(m: &msg::Waveform) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        CHECK.word("quantity", &m.quantity, &[QUANTITY], QUANTITY)?;
        CHECK.word("unit", &m.unit, &[UNIT], UNIT)?;
        let channels = m.channel.len();
        CHECK.length("channel", channels, channels.max(1), "a wave has a trace")?;
        CHECK.length("distance", m.distance.len(), channels, "one per channel")?;
        let each = m.sample.len() / channels;
        CHECK.length("sample", m.sample.len(), each * channels, "as many in each channel")?;
        CHECK.length(
            "sample",
            m.sample.len(),
            m.sample.len().max(channels),
            "at least one in each channel",
        )?;
        for (i, distance) in m.distance.iter().enumerate() {
            CHECK.not_negative(&format!("distance[{i}]"), *distance)?;
        }
        if let Some((i, sample)) = m.sample.iter().enumerate().find(|(_, s)| !s.is_finite()) {
            CHECK.finite(&format!("sample[{i}]"), f64::from(*sample))?;
        }
        let traces = m.channel.iter().zip(&m.distance).zip(m.sample.chunks(each));
        Ok(Self {
            stamp: m.header.stamp,
            source_step: Some(m.source_step).filter(|step| *step > 0),
            method: method(CHECK, "method", m.method)?,
            direction: CHECK.unit("direction", &m.direction)?,
            polarization: CHECK.unit("polarization", &m.polarization)?,
            frequency: CHECK.positive("frequency", m.frequency)?,
            sample_rate: CHECK.positive("sample_rate", m.sample_rate)?,
            start: CHECK.finite("start", m.start)?,
            channels: traces
                .map(|((name, distance), samples)| TraceReading {
                    name: name.clone(),
                    distance: *distance,
                    samples: samples.to_vec(),
                })
                .collect(),
        })
    }
}
