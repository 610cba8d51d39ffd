//! Moments of the contact distribution, from which all moduli follow.

/// Moments of the stiffness-weighted contact distribution,
/// M_jk = ∫ (1/4π) [(1−ε) + 3εx²] [(1+g) − 3gx²] d_j d_k dΩ = m1 δ_jk + m2 h_j h_k, with x = d·h: contact anisotropy ε
/// (Eq. 6) times the linear overlap law (Eq. 10) with g = γ/Δ. Equivalent to Appendix A.
///
/// ```
/// // Isotropic: a third of the unit tensor.
/// assert_eq!(grainlab_emt::Moments::new(0.0, 0.0), grainlab_emt::Moments { m1: 1.0 / 3.0, m2: 0.0 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// Isotropic part m1, dimensionless.
    pub m1: f64,
    /// Axial part m2, dimensionless.
    pub m2: f64,
}

impl Moments {
    /// Moments for contact anisotropy `eps` and strain ratio `g` = γ/Δ, dimensionless. The contact density is positive
    /// for ε in [−1/2, 1], the stiffness of every contact for g in (−1, 1/2); the polynomials hold anywhere.
    pub fn new(eps: f64, g: f64) -> Self {
        Self {
            m1: 1.0 / 3.0 - 2.0 * eps / 15.0 + (14.0 - 20.0 * eps) * g / 105.0,
            m2: 2.0 * eps / 5.0 - 2.0 * g / 5.0 - 8.0 * eps * g / 35.0,
        }
    }

    /// The paper's a = m2/(2 m1 + m2): relative spin R13 = −a E13 that keeps the stress symmetric, and G13/G12 − 1.
    pub fn spin(&self) -> f64 {
        self.m2 / (2.0 * self.m1 + self.m2)
    }

    /// Trace 3 m1 + m2 = 1 − 4εg/5: the bulk modulus in units of the isotropic one with as many contacts.
    pub fn trace(&self) -> f64 {
        3.0 * self.m1 + self.m2
    }
}

/// The ε whose moments have spin `a` at strain ratio `g`: ε = [a(35−7g) + 21g] / [(21−12g) − a(7−32g)]. `None` if there is no
/// such ε with M11 > 0 and M33 > 0.
pub(crate) fn eps_of_spin(a: f64, g: f64) -> Option<f64> {
    let numerator = a * (35.0 - 7.0 * g) + 21.0 * g;
    let denominator = (21.0 - 12.0 * g) - a * (7.0 - 32.0 * g);
    let eps = numerator / denominator;
    let m = Moments::new(eps, g);
    (denominator > 0.0 && m.m1 > 0.0 && m.m1 + m.m2 > 0.0).then_some(eps)
}
