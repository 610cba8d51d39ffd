//! How well speeds agree with one medium.

use super::chance::is_beyond_chance;

/// Root mean square of the relative scatter of ρ v² up to which it is taken for the sample's own. Over the azimuths of
/// packings of 2,000 grains it is 1 to 4 %, and it falls with the root of their number.
pub(super) const OWN_SCATTER: f64 = 0.05;

/// Standard deviations by which one speed must be off for it to be blamed, where all the others agree.
const STANDS_OUT: f64 = 10.0;

/// Speeds that no sample has, within their uncertainty (a chance of less than one in a thousand): either they scatter more
/// than those of a packing do, or all but one agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedConflict {
    /// Index of the speed furthest from what the others say.
    pub worst: usize,
    /// How far, in its standard deviations.
    pub sigma: f64,
}

/// Speeds that differ from those of a transversely isotropic medium by more than their errors, as those of a sample of
/// finitely many grains do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure {
    /// Root mean square of the relative differences of ρ v² that are the sample's own. Half of it is a relative error of every
    /// speed, in quadrature with its own: then χ² is as large as the degrees of freedom (R. C. Paule & J. Mandel, J. Res.
    /// Natl. Bur. Stand. 87, 377 (1982)). A speed that is known better than that has no more weight than another.
    pub scatter: f64,
}

/// How well speeds agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Agreement {
    /// Within their errors.
    Within,
    /// They scatter, which may be the sample's own scatter.
    Beyond(SpeedConflict),
    /// Not at all.
    Conflict(SpeedConflict),
}

/// Judges relative residuals of speeds with these relative errors.
pub(super) fn agreement(
    residuals: &[f64],
    errors: &[f64],
    leverages: &[f64],
    degrees_of_freedom: usize,
) -> Agreement {
    let sigmas = residuals.iter().zip(errors).map(|(r, e)| (r / e).abs());
    let chi_square: f64 = sigmas.clone().map(|s| s * s).sum();
    // Without a degree of freedom the fit is exact, or C13 + C44 = 0 stood in its way.
    if !is_beyond_chance(chi_square, degrees_of_freedom.max(1)) {
        return Agreement::Within;
    }
    // A residual is smaller than the error by what the speed itself pulled the fit.
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
