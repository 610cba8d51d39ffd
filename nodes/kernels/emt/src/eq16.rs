//! Eqs. 13 and 16 as printed and as corrected.

use crate::moments::Moments;

/// A reading of Eqs. 13 and 16.
///
/// Both equations are printed without the factor a, [`Moments::spin`], on their first ε term; quadrature over the sphere confirms the factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eq16Reading {
    /// With the factor a.
    Corrected,
    /// Without it: the bulk modulus comes out too high by (2ε/5)(1−a), 1 % at ε = 0.03 and 6 % at ε = 0.17.
    AsPrinted,
}

impl Eq16Reading {
    /// Bracket of Eq. 13: ψ1 in units of C0 k.
    pub fn psi1_factor(self, eps: f64, g: f64) -> f64 {
        let a = Moments::new(eps, g).spin();
        match self {
            Eq16Reading::Corrected => 4.0 * eps / 5.0 * a - a * (28.0 + 16.0 * eps) / 35.0 * g,
            Eq16Reading::AsPrinted => 4.0 * eps / 5.0 - a * (28.0 + 16.0 * eps) / 35.0 * g,
        }
    }

    /// Bracket of Eq. 16, with a as an independent variable: the bulk modulus in units of the isotropic one with as many contacts. Corrected,
    /// it is 3 m1 + m2 = 1 − 4εg/5.
    pub fn bulk(self, eps: f64, a: f64, g: f64) -> f64 {
        match self {
            Eq16Reading::Corrected => 1.0 - 0.8 * eps * g,
            Eq16Reading::AsPrinted => {
                let m1 = Moments::new(eps, g).m1;
                (3.0 + 2.0 * a) * m1 + 0.4 * eps - a * (14.0 + 8.0 * eps) / 35.0 * g
            }
        }
    }
}
