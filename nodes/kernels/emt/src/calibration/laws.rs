//! The laws of a relaxed network: its invariants and its rattlers as functions of structure and state.

use serde::{Deserialize, Serialize};

/// Coordination number at which a network of frictional grains is isostatic: 3 z/2 force components for 6 degrees of
/// freedom per grain. Its response to a change of coordination diverges there.
pub const ISOSTATIC: f64 = 4.0;

/// p/E* at which the terms in the pressure vanish.
pub(crate) const REFERENCE_PRESSURE: f64 = 1e-6;

/// k_t/k_n at which the terms in it vanish: that of Mindlin contacts for ν = 0.2.
pub(crate) const REFERENCE_STIFFNESS_RATIO: f64 = 8.0 / 9.0;

/// The known state of a packing, as the laws take it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkState {
    /// ln of p/E* over 1e-6.
    pub ln_pressure: f64,
    /// k_t/k_n − 8/9 of the contacts.
    pub stiffness_ratio: f64,
    /// Variance of the radii over the square of their mean.
    pub size_variance: f64,
    /// (σ_33 − (σ_11 + σ_22)/2)/p.
    pub stress_ratio: f64,
}

/// z/(z − 4). Where a modulus is proportional to (z − 4)/z, more contacts in one direction change it by d ln G/d ln z =
/// 4/(z − 4).
fn critical(z: f64) -> f64 {
    z / (z - ISOSTATIC)
}

fn critical_slope(z: f64) -> f64 {
    -ISOSTATIC / (z - ISOSTATIC).powi(2)
}

/// ln X = a + b ln z + c ln(z − z0) + d ln p + e κ + f s² + (g κ + h ln p) ln z, with κ = k_t/k_n − 8/9, p as in
/// [`NetworkState::ln_pressure`] and s² the variance of the radii.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScalingLaw {
    /// Coefficients a to h.
    pub coefficients: [f64; 8],
    /// z0, below every z of the packings.
    pub onset: f64,
}

impl ScalingLaw {
    /// The terms that the coefficients multiply.
    pub fn terms(z: f64, onset: f64, state: &NetworkState) -> [f64; 8] {
        let (ln_z, ln_p, kappa) = (z.ln(), state.ln_pressure, state.stiffness_ratio);
        [1.0, ln_z, (z - onset).ln(), ln_p, kappa, state.size_variance, kappa * ln_z, ln_p * ln_z]
    }

    /// Logarithm of X.
    pub fn value(&self, z: f64, state: &NetworkState) -> f64 {
        dot(&self.coefficients, &Self::terms(z, self.onset, state))
    }

    /// d ln X/dz.
    pub(crate) fn slope(&self, z: f64, state: &NetworkState) -> f64 {
        let [_, by_z, by_excess, _, _, _, by_stiffness_ratio, by_pressure] = self.coefficients;
        let by_ln_z = by_z + by_stiffness_ratio * state.stiffness_ratio + by_pressure * state.ln_pressure;
        by_ln_z / z + by_excess / (z - self.onset)
    }

    /// d ln X/ds².
    pub(crate) fn by_size_variance(&self) -> f64 {
        self.coefficients[5]
    }

    /// d ln X/dκ.
    pub(crate) fn by_stiffness_ratio(&self, z: f64) -> f64 {
        self.coefficients[4] + self.coefficients[6] * z.ln()
    }
}

/// The anisotropy of a network: X = ε (a0 + a1 u + a2 s² + a3 κ + a4 ln p + a5 u ln p + a6 z + a7 u κ) + q/p (b0 + b1 u +
/// b2 u ln p) with u = z/(z − 4) and κ = k_t/k_n − 8/9. The second group: at the same ε, a stress deviator changes the
/// stiffness of the contacts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeviatorLaw {
    /// a0 to a7.
    pub by_eps: [f64; 8],
    /// b0 to b2.
    pub by_stress_ratio: [f64; 3],
}

impl DeviatorLaw {
    /// Number of coefficients.
    pub const TERMS: usize = 11;

    /// The terms that the coefficients multiply, those of ε first.
    pub fn terms(z: f64, eps: f64, state: &NetworkState) -> [f64; Self::TERMS] {
        let [a0, a1, a2, a3, a4, a5, a6, a7] = Self::factors(z, state).map(|f| f * eps);
        let [b0, b1, b2] = Self::stress_factors(z, state).map(|f| f * state.stress_ratio);
        [a0, a1, a2, a3, a4, a5, a6, a7, b0, b1, b2]
    }

    fn factors(z: f64, state: &NetworkState) -> [f64; 8] {
        let (u, ln_p, kappa) = (critical(z), state.ln_pressure, state.stiffness_ratio);
        [1.0, u, state.size_variance, kappa, ln_p, u * ln_p, z, u * kappa]
    }

    fn stress_factors(z: f64, state: &NetworkState) -> [f64; 3] {
        let u = critical(z);
        [1.0, u, u * state.ln_pressure]
    }

    /// The law with these coefficients, in the order of the terms.
    pub fn new(coefficients: [f64; Self::TERMS]) -> Self {
        let [a0, a1, a2, a3, a4, a5, a6, a7, by_stress_ratio @ ..] = coefficients;
        Self { by_eps: [a0, a1, a2, a3, a4, a5, a6, a7], by_stress_ratio }
    }

    pub(crate) fn by_eps(&self, z: f64, state: &NetworkState) -> f64 {
        dot(&self.by_eps, &Self::factors(z, state))
    }

    pub(crate) fn by_stress_ratio(&self, z: f64, state: &NetworkState) -> f64 {
        dot(&self.by_stress_ratio, &Self::stress_factors(z, state))
    }

    /// Value of X.
    pub fn value(&self, z: f64, eps: f64, state: &NetworkState) -> f64 {
        self.by_eps(z, state) * eps + self.by_stress_ratio(z, state) * state.stress_ratio
    }

    /// Derivative by z.
    pub(crate) fn slope(&self, z: f64, eps: f64, state: &NetworkState) -> f64 {
        let [_, a1, _, _, _, a5, a6, a7] = self.by_eps;
        let of_eps = a1 + a5 * state.ln_pressure + a7 * state.stiffness_ratio;
        let of_stress = self.by_stress_ratio[1] + self.by_stress_ratio[2] * state.ln_pressure;
        (of_eps * eps + of_stress * state.stress_ratio) * critical_slope(z) + a6 * eps
    }
}

/// k = a + b z + c z² + d z³ + e ln p + f s² + g z s²: the coordination number with rattlers counted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RattlerLaw(pub [f64; 7]);

impl RattlerLaw {
    /// The terms that the coefficients multiply.
    pub fn terms(z: f64, state: &NetworkState) -> [f64; 7] {
        let s2 = state.size_variance;
        [1.0, z, z * z, z * z * z, state.ln_pressure, s2, z * s2]
    }

    /// Coordination number k.
    pub fn value(&self, z: f64, state: &NetworkState) -> f64 {
        dot(&self.0, &Self::terms(z, state))
    }

    /// Derivative by z.
    pub(crate) fn slope(&self, z: f64, state: &NetworkState) -> f64 {
        let [_, b, c, d, _, _, g] = self.0;
        b + 2.0 * c * z + 3.0 * d * z * z + g * state.size_variance
    }
}

fn dot<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
