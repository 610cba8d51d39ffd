//! Contact laws: springs, dashpots and sliders of a contact.
//!
//! A law is its springs ([`ContactSprings`]). Dashpots, tangential history and the Coulomb limit are the same for all
//! ([`SpringDashpotSlider`]), and so is the resistance to rolling, which any law may have ([`RollingResistance`]). The
//! springs are listed in `laws`.

mod law_parameter;
mod laws;
mod rolling;
mod rolling_resistance;
mod spring_dashpot_slider;
mod springs;
mod tangential;

pub use law_parameter::LawParameter;
pub use laws::*;
pub use rolling::{RollingForce, RollingSprings};
pub use rolling_resistance::RollingResistance;
pub use spring_dashpot_slider::{ContactForces, ContactKinematics, HistoryStep, SpringDashpotSlider};
pub use springs::{ContactSprings, LawVisitor};
pub use tangential::TangentialLaw;

use crate::material::Material;
use std::fmt;
use std::str::FromStr;

/// The contact law of a packing: springs, and resistance to rolling if there is any.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactLaw {
    /// The normal and the tangential spring.
    pub springs: SpringLaw,
    /// The resistance to rolling.
    pub rolling: Option<RollingResistance>,
}

/// A name and parameters that belong to no contact law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnknownLaw {
    /// The name is unknown.
    #[error("unknown contact law \"{0}\"; known are {known}", known = SpringLaw::NAMES.join(", "))]
    Name(String),
    /// The parameters are invalid.
    #[error(
        "parameters {found:?} of contact law {law} are invalid; it needs [{springs}], and with resistance to rolling \
         [{rolling}] after them, each positive and finite (a roughness or damping may be 0, a tangential factor is at most 1)"
    )]
    Parameters {
        /// Name of the law.
        law: &'static str,
        /// The parameters given.
        found: Vec<f64>,
        /// Keys of the parameters of its springs.
        springs: String,
        /// Keys of the parameters of a resistance to rolling.
        rolling: String,
    },
}

struct WithRolling<V> {
    rolling: Option<RollingResistance>,
    visitor: V,
}

impl<V: LawVisitor> LawVisitor for WithRolling<V> {
    type Output = V::Output;

    fn visit<S: ContactSprings>(self, springs: S) -> V::Output {
        match self.rolling {
            None => self.visitor.visit(springs),
            Some(rolling) => self.visitor.visit(RollingSprings { springs, rolling }),
        }
    }
}

impl ContactLaw {
    /// A law without resistance to rolling.
    pub const fn of(springs: SpringLaw) -> Self {
        Self { springs, rolling: None }
    }

    /// The law with this resistance to rolling.
    #[must_use]
    pub const fn with_rolling(self, rolling: RollingResistance) -> Self {
        Self { rolling: Some(rolling), ..self }
    }

    /// One law of each kind, for tests: all springs, first without and then with resistance to rolling.
    pub fn examples() -> Vec<Self> {
        let plain = SpringLaw::EXAMPLES.map(Self::of);
        let rolling = RollingResistance { stiffness: 1e4, damping: 1e-3, friction: 0.1 };
        plain.into_iter().chain(plain.map(|law| law.with_rolling(rolling))).collect()
    }

    /// Name of the springs, as in scenes and messages.
    pub fn name(&self) -> &'static str {
        self.springs.name()
    }

    /// Parameters as in messages: those of the springs, then those of the resistance to rolling if there is any.
    pub fn parameters(&self) -> Vec<f64> {
        let rolling = self.rolling.iter().flat_map(RollingResistance::parameters);
        self.springs.parameters().into_iter().chain(rolling).collect()
    }

    /// The law with springs of this name and these parameters, in the order of [`ContactLaw::parameters`].
    ///
    /// # Errors
    /// The name is unknown, or the number of parameters or their range is wrong.
    pub fn new(name: &str, parameters: &[f64]) -> Result<Self, UnknownLaw> {
        let kind = SpringLaw::EXAMPLES.into_iter().find(|springs| springs.name() == name);
        let kind = kind.ok_or_else(|| UnknownLaw::Name(name.to_owned()))?;
        let own = kind.parameter_list();
        let all: Vec<&LawParameter> = own.iter().chain(&RollingResistance::PARAMETERS).collect();
        let count = parameters.len();
        let complete = count == own.len() || count == all.len();
        if complete && all.iter().zip(parameters).all(|(parameter, value)| parameter.admits(*value)) {
            let (springs, rolling) = parameters.split_at(own.len());
            let rolling = rolling.try_into().ok().map(RollingResistance::from_parameters);
            if let Some(springs) = kind.with_parameters(springs) {
                return Ok(Self { springs, rolling });
            }
        }
        let keys = |list: &[LawParameter]| list.iter().map(|p| p.key).collect::<Vec<_>>().join(", ");
        Err(UnknownLaw::Parameters {
            law: kind.name(),
            found: parameters.to_vec(),
            springs: keys(own),
            rolling: keys(&RollingResistance::PARAMETERS),
        })
    }

    /// Does work that is compiled for each law, with the springs of this one.
    pub fn visit<V: LawVisitor>(&self, material: &Material, visitor: V) -> V::Output {
        self.springs.visit(material, WithRolling { rolling: self.rolling, visitor })
    }

    /// Elastic normal force, N, for effective radius `r_eff` (m) and full overlap `overlap` (m, ≥ 0).
    pub fn normal_force(&self, material: &Material, r_eff: f64, overlap: f64) -> f64 {
        self.springs.normal_force(material, r_eff, overlap)
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
        assert!(
            ContactLaw::new("rough", &[0.0, 1.0]).is_ok() && ContactLaw::new("rough", &[1e-9, 1.1]).is_err()
        );
        // Resistance to rolling may lack a dashpot, but no parameter.
        let undamped = ContactLaw::new("hertz_mindlin", &[1e4, 0.0, 0.1]).unwrap();
        assert_eq!(undamped.rolling, Some(RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 }));
        for wrong in [&[0.0, 1e-3, 0.1][..], &[1e4, 1e-3, 0.0], &[1e4, 1e-3], &[1e4, -1.0, 0.1]] {
            assert!(ContactLaw::new("hertz_mindlin", wrong).is_err(), "{wrong:?}");
        }
    }
}
