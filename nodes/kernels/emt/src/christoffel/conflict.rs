//! Speeds that contradict each other.

/// Quantile of the standard normal distribution beyond which a misfit is called a conflict: one in a thousand.
const CONFLICT: f64 = 3.09;

/// Speeds that no medium has, within their uncertainty (a chance of less than one in a thousand).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedConflict {
    /// Index of the speed furthest from what the others say.
    pub worst: usize,
    /// How far, in its standard deviations.
    pub sigma: f64,
}

/// Whether χ² is too large for chance, by the cube-root approximation of Wilson and Hilferty.
pub(super) fn conflict(
    sigmas: &[f64],
    leverages: &[f64],
    degrees_of_freedom: usize,
) -> Option<SpeedConflict> {
    // Without a degree of freedom the fit is exact, or C13 + C44 = 0 stood in its way.
    let freedom = degrees_of_freedom.max(1) as f64;
    let chi_square: f64 = sigmas.iter().map(|s| s * s).sum();
    let spread = 2.0 / (9.0 * freedom);
    if (chi_square / freedom).cbrt() < 1.0 - spread + CONFLICT * spread.sqrt() {
        return None;
    }
    // A residual is smaller than the error by what the speed itself pulled the fit.
    let own = sigmas.iter().zip(leverages).map(|(s, h)| s.abs() / (1.0 - h).max(1e-6).sqrt());
    let (worst, sigma) = own.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(SpeedConflict { worst, sigma })
}
