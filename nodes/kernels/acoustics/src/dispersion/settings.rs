//! Settings of the measurement by dispersion.

use crate::error::{AcousticsError, setting};

/// Shortest wavelength, mean diameters: below, neighbours move against each other.
const MIN_WAVELENGTH: f64 = 2.0;

/// Settings of the measurement by dispersion.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Wavelengths in mean grain diameters, three or more different ones, each above 2. In packings with a
    /// coordination number of 5, loosely held grains do not follow waves shorter than about 100 diameters,
    /// which are faster by up to 0.1 %.
    pub wavelengths: Vec<f64>,
    /// Relative error of ω², in [1e-12, 1e-2].
    pub tolerance: f64,
    /// Maximum number of conjugate gradient iterations per wave vector.
    pub max_iterations: u32,
    /// Number of doublings of all wavelengths, three at once, along a ray whose speeds have no convergent series at those
    /// set, at most 9. Packings near isostaticity need longer waves.
    pub doublings: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            wavelengths: vec![320.0, 640.0, 1280.0],
            tolerance: 1e-5,
            max_iterations: 20_000,
            doublings: 6,
        }
    }
}

impl Settings {
    /// The settings, if they are in range.
    pub fn validated(&self) -> Result<&Self, AcousticsError> {
        let mut different = self.wavelengths.clone();
        different.sort_by(f64::total_cmp);
        different.dedup_by(|a, b| (*a - *b).abs() <= 1e-6 * b.abs());
        let count = different.len();
        let requirement = "3 or more different ones, to extrapolate and to estimate the error";
        setting("number of wavelengths", count as f64, count >= 3, requirement)?;
        for wavelength in &self.wavelengths {
            let valid = wavelength.is_finite() && *wavelength > MIN_WAVELENGTH;
            setting("wavelength", *wavelength, valid, "more than 2 mean grain diameters, finite")?;
        }
        let (t, n) = (self.tolerance, self.max_iterations);
        setting("tolerance", t, (1e-12..=1e-2).contains(&t), "between 1e-12 and 1e-2")?;
        setting("max_iterations", f64::from(n), n > 0, "1 or more")?;
        setting("doublings", f64::from(self.doublings), self.doublings <= 9, "at most 9")?;
        Ok(self)
    }
}
