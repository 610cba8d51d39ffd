//! What packings have taught the models: data, named in every result.

mod ensemble;
mod file;
mod isotropic;
mod learn;
mod network;
mod regression;

pub use ensemble::Sample;
pub use isotropic::Isotropic;
pub use learn::learn;
pub(crate) use network::SCATTERED;
pub use network::{Amplitude, Law, Network};

use crate::conditions::GammaSource;
use crate::model::Model;
use crate::structure::{Quantity, StructureCovariance};
use grainlab_core::Material;
use std::borrow::Cow;
use std::sync::LazyLock;

/// Constants of the models, measured on packings of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    name: Cow<'static, str>,
    isotropic: Isotropic,
    /// The same packings by the other coordination number.
    other: Option<Isotropic>,
    material: Material,
    pressures: Option<[f64; 2]>,
    network: Option<Box<Network>>,
    discrepancies: Vec<Discrepancy>,
}

/// How far a model is from the packings of the calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Discrepancy {
    /// Name of the model.
    pub model: String,
    /// The coordination number that its isotropic packings are told by.
    pub abscissa: Quantity,
    /// The γ/Δ that it was fed with; `None` if it uses none.
    pub gamma: Option<GammaSource>,
    /// Mean of error times error, the bias in it, of the coordination number, k̂ and ε; zero where the model has no k̂.
    pub mean_square: [[f64; 3]; 3],
    /// What the mean square of the error of ε is multiplied by where ε is inferred: f0 + f1 ε², 1 in the mean.
    pub by_eps: [f64; 2],
}

impl Discrepancy {
    /// Mean of error times error where this ε is inferred.
    fn at(&self, eps: Option<f64>) -> [[f64; 3]; 3] {
        let [constant, square] = self.by_eps;
        let wider = eps.map_or(1.0, |eps| (constant + square * eps * eps).sqrt());
        let scale = [1.0, 1.0, wider];
        std::array::from_fn(|i| std::array::from_fn(|j| scale[i] * scale[j] * self.mean_square[i][j]))
    }
}

/// Why there is no calibration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// A constant is out of range.
    #[error("{field} = {value} is invalid: {requirement}")]
    Constant {
        /// Which constant.
        field: &'static str,
        /// The value found.
        value: f64,
        /// What is required.
        requirement: &'static str,
    },
    /// The text is not that of a calibration.
    #[error("{0}")]
    Text(String),
    /// The packings do not determine the constants.
    #[error("{found} {what}, {needed} or more are needed: prepare more packings, or more different ones")]
    Packings {
        /// What is too few.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
}

impl Calibration {
    /// The paper's isotropic constants, and no more.
    pub const PAPER: Calibration = Calibration {
        name: Cow::Borrowed("paper"),
        isotropic: Isotropic::PAPER,
        other: None,
        material: Material::GLASS,
        pressures: None,
        network: None,
        discrepancies: Vec::new(),
    };

    /// Isotropic constants of packings of `material`, by name.
    pub fn of_isotropic(
        name: impl Into<Cow<'static, str>>,
        isotropic: Isotropic,
        material: Material,
    ) -> Self {
        Self {
            name: name.into(),
            isotropic,
            other: None,
            material,
            pressures: None,
            network: None,
            discrepancies: Vec::new(),
        }
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

    /// What relaxed networks are like; `None` if the calibration has not looked.
    pub fn network(&self) -> Option<&Network> {
        self.network.as_deref()
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

    /// The same with its isotropic packings told by the other coordination number; `None` if it does not know how.
    pub fn with_abscissa(&self, abscissa: Quantity) -> Option<Self> {
        if self.isotropic.abscissa == abscissa {
            return Some(self.clone());
        }
        let isotropic = self.other.clone().filter(|i| i.abscissa == abscissa)?;
        Some(Self { isotropic, other: Some(self.isotropic.clone()), ..self.clone() })
    }

    /// Names that [`Calibration::builtin`] knows.
    pub const BUILTIN: [&str; 3] = ["paper", "grainlab", "grainlab-z"];

    /// `paper`: the paper's constants. `grainlab`: our own, of packings of 2,000 grains, k̂ and k in the sense of contacts
    /// over all grains; `grainlab-z`: the same packings, rattlers left out.
    pub fn builtin(name: &str) -> Option<&'static Self> {
        static PAPER: Calibration = Calibration::PAPER;
        static BY_K: LazyLock<Option<Calibration>> =
            LazyLock::new(|| Calibration::parse(include_str!("grainlab.toml")).ok());
        static BY_Z: LazyLock<Option<Calibration>> = LazyLock::new(|| {
            let by_z = BY_K.as_ref()?.with_abscissa(Quantity::Z)?;
            Some(Calibration { name: Cow::Borrowed("grainlab-z"), ..by_z })
        });
        match name {
            "paper" => Some(&PAPER),
            "grainlab" => BY_K.as_ref(),
            "grainlab-z" => BY_Z.as_ref(),
            _ => None,
        }
    }

    /// The one to use where none is asked for: the paper's for the models that it has the constants of, else our own.
    pub fn default_for(model: &dyn Model) -> &'static Self {
        static PAPER: Calibration = Calibration::PAPER;
        let needs_more = model.domain(&PAPER).structure.iter().all(Option::is_none);
        needs_more.then(|| Self::builtin("grainlab")).flatten().unwrap_or(&PAPER)
    }

    /// What was learned of a model fed with this γ/Δ, where it infers this ε.
    pub(crate) fn discrepancy(
        &self,
        model: &str,
        gamma: Option<GammaSource>,
        eps: Option<f64>,
    ) -> Option<StructureCovariance> {
        let abscissa = self.isotropic.abscissa;
        let learned = self
            .discrepancies
            .iter()
            .find(|d| d.model == model && d.gamma == gamma && d.abscissa == abscissa)?;
        let mut covariance = StructureCovariance::zeros();
        let order = [abscissa, Quantity::KHat, Quantity::Eps];
        for (a, row) in order.into_iter().zip(learned.at(eps)) {
            for (b, value) in order.into_iter().zip(row) {
                covariance[(a as usize, b as usize)] = value;
            }
        }
        Some(covariance)
    }
}
