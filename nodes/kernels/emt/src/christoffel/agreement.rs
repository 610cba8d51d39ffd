//! Agreement of the speeds with one medium.

use crate::normal::is_beyond_chance;

/// Root mean square of the relative scatter of ρ v² up to which it is attributed to the sample. Over the azimuths of
/// packings of 2,000 grains it is 1 to 4 %, and it is inversely proportional to the root of their number.
pub(super) const OWN_SCATTER: f64 = 0.05;

/// Number of standard deviations from which a speed is an outlier if all others agree.
const STANDS_OUT: f64 = 10.0;

/// Speeds that contradict each other (less than once in a thousand times by chance): they scatter more than
/// those of a packing, or all but one agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedConflict {
    /// Index of the speed furthest from its prediction by the others.
    pub worst: usize,
    /// Distance of this speed, in its standard deviations.
    pub sigma: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Agreement {
    /// Within their errors.
    Within,
    /// Beyond their errors, possibly by the scatter of the sample.
    Beyond(SpeedConflict),
    /// With an outlier, or without degrees of freedom.
    Conflict(SpeedConflict),
}

/// Classifies relative residuals of speeds with these relative errors.
pub(super) fn agreement(
    residuals: &[f64],
    errors: &[f64],
    leverages: &[f64],
    degrees_of_freedom: usize,
) -> Agreement {
    let sigmas = residuals.iter().zip(errors).map(|(r, e)| (r / e).abs());
    let chi_square: f64 = sigmas.clone().map(|s| s * s).sum();
    // Without a degree of freedom the fit is exact, unless C13 + C44 > 0 limited it.
    if !is_beyond_chance(chi_square, degrees_of_freedom.max(1)) {
        return Agreement::Within;
    }
    // A speed attracts the fit: its residual is smaller than its error by its leverage.
    let own = sigmas.zip(leverages).map(|(s, h)| s / (1.0 - h).max(1e-6).sqrt());
    let Some((worst, sigma)) = own.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Agreement::Within;
    };
    let conflict = Agreement::Conflict(SpeedConflict { worst, sigma });
    if degrees_of_freedom == 0 {
        return conflict;
    }
    let others_agree = degrees_of_freedom > 1
        && !is_beyond_chance((chi_square - sigma * sigma).max(0.0), degrees_of_freedom - 1);
    if others_agree && sigma > STANDS_OUT {
        return conflict;
    }
    Agreement::Beyond(SpeedConflict { worst, sigma })
}
