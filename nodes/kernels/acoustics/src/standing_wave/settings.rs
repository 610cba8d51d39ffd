//! Settings of the measurement by standing waves.

use crate::error::AcousticsError;
use grainlab_core::contact::TangentialLaw;

/// Least number of repetitions of the packing: two wavelengths fit in, the least for an extrapolation.
pub const MIN_COPIES: u32 = 5;

/// Settings of the measurement by standing waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Repetitions of the packing along the path, 5 or more. The wavelengths are the path over 1, 2 … 2/5 of this
    /// number, at most four and none shorter than 20 mean diameters. There are more repetitions where the path would be
    /// shorter than 60 mean diameters. Time and memory are proportional to the number.
    pub copies: u32,
    /// Number of periods of each wave that are evaluated, 1.5 to 100. The first quarter period is left out: there
    /// grains still move with the mean deformation.
    pub periods: f64,
    /// Peak strain of all waves together, above 0 and at most 0.01.
    pub amplitude: f64,
    /// Friction during the vibration; `None`: that of the packing. Contacts at the Coulomb limit slide under any wave,
    /// which makes it slower than in the frozen network by a few per cent; a very high friction prevents that.
    pub friction: Option<f64>,
    /// How the tangential force follows a change of normal stiffness.
    pub tangential: TangentialLaw,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            copies: 8,
            periods: 4.0,
            amplitude: 1e-9,
            friction: None,
            tangential: TangentialLaw::Incremental,
        }
    }
}

impl Settings {
    /// The settings, if they are in range.
    pub fn validated(&self) -> Result<&Self, AcousticsError> {
        let fault = |name, value, requirement| Err(AcousticsError::Setting { name, value, requirement });
        if self.copies < MIN_COPIES {
            return fault("copies", self.copies.into(), "5 or more, for two wavelengths");
        }
        if !(1.5..=100.0).contains(&self.periods) {
            return fault("periods", self.periods, "between 1.5 and 100");
        }
        if !(self.amplitude > 0.0 && self.amplitude <= 1e-2) {
            return fault("amplitude", self.amplitude, "above 0 and at most 0.01");
        }
        Ok(self)
    }
}
