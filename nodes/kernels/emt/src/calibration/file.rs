//! Calibration files (TOML). Units: Pa; α and ρ in MPa^⅔.

use super::constants::Calibration;
use super::discrepancy::ModelDiscrepancy;
use super::error::{CalibrationError, constant};
use super::isotropic::IsotropicCalibration;
use super::relaxation::RelaxationCalibration;
use grainlab_core::Material;
use serde::{Deserialize, Serialize};

/// The whole file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pressures: Option<[f64; 2]>,
    #[serde(with = "Grains")]
    material: Material,
    isotropic: Vec<IsotropicCalibration>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    network: Option<Box<RelaxationCalibration>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    discrepancy: Vec<ModelDiscrepancy>,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Material", deny_unknown_fields)]
struct Grains {
    shear_modulus: f64,
    poisson_ratio: f64,
    density: f64,
}

impl Calibration {
    /// Reads the text of a calibration file.
    pub fn parse(text: &str) -> Result<Self, CalibrationError> {
        let file: File = toml::from_str(text).map_err(|e| CalibrationError::Text(e.to_string()))?;
        let mut fits = file.isotropic.into_iter();
        let isotropic =
            fits.next().ok_or_else(|| CalibrationError::Text("no [[isotropic]] section".into()))?;
        let other = fits.next();
        let same_kind = |o: &IsotropicCalibration| o.coordination_kind == isotropic.coordination_kind;
        if other.as_ref().is_some_and(same_kind) || fits.next().is_some() {
            return Err(CalibrationError::Text("[[isotropic]]: one section for each abscissa".into()));
        }
        let Material { shear_modulus, poisson_ratio, density } = file.material;
        constant("material.shear_modulus", shear_modulus, shear_modulus > 0.0, "it must be positive")?;
        let fits = (0.0..=0.5).contains(&poisson_ratio);
        constant("material.poisson_ratio", poisson_ratio, fits, "it must lie in [0, 1/2]")?;
        constant("material.density", density, density > 0.0, "it must be positive")?;
        file.discrepancy.iter().try_for_each(ModelDiscrepancy::check)?;
        file.network.iter().try_for_each(|network| network.check())?;
        Ok(Self {
            name: file.name.into(),
            isotropic,
            other,
            material: file.material,
            pressures: file.pressures,
            network: file.network,
            discrepancies: file.discrepancy,
        })
    }

    /// The text of a calibration file, as [`Calibration::parse`] reads it.
    pub fn to_toml(&self) -> Result<String, CalibrationError> {
        let file = File {
            name: self.name().to_owned(),
            pressures: self.pressures,
            material: self.material,
            isotropic: [Some(&self.isotropic), self.other.as_ref()].into_iter().flatten().cloned().collect(),
            network: self.network.clone(),
            discrepancy: self.discrepancies.clone(),
        };
        toml::to_string(&file).map_err(|e| CalibrationError::Text(e.to_string()))
    }
}
