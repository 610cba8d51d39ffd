//! The constants of all models.

use super::discrepancy::ModelDiscrepancy;
use super::isotropic::IsotropicCalibration;
use super::relaxation::RelaxationCalibration;
use crate::conditions::StrainRatioSource;
use grainlab_core::Material;
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A material, as the file has it.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Material", deny_unknown_fields)]
struct Grains {
    shear_modulus: f64,
    poisson_ratio: f64,
    density: f64,
}

/// Constants of the models, measured on packings of one material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    pub(crate) name: Cow<'static, str>,
    /// Lowest and highest pressure of its packings, Pa; `None` if not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressures: Option<[f64; 2]>,
    #[serde(with = "Grains")]
    pub(crate) material: Material,
    pub(crate) isotropic: IsotropicCalibration,
    /// Constants of the model `relaxed`; `None` if the calibration lacks them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<Box<RelaxationCalibration>>,
    /// Errors of the models; empty for those that they have with the constants of the paper.
    #[serde(default, rename = "discrepancy", skip_serializing_if = "Vec::is_empty")]
    pub discrepancies: Vec<ModelDiscrepancy>,
}

impl Calibration {
    /// Only the isotropic constants of the paper.
    pub const PAPER: Calibration = Calibration {
        name: Cow::Borrowed("paper"),
        isotropic: IsotropicCalibration::PAPER,
        material: Material::GLASS,
        pressures: None,
        network: None,
        discrepancies: Vec::new(),
    };

    /// From isotropic constants of packings of `material`.
    pub fn of_isotropic(
        name: impl Into<Cow<'static, str>>,
        isotropic: IsotropicCalibration,
        material: Material,
    ) -> Self {
        Self { name: name.into(), isotropic, material, ..Self::PAPER }
    }

    /// Name of the calibration, reported with every estimate.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Material of its packings.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Constants of the model `relaxed`; `None` if the calibration lacks them.
    pub fn network(&self) -> Option<&RelaxationCalibration> {
        self.network.as_deref()
    }

    /// Eqs. 21 and 22 for the material of the calibration.
    pub fn isotropic(&self) -> &IsotropicCalibration {
        &self.isotropic
    }

    /// Eqs. 21 and 22 for these grains: at the same pressure the stiffness of a network of Hertz contacts is
    /// proportional to E*^⅔.
    pub fn isotropic_for(&self, material: Option<Material>) -> IsotropicCalibration {
        self.isotropic.scaled(self.stiffer(material))
    }

    /// Stiffness of a network of these grains over that of the calibration at the same pressure: (E*/E* of the
    /// calibration)^⅔.
    pub(crate) fn stiffer(&self, material: Option<Material>) -> f64 {
        let own = self.material.effective_young();
        material.map_or(1.0, |m| (m.effective_young() / own).cbrt().powi(2))
    }

    /// Covariance of the error of a model that takes this γ/Δ and infers this structure; `None` if it was not learned. A γ/Δ of
    /// unknown origin counts as that of the total strain, with which errors are largest. A calibration without errors of its
    /// own has those that the models have with the constants of the paper.
    pub(crate) fn discrepancy(
        &self,
        model: &str,
        gamma: Option<StrainRatioSource>,
        structure: &Microstructure,
        grains: Option<u32>,
    ) -> Option<MicrostructureCovariance> {
        let learned_from = gamma.map(|source| match source {
            StrainRatioSource::Given => StrainRatioSource::Total,
            other => other,
        });
        let all = if self.discrepancies.is_empty() { Self::errors_with_paper() } else { &self.discrepancies };
        let learned = all.iter().find(|d| d.model == model && d.gamma == learned_from)?;
        // Smaller samples than those of the packings scatter more.
        let packings = self.network().or_else(|| Self::builtin("grainlab")?.network());
        let ratio = grains.zip(packings).map(|(n, p)| f64::from(p.grains) / f64::from(n.max(1)));
        let scatter = ratio.map_or(1.0, |ratio| ratio.max(1.0));
        let mut covariance = MicrostructureCovariance::zeros();
        let order = [InferredQuantity::K, InferredQuantity::KHat, InferredQuantity::Eps];
        for (a, row) in order.into_iter().zip(learned.at(structure.eps, scatter)) {
            for (b, value) in order.into_iter().zip(row) {
                covariance[(a as usize, b as usize)] = value;
            }
        }
        Some(covariance)
    }
}
