//! What packings have taught the models: data, named in every result.

mod isotropic;

pub use isotropic::Isotropic;

use crate::conditions::GammaSource;
use crate::structure::StructureCovariance;
use grains::Material;
use std::borrow::Cow;

/// Constants of the models, measured on packings of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    name: Cow<'static, str>,
    isotropic: Isotropic,
    material: Material,
    pressures: Option<[f64; 2]>,
    discrepancies: Vec<Discrepancy>,
}

/// How far a model is from the packings of the calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Discrepancy {
    /// Name of the model.
    pub model: String,
    /// The γ/Δ that it was fed with; `None` if it uses none.
    pub gamma: Option<GammaSource>,
    /// Mean of error times error, the bias in it.
    pub mean_square: StructureCovariance,
}

/// Why numbers are not a calibration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} = {value} is invalid: {requirement}")]
pub struct CalibrationError {
    /// Which constant.
    pub field: &'static str,
    /// The value found.
    pub value: f64,
    /// What is required.
    pub requirement: &'static str,
}

impl Calibration {
    /// The paper's isotropic constants, and no more.
    pub const PAPER: Calibration = Calibration {
        name: Cow::Borrowed("paper"),
        isotropic: Isotropic::PAPER,
        material: Material::GLASS,
        pressures: None,
        discrepancies: Vec::new(),
    };

    /// Isotropic constants of packings of `material`, by name.
    pub fn of_isotropic(
        name: impl Into<Cow<'static, str>>,
        isotropic: Isotropic,
        material: Material,
    ) -> Self {
        Self { name: name.into(), isotropic, material, pressures: None, discrepancies: Vec::new() }
    }

    /// Its name, reported with every estimate.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Material of its packings.
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Lowest and highest pressure of its packings, Pa; `None` if not known.
    pub fn pressures(&self) -> Option<[f64; 2]> {
        self.pressures
    }

    /// Eqs. 21 and 22 for the calibration's own material.
    pub fn isotropic(&self) -> &Isotropic {
        &self.isotropic
    }

    /// Eqs. 21 and 22 for these grains: at the same pressure a network of Hertz contacts is stiffer as E*^⅔.
    pub fn isotropic_for(&self, material: Option<Material>) -> Isotropic {
        self.isotropic.scaled(self.stiffer(material))
    }

    /// How much stiffer these grains make a network at the same pressure: (E*/E* of the calibration)^⅔.
    pub(crate) fn stiffer(&self, material: Option<Material>) -> f64 {
        let own = self.material.effective_young();
        material.map_or(1.0, |m| (m.effective_young() / own).cbrt().powi(2))
    }

    /// What was learned of a model fed with this γ/Δ.
    pub(crate) fn discrepancy(&self, model: &str, gamma: Option<GammaSource>) -> Option<StructureCovariance> {
        self.discrepancies.iter().find(|d| d.model == model && d.gamma == gamma).map(|d| d.mean_square)
    }
}
