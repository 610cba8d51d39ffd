//! How the overlap, and with it the stiffness of a contact, depends on its direction.
//!
//! The overlap of a contact at angle arccos x from the axis is (DΔ/3)(1 + 2g − 6gx²), and its stiffness is proportional
//! to the root of that. Eq. 10 expands the root to first order in g, which costs less than 0.006 in ε for g in [−0.3,
//! 0.1] and 0.1 at g = 1/4.

use crate::error::EmtError;

/// Integrals ∫₀¹ xⁿ s(x) dx, n = 0, 2, 4, 6, of a stiffness s(x), dimensionless.
pub(crate) type Integrals = [f64; 4];

/// g, if Eq. 10 gives every contact a positive stiffness.
pub(crate) fn check_eq_10(g: f64) -> Result<f64, EmtError> {
    if g > -1.0 && g < 0.5 {
        return Ok(g);
    }
    Err(EmtError::GammaOutOfRange { g, range: "(-1, 1/2)", law: "Eq. 10" })
}

/// Of the root itself, s = (1 + 2g − 6gx²)^½, in closed form, to rounding up to the ends of the range of g. Outside it
/// contacts near the equator or near the poles would be open.
pub(crate) fn nonlinear(g: f64) -> Result<Integrals, EmtError> {
    if !(-0.5..=0.25).contains(&g) {
        return Err(EmtError::GammaOutOfRange { g, range: "[-1/2, 1/4]", law: "the root of the overlap" });
    }
    // s² = a − b x².
    let (a, b) = (1.0 + 2.0 * g, 6.0 * g);
    Ok(if b.abs() <= 0.5 * a { series(a, b / a) } else { recurrence(a, b) })
}

/// The binomial series of √a (1 − qx²)^½ for |q| ≤ 1/2, integrated term by term.
fn series(a: f64, q: f64) -> Integrals {
    // Coefficients fall faster than 2⁻ʲ.
    const TERMS: u32 = 52;
    let mut sums = [0.0; 4];
    let mut coefficient = a.sqrt();
    for j in 0..TERMS {
        let j = f64::from(j);
        let mut n = 2.0 * j + 1.0;
        for sum in &mut sums {
            *sum += coefficient / n;
            n += 2.0;
        }
        coefficient *= q * (j - 0.5) / (j + 1.0);
    }
    sums
}

/// The elementary integral and (2n+2) b Iₙ = (2n−1) a Iₙ₋₁ − (a−b)^{3/2}, which loses a factor |a/b| < 2 per step.
fn recurrence(a: f64, b: f64) -> Integrals {
    let end = (a - b).max(0.0).sqrt();
    let side = b.abs().sqrt();
    // ∫₀¹ dx/s; where a = 0 it is multiplied by 0 and only has to be finite.
    let inverse =
        if b > 0.0 { side.atan2(end) } else { (side / a.max(f64::MIN_POSITIVE).sqrt()).asinh() } / side;
    let mut integrals = [0.5 * (end + a * inverse); 4];
    for i in 1..4 {
        let n = i as f64;
        integrals[i] = ((2.0 * n - 1.0) * a * integrals[i - 1] - end.powi(3)) / ((2.0 * n + 2.0) * b);
    }
    integrals
}
