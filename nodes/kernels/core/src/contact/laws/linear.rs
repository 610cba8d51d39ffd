//! Linear springs.
//!
//! F = k_n δ with the same k_n for every pair, k_t = ratio × k_n (Cundall & Strack, Géotechnique 29, 47 (1979)).

use crate::contact::law_parameter::LawParameter;
use crate::contact::springs::ContactSprings;
use crate::lanes::Lanes;

/// Springs of constant stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// Normal stiffness k_n, N/m. Positive.
    pub normal_stiffness: f64,
    /// k_t/k_n. Positive; usually 0.2 to 1.
    pub stiffness_ratio: f64,
}

impl Linear {
    /// Parameters in scenes and messages, in the order of the fields.
    pub const PARAMETERS: [LawParameter; 2] = [
        LawParameter::new("normal_stiffness", "N/m", "normal stiffness k_n", None, LawParameter::POSITIVE),
        LawParameter::new("stiffness_ratio", "", "k_t/k_n", Some(0.5), LawParameter::POSITIVE),
    ];
}

impl ContactSprings for Linear {
    #[inline(always)]
    fn normal_stiffness<L: Lanes>(&self, _: L, _: L) -> L {
        L::splat(self.normal_stiffness)
    }

    #[inline(always)]
    fn normal_force<L: Lanes>(&self, normal_stiffness: L, overlap: L) -> L {
        normal_stiffness * overlap
    }

    #[inline(always)]
    fn normal_energy<L: Lanes>(&self, normal_force: L, _: L, overlap: L) -> L {
        L::splat(0.5) * normal_force * overlap
    }

    #[inline(always)]
    fn tangential_stiffness<L: Lanes>(&self, _: L, _: L, factor: f64) -> L {
        L::splat(self.normal_stiffness * self.stiffness_ratio * factor)
    }

    fn stiffness_ratio(&self) -> f64 {
        self.stiffness_ratio
    }

    #[inline(always)]
    fn dashpot_ratio(&self) -> f64 {
        self.stiffness_ratio.sqrt()
    }

    #[inline(always)]
    fn unloading<L: Lanes>(&self, _: L, _: L, _: L) -> L {
        L::splat(1.0)
    }

    fn collision_overlap(&self, _: f64, m_eff: f64, speed: f64) -> f64 {
        speed * (m_eff / self.normal_stiffness).sqrt()
    }
}
