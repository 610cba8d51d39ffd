//! The laws of springs: one file each, and the list of them.
//!
//! To add a law: write its file, and add it here. Scenes, messages, engine and measurements take it from this list. Its closed
//! form and its golden trajectory belong into the tests of contact laws in `grainlab_dem`.

mod hertz_mindlin;
mod linear;
mod rough;

pub use hertz_mindlin::HertzMindlin;
pub use linear::Linear;
pub use rough::{Rough, RoughSprings};

use crate::contact::law_parameter::LawParameter;
use crate::contact::springs::{ContactSprings, LawVisitor};
use crate::material::Material;

/// The springs of a contact law, with the parameters that do not follow from the material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SpringLaw {
    /// Hertz's normal spring with Mindlin's tangential spring; its stiffnesses follow from the material.
    #[default]
    HertzMindlin,
    /// Springs of constant stiffness.
    Linear(Linear),
    /// Springs of rough grains: those of Hertz and Mindlin, softer at small overlaps.
    Rough(Rough),
}

impl SpringLaw {
    /// Every law of springs, in the order of [`SpringLaw::NAMES`]; parameters are examples.
    pub const EXAMPLES: [Self; 3] = [
        Self::HertzMindlin,
        Self::Linear(Linear { normal_stiffness: 1e4, stiffness_ratio: 0.5 }),
        Self::Rough(Rough { roughness: 5e-9, tangential_factor: 0.8 }),
    ];

    /// Names, as in scenes and messages.
    pub const NAMES: [&'static str; 3] =
        [Self::EXAMPLES[0].name(), Self::EXAMPLES[1].name(), Self::EXAMPLES[2].name()];

    /// Name, as in scenes and messages.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::HertzMindlin => "hertz_mindlin",
            Self::Linear(_) => "linear",
            Self::Rough(_) => "rough",
        }
    }

    /// Parameters of springs of this kind.
    pub fn parameter_list(&self) -> &'static [LawParameter] {
        match self {
            Self::HertzMindlin => &[],
            Self::Linear(_) => &Linear::PARAMETERS,
            Self::Rough(_) => &Rough::PARAMETERS,
        }
    }

    /// Parameters, in the order of the list.
    pub fn parameters(&self) -> Vec<f64> {
        match self {
            Self::HertzMindlin => Vec::new(),
            Self::Linear(l) => vec![l.normal_stiffness, l.stiffness_ratio],
            Self::Rough(r) => vec![r.roughness, r.tangential_factor],
        }
    }

    /// Springs of the same kind with these parameters, whose range is not checked; `None` where they are not as many as in the
    /// list.
    pub fn with_parameters(&self, p: &[f64]) -> Option<Self> {
        match (self, p) {
            (Self::HertzMindlin, []) => Some(Self::HertzMindlin),
            (Self::Linear(_), &[normal_stiffness, stiffness_ratio]) => {
                Some(Self::Linear(Linear { normal_stiffness, stiffness_ratio }))
            }
            (Self::Rough(_), &[roughness, tangential_factor]) => {
                Some(Self::Rough(Rough { roughness, tangential_factor }))
            }
            _ => None,
        }
    }

    /// Does work that is compiled for each law, with these springs.
    pub fn visit<V: LawVisitor>(&self, material: &Material, visitor: V) -> V::Output {
        match self {
            Self::HertzMindlin => visitor.visit(HertzMindlin::new(material)),
            Self::Linear(springs) => visitor.visit(*springs),
            Self::Rough(rough) => visitor.visit(rough.springs(material)),
        }
    }

    /// Elastic normal force, N, for effective radius `r_eff` (m) and full overlap `overlap` (m, ≥ 0).
    pub fn normal_force(&self, material: &Material, r_eff: f64, overlap: f64) -> f64 {
        match self {
            Self::HertzMindlin => material.normal_force(r_eff, overlap),
            Self::Linear(l) => l.normal_stiffness * overlap,
            Self::Rough(r) => {
                let k_n = self.stiffnesses(material, r_eff, overlap).0;
                r.springs(material).normal_force(k_n, overlap)
            }
        }
    }

    /// Stiffnesses (k_n, k_t), N/m, for effective radius `r_eff` (m) and full overlap `overlap` (m, ≥ 0).
    pub fn stiffnesses(&self, material: &Material, r_eff: f64, overlap: f64) -> (f64, f64) {
        match self {
            Self::HertzMindlin => {
                (material.normal_stiffness(r_eff, overlap), material.tangential_stiffness(r_eff, overlap))
            }
            Self::Linear(l) => (l.normal_stiffness, l.normal_stiffness * l.stiffness_ratio),
            Self::Rough(r) => {
                let (springs, contact_radius) = (r.springs(material), (r_eff * overlap).sqrt());
                let k_t = springs.tangential_stiffness(contact_radius, overlap, 1.0);
                (springs.normal_stiffness(contact_radius, overlap), k_t)
            }
        }
    }
}
