//! Contact laws: one file each, and the list of them.
//!
//! A law is its springs ([`ContactSprings`]). Dashpots, tangential history and the Coulomb limit are the same for all
//! ([`SpringDashpotSlider`]). To add a law: write its file, and add it to [`ContactLaw`] here.

mod hertz_mindlin;
mod linear;
mod spring_dashpot_slider;
mod springs;
mod tangential;

pub use hertz_mindlin::HertzMindlin;
pub use linear::Linear;
pub use spring_dashpot_slider::{ContactForces, ContactKinematics, HistoryStep, SpringDashpotSlider};
pub use springs::{ContactSprings, LawParameter};
pub use tangential::TangentialLaw;

use crate::material::Material;
use std::fmt;
use std::str::FromStr;

/// The contact law of a packing, with the parameters that do not follow from the material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ContactLaw {
    /// Hertz's normal spring with Mindlin's tangential spring; its stiffnesses follow from the material.
    #[default]
    HertzMindlin,
    /// Linear springs.
    Linear(Linear),
}

/// Work that is compiled for each law.
pub trait LawVisitor {
    /// The result.
    type Output;
    /// Does the work.
    fn visit<S: ContactSprings>(self, springs: S) -> Self::Output;
}

/// A name and parameters that belong to no contact law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnknownLaw {
    /// The name is unknown.
    #[error("unknown contact law \"{0}\"; known are {known}", known = known())]
    Name(String),
    /// The parameters are invalid.
    #[error(
        "parameters {found:?} of contact law {law} are invalid; it needs [{required}], each positive and finite"
    )]
    Parameters {
        /// Name of the law.
        law: &'static str,
        /// The parameters given.
        found: Vec<f64>,
        /// Keys of the parameters required.
        required: String,
    },
}

fn known() -> String {
    ContactLaw::examples().map(|law| law.name()).join(", ")
}

impl ContactLaw {
    /// One law of each kind, for tests and help.
    pub fn examples() -> [Self; 2] {
        [Self::HertzMindlin, Self::Linear(Linear { normal_stiffness: 1e4, stiffness_ratio: 0.5 })]
    }

    /// Name, as in scenes and messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::HertzMindlin => "hertz_mindlin",
            Self::Linear(_) => "linear",
        }
    }

    /// What the parameters of laws of this kind are. All must be positive and finite.
    pub fn parameter_list(&self) -> &'static [LawParameter] {
        match self {
            Self::HertzMindlin => &[],
            Self::Linear(_) => &Linear::PARAMETERS,
        }
    }

    /// Parameters, in the order of the list.
    pub fn parameters(&self) -> Vec<f64> {
        match self {
            Self::HertzMindlin => Vec::new(),
            Self::Linear(l) => vec![l.normal_stiffness, l.stiffness_ratio],
        }
    }

    /// The law of the same kind with these parameters, as many as the list has.
    fn with_parameters(&self, p: &[f64]) -> Self {
        match self {
            Self::HertzMindlin => Self::HertzMindlin,
            Self::Linear(_) => Self::Linear(Linear { normal_stiffness: p[0], stiffness_ratio: p[1] }),
        }
    }

    /// The law with this name and these parameters.
    ///
    /// # Errors
    /// The name is unknown, or the number of parameters or their range is wrong.
    pub fn new(name: &str, parameters: &[f64]) -> Result<Self, UnknownLaw> {
        let kind = Self::examples().into_iter().find(|law| law.name() == name);
        let kind = kind.ok_or_else(|| UnknownLaw::Name(name.to_owned()))?;
        let list = kind.parameter_list();
        if parameters.len() == list.len() && parameters.iter().all(|p| *p > 0.0 && p.is_finite()) {
            return Ok(kind.with_parameters(parameters));
        }
        let required: Vec<&str> = list.iter().map(|p| p.key).collect();
        let found = parameters.to_vec();
        Err(UnknownLaw::Parameters { law: kind.name(), found, required: required.join(", ") })
    }

    /// Does work that is compiled for each law, with the springs of this one.
    pub fn visit<V: LawVisitor>(&self, material: &Material, visitor: V) -> V::Output {
        match self {
            Self::HertzMindlin => visitor.visit(HertzMindlin::new(material)),
            Self::Linear(springs) => visitor.visit(*springs),
        }
    }

    /// Elastic normal force, N, for effective radius `r_eff` (m) and full overlap `overlap` (m, ≥ 0).
    pub fn normal_force(&self, material: &Material, r_eff: f64, overlap: f64) -> f64 {
        match self {
            Self::HertzMindlin => material.normal_force(r_eff, overlap),
            Self::Linear(l) => l.normal_stiffness * overlap,
        }
    }

    /// Stiffnesses (k_n, k_t), N/m, for effective radius `r_eff` (m) and full overlap `overlap` (m, ≥ 0).
    pub fn stiffnesses(&self, material: &Material, r_eff: f64, overlap: f64) -> (f64, f64) {
        match self {
            Self::HertzMindlin => {
                (material.normal_stiffness(r_eff, overlap), material.tangential_stiffness(r_eff, overlap))
            }
            Self::Linear(l) => (l.normal_stiffness, l.normal_stiffness * l.stiffness_ratio),
        }
    }
}

impl fmt::Display for ContactLaw {
    /// The name, and the parameters after a colon.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        let parameters: Vec<String> = self.parameters().iter().map(|p| format!("{p:?}")).collect();
        if parameters.is_empty() { Ok(()) } else { write!(f, ":{}", parameters.join(",")) }
    }
}

impl FromStr for ContactLaw {
    type Err = UnknownLaw;

    fn from_str(text: &str) -> Result<Self, UnknownLaw> {
        let (name, parameters) = text.split_once(':').unwrap_or((text, ""));
        let parameters = parameters.split(',').filter(|p| !p.is_empty()).map(str::parse);
        // A word that is no number is an invalid parameter.
        let parameters: Vec<f64> = parameters.map(|p| p.unwrap_or(f64::NAN)).collect();
        Self::new(name, &parameters)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_is_found_by_its_name_and_parameters() {
        for law in ContactLaw::examples() {
            assert_eq!(ContactLaw::new(law.name(), &law.parameters()), Ok(law));
            assert_eq!(law.to_string().parse(), Ok(law));
            assert!(ContactLaw::new(law.name(), &[f64::NAN]).is_err());
        }
        assert!(ContactLaw::new("hooke", &[]).unwrap_err().to_string().contains("hooke"));
        assert!(ContactLaw::new("linear", &[1e4, -1.0]).is_err());
    }
}
