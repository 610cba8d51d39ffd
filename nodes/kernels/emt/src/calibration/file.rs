//! Calibration files (TOML). Units: Pa; α and ρ in MPa^⅔.

use super::constants::Calibration;
use super::discrepancy::ModelDiscrepancy;
use super::error::{CalibrationError, constant};
use grainlab_core::Material;

impl Calibration {
    /// Reads the text of a calibration file.
    pub fn parse(text: &str) -> Result<Self, CalibrationError> {
        let wrong = |e| format!("{e}\nA calibration that an earlier version wrote must be learned anew.");
        let found: Self =
            toml::from_str(text).map_err(|e: toml::de::Error| CalibrationError::Text(wrong(e)))?;
        let Material { shear_modulus, poisson_ratio, density } = found.material;
        constant("material.shear_modulus", shear_modulus, shear_modulus > 0.0, "it must be positive")?;
        let fits = (0.0..=0.5).contains(&poisson_ratio);
        constant("material.poisson_ratio", poisson_ratio, fits, "it must lie in [0, 1/2]")?;
        constant("material.density", density, density > 0.0, "it must be positive")?;
        found.discrepancies.iter().try_for_each(ModelDiscrepancy::check)?;
        found.network.iter().try_for_each(|network| network.check())?;
        Ok(Self { isotropic: found.isotropic.checked()?, ..found })
    }

    /// The text of a calibration file, as [`Calibration::parse`] reads it.
    pub fn to_toml(&self) -> Result<String, CalibrationError> {
        toml::to_string(self).map_err(|e| CalibrationError::Text(e.to_string()))
    }
}
