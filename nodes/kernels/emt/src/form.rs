//! The one place where the printed equations and the corrected ones differ.

use crate::moments::Moments;

/// Which reading of Eqs. 13 and 16.
///
/// Both equations are printed without a factor a on their first ε term; quadrature over the sphere confirms the factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// With the factor a.
    Corrected,
    /// Without it: the bulk modulus comes out too high by (2ε/5)(1−a), 1 % at ε = 0.03 and 6 % at ε = 0.17.
    AsPrinted,
}

impl Form {
    /// Bracket of Eq. 13: ψ1 in units of C0 k.
    pub fn psi1_factor(self, eps: f64, g: f64) -> f64 {
        let a = Moments::new(eps, g).spin();
        match self {
            Form::Corrected => 4.0 * eps / 5.0 * a - a * (28.0 + 16.0 * eps) / 35.0 * g,
            Form::AsPrinted => 4.0 * eps / 5.0 - a * (28.0 + 16.0 * eps) / 35.0 * g,
        }
    }

    /// Bracket of Eq. 16: the bulk modulus in units of the isotropic one with as many contacts. Corrected, it is
    /// 3 m1 + m2 = 1 − 4εg/5.
    pub fn bulk_factor(self, eps: f64, g: f64) -> f64 {
        self.bulk(eps, Moments::new(eps, g).spin(), g)
    }

    /// The same with a as a variable of its own.
    pub(crate) fn bulk(self, eps: f64, a: f64, g: f64) -> f64 {
        match self {
            Form::Corrected => 1.0 - 0.8 * eps * g,
            Form::AsPrinted => {
                let m1 = Moments::new(eps, g).m1;
                (3.0 + 2.0 * a) * m1 + 0.4 * eps - a * (14.0 + 8.0 * eps) / 35.0 * g
            }
        }
    }
}
