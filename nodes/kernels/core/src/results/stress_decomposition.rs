//! Shares of the stress that kinds of forces and of contacts carry.

use crate::tensor::{SymTensor, Vec3};

/// q/p below which a part of the deviatoric stress is not told.
const NO_DEVIATOR: f64 = 1e-3;

/// Love–Weber stress by kind of force and by network, Pa, positive in compression; symmetric parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StressDecomposition {
    /// (1/V) Σ F_n n ⊗ l.
    pub normal: SymTensor,
    /// (1/V) Σ f_t ⊗ l.
    pub tangential: SymTensor,
    /// Contacts that carry more than the mean normal force: F_n > ⟨F_n⟩.
    pub strong: SubNetwork,
    /// The other contacts.
    pub weak: SubNetwork,
    /// The stress-force-fabric relation; `None` without pressure on the contacts.
    pub stress_force_fabric: Option<StressForceFabric>,
}

/// The strong or the weak network.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SubNetwork {
    /// Number of its contacts.
    pub contacts: u32,
    /// ⟨n n⟩ of its contacts, trace 1, or zero without contacts.
    pub fabric: SymTensor,
    /// ε of its contacts about h (Eq. 20).
    pub contact_anisotropy: f64,
    /// The stress it carries, Pa; both networks add up to the stress.
    pub stress: SymTensor,
}

/// Second-order anisotropies of contacts and forces, and the deviatoric stress they predict.
///
/// Contact directions are distributed as (1/4π)(1 + a^c:nn), normal forces are on average f₀ (1 + a^n:nn), branch lengths
/// l₀ (1 + a^l:nn), tangential forces f₀ (a^t n − (n·a^t n) n); all four tensors are symmetric and traceless. Then
/// s/p = (2/5)(a^c + a^n + a^l + (3/2) a^t) to first order in the anisotropies (Rothenburg & Bathurst 1989 in 3D).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StressForceFabric {
    /// a^c = (15/2) dev L.
    pub contacts: SymTensor,
    /// a^n, least squares over contacts.
    pub normal_forces: SymTensor,
    /// a^l, least squares over contacts; rounding for grains of one size.
    pub branches: SymTensor,
    /// a^t, least squares over contacts.
    pub tangential_forces: SymTensor,
}

impl StressDecomposition {
    /// The stress, normal and tangential forces together, Pa.
    pub fn sum(&self) -> SymTensor {
        sum(&[(1.0, self.normal), (1.0, self.tangential)])
    }

    /// q/p; `None` without pressure.
    pub fn stress_ratio(&self) -> Option<f64> {
        let stress = self.sum();
        let pressure = stress.mean();
        (pressure > 0.0).then(|| stress.deviatoric_invariant() / pressure)
    }

    /// Pressure of `part` over the pressure; `None` without pressure.
    pub fn share_of_pressure(&self, part: &SubNetwork) -> Option<f64> {
        let pressure = self.sum().mean();
        (pressure > 0.0).then(|| part.stress.mean() / pressure)
    }

    /// s_part : s / s : s with s the stress deviator; `None` without pressure and where q/p is at most 1e-3.
    pub fn share_of_deviator(&self, part: &SubNetwork) -> Option<f64> {
        let stress = self.sum();
        let (pressure, q, s) = (stress.mean(), stress.deviatoric_invariant(), stress.deviator());
        (pressure > 0.0 && q > NO_DEVIATOR * pressure).then(|| part.stress.contract(&s) / s.contract(&s))
    }

    /// q of the stress of `part` over the whole pressure; `None` without pressure.
    pub fn deviator_over_pressure(&self, part: &SubNetwork) -> Option<f64> {
        let pressure = self.sum().mean();
        (pressure > 0.0).then(|| part.stress.deviatoric_invariant() / pressure)
    }

    /// Share of the contacts that are of `part`; `None` without contacts.
    pub fn share_of_contacts(&self, part: &SubNetwork) -> Option<f64> {
        let contacts = self.strong.contacts + self.weak.contacts;
        (contacts > 0).then(|| f64::from(part.contacts) / f64::from(contacts))
    }
}

impl StressForceFabric {
    /// s/p = (2/5)(a^c + a^n + a^l + (3/2) a^t), dimensionless: the deviatoric stress over the pressure that the
    /// anisotropies predict.
    ///
    /// From σ = (N_c/V) ∫ (1/4π)(1 + a^c:nn) f(n) ⊗ l(n) dΩ with ⟨n_i n_j⟩ = δ_ij/3 and
    /// ⟨n_i n_j n_k n_l⟩ = (δδ + δδ + δδ)/15 over the sphere: a^c, a^n and a^l each enter as (2/15) a, a^t as
    /// (1/3 − 2/15) a, over a mean of 1/3.
    ///
    /// ```
    /// use grainlab_core::results::StressForceFabric;
    /// use grainlab_core::SymTensor;
    /// let of = |a: f64| SymTensor::from_voigt([-a / 3.0, -a / 3.0, 2.0 * a / 3.0, 0.0, 0.0, 0.0]);
    /// let (contacts, normal_forces, tangential_forces) = (of(0.3), of(-0.2), of(0.1));
    /// let a = StressForceFabric { contacts, normal_forces, tangential_forces, ..Default::default() };
    /// // q/p = (2/5)(a_c + a_n + (3/2) a_t)
    /// assert!((a.stress_ratio().deviatoric_invariant() - 0.4 * (0.3 - 0.2 + 0.15)).abs() < 1e-15);
    /// ```
    pub fn stress_ratio(&self) -> SymTensor {
        let parts = [
            (0.4, self.contacts),
            (0.4, self.normal_forces),
            (0.4, self.branches),
            (0.6, self.tangential_forces),
        ];
        sum(&parts)
    }

    /// (3/2) h·a·h of one of the tensors: a of a distribution 1 + a (x² − 1/3) about the unit vector `axis`.
    pub fn along(tensor: &SymTensor, axis: &Vec3) -> f64 {
        1.5 * tensor.along(axis)
    }
}

fn sum(parts: &[(f64, SymTensor)]) -> SymTensor {
    SymTensor::from_voigt(std::array::from_fn(|k| parts.iter().map(|(w, t)| w * t.voigt()[k]).sum()))
}
