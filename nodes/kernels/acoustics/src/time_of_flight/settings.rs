//! Settings of the measurement by time of flight.

use crate::error::{AcousticsError, setting};
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
        let (a, c) = (self.amplitude, self.cycles);
        setting("amplitude", a, a > 0.0 && a <= 1e-2, "more than 0, 0.01 or less")?;
        setting("cycles", c, c.is_finite() && c >= 1.0, "1 or more and finite")?;
        setting("copies", 0.0, self.copies != Some(0), "1 or more")?;
        let frequencies = self.frequencies.as_deref();
        setting("frequencies", 0.0, frequencies != Some(&[]), "one or more")?;
        for (k, f) in frequencies.unwrap_or_default().iter().enumerate() {
            let is_new = frequencies.is_some_and(|all| !all[..k].contains(f));
            setting(
                "frequencies",
                *f,
                f.is_finite() && *f > 0.0 && is_new,
                "more than 0, finite, each once",
            )?;
        }
        Ok(self)
    }
}
