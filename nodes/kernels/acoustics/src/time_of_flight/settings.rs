//! Settings of the measurement by time of flight.

use crate::error::AcousticsError;
use grainlab_core::WaveMethod;

/// The feature of a trace that is taken as the arrival.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArrivalPick {
    /// Onset of the first arrival.
    FirstArrival,
    /// Delay of largest correlation between receivers.
    #[default]
    CrossCorrelation,
    /// Peak of the envelope.
    Peak,
}

impl ArrivalPick {
    /// Name in results.
    pub fn method(&self) -> WaveMethod {
        match self {
            Self::FirstArrival => WaveMethod::FirstArrival,
            Self::CrossCorrelation => WaveMethod::CrossCorrelation,
            Self::Peak => WaveMethod::Peak,
        }
    }
}

/// Settings of the measurement by time of flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Centre frequencies, Hz; `None`: those of waves of about 20, 28 and 40 mean grain diameters, for the speed of a
    /// first burst.
    pub frequencies: Option<Vec<f64>>,
    /// Periods of a burst, under a Hann window; 1 or more.
    pub cycles: f64,
    /// Repetitions of the packing along the path; `None`: as many as keep the wave in the opposite direction
    /// away from the receivers.
    pub copies: Option<u32>,
    /// Peak strain. From 1e-10 to 1e-6 speeds in packings at 50 kPa are the same to 5e-4; above, contacts open.
    pub amplitude: f64,
    /// The feature that is taken as the arrival.
    pub pick: ArrivalPick,
    /// Friction; `None`: that of the packing, where contacts at the Coulomb limit slide under any wave; infinite: no
    /// sliding.
    pub friction: Option<f64>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            frequencies: None,
            cycles: 2.0,
            copies: None,
            amplitude: 1e-8,
            pick: ArrivalPick::default(),
            friction: None,
        }
    }
}

impl Settings {
    /// The settings, if they are in range.
    pub fn validated(&self) -> Result<&Self, AcousticsError> {
        let fault = |name, value, requirement| Err(AcousticsError::Setting { name, value, requirement });
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if !positive(self.amplitude) {
            return fault("amplitude", self.amplitude, "more than 0 and finite");
        }
        if !(self.cycles.is_finite() && self.cycles >= 1.0) {
            return fault("cycles", self.cycles, "1 or more and finite");
        }
        if self.amplitude > 1e-2 {
            return fault("amplitude", self.amplitude, "0.01 or less");
        }
        if self.copies == Some(0) {
            return fault("copies", 0.0, "1 or more");
        }
        for (k, frequency) in self.frequencies.iter().flatten().enumerate() {
            if !positive(*frequency) {
                return fault("frequencies", *frequency, "more than 0 and finite");
            }
            if self.frequencies.iter().flatten().take(k).any(|f| f == frequency) {
                return fault("frequencies", *frequency, "each once");
            }
        }
        if self.frequencies.as_ref().is_some_and(Vec::is_empty) {
            return fault("frequencies", 0.0, "one or more");
        }
        Ok(self)
    }
}
