//! `Waveform`: the traces of one wave.

use super::check::Check;
use super::error::BoundaryError;
use super::wave_speeds::method;
use crate::msg::Waveform;

const CHECK: Check = Check("Waveform");

impl Waveform {
    /// Quantity of the samples.
    pub const QUANTITY: &str = "velocity";
    /// Unit of the samples.
    pub const UNIT: &str = "m/s";

    /// The message, if it is valid.
    ///
    /// # Errors
    /// A number out of range, another quantity than the velocity in m/s, traces that are missing or of different lengths.
    pub fn checked(&self) -> Result<&Self, BoundaryError> {
        CHECK.header(&self.header)?;
        CHECK.word("quantity", &self.quantity, &[Self::QUANTITY], Self::QUANTITY)?;
        CHECK.word("unit", &self.unit, &[Self::UNIT], Self::UNIT)?;
        let (channels, samples) = (self.channel.len(), self.sample.len());
        CHECK.length("channel", channels, channels.max(1), "a wave has a trace")?;
        CHECK.length("distance", self.distance.len(), channels, "one per channel")?;
        CHECK.length("sample", samples, samples / channels * channels, "as many in each channel")?;
        CHECK.length("sample", samples, samples.max(channels), "at least one in each channel")?;
        for (i, distance) in self.distance.iter().enumerate() {
            CHECK.not_negative(format_args!("distance[{i}]"), *distance)?;
        }
        if let Some((i, sample)) = self.sample.iter().enumerate().find(|(_, s)| !s.is_finite()) {
            CHECK.finite(format_args!("sample[{i}]"), f64::from(*sample))?;
        }
        method(CHECK, "method", self.method)?;
        CHECK.unit("direction", &self.direction)?;
        CHECK.unit("polarization", &self.polarization)?;
        CHECK.positive("frequency", self.frequency)?;
        CHECK.positive("sample_rate", self.sample_rate)?;
        CHECK.finite("start", self.start)?;
        Ok(self)
    }
}
