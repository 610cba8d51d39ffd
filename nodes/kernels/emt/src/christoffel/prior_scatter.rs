//! Scatter of the speeds of a sample of finitely many grains about one medium, known before they are measured.
//!
//! Over the azimuths of 540 states of 2,000 grains and 90 of 8,000, by fifteen recipes (z 4.2 to 6.4, grains of equal and unequal
//! sizes), ρ v² differs from that of the transversely isotropic projection of the stiffness by 0.6 to 3 % (S) and 0.6 to 1.2 % (P) at
//! 2,000 grains. The scatter is inversely proportional to the root of the number of grains, and it is a power of the distance from
//! isostaticity, for which the measured ratio of shear to bulk modulus stands as well as z: the logarithm of the scatter of one state is
//! within 0.3 (one standard deviation). Three rays cannot measure it: they see each part of the departure once.

use super::error::ChristoffelError;
use super::ray::{Column, Ray};
use super::{fit, weights};

/// Number of grains at which the laws below were fitted.
const GRAINS: f64 = 2000.0;

/// Relative scatter of ρ v² of P and of S waves at G = Θ, and its power of G/Θ.
const P: [f64; 2] = [0.0073, -0.80];
const S: [f64; 2] = [0.0070, -1.53];

/// G/Θ where the speeds do not determine it.
const TYPICAL: f64 = 0.6;

/// Number of degrees of freedom that the laws count for, by the scatter of single states about them.
const WORTH: f64 = 7.0;

/// Relative precision of the error found.
const PRECISION: f64 = 1e-4;

/// Least and greatest scatter over that of the laws.
const RANGE: [f64; 2] = [0.05, 50.0];

/// A fit with the scatter of the sample as an error of each speed.
pub(super) struct ScatteredFit {
    /// Root mean square of the relative error added, and that before the speeds were measured.
    pub(super) added: f64,
    pub(super) usual: f64,
    pub(super) fit: fit::Fit,
    /// Error of a speed of weight 1.
    pub(super) unit: Option<f64>,
}

/// Relative standard deviation of each speed that is due to the sample.
///
/// The wave along the axis sees no azimuth; waves across it see all of the departure.
pub(super) fn prior(rays: &[Ray], specific: &Column, is_determined: bool, grains: f64) -> Vec<f64> {
    let [c11, c33, c13, c44, c66] = (*specific).into();
    let (shear, bulk) = ((2.0 * c44 + c66) / 3.0, (4.0 * c11 + c33 + 4.0 * c13 - 4.0 * c66) / 9.0);
    let ratio = Some(shear / bulk).filter(|r| is_determined && (0.05..5.0).contains(r)).unwrap_or(TYPICAL);
    let size = (GRAINS / grains).sqrt();
    let of = |ray: &Ray| {
        let across = ray.sin_squared();
        let ([scale, power], share) = match (ray.is_transverse(), ray.is_horizontal()) {
            (false, _) => (P, 0.3 + 1.15 * across),
            (true, true) => (S, 0.85 + 0.55 * (2.0 * across).min(1.0)),
            (true, false) => (S, 0.85),
        };
        0.5 * size * share * scale * ratio.powf(power)
    };
    rays.iter().map(of).collect()
}

/// The fit with the scatter of the sample as an error of each speed: that of the laws times a factor f with
/// χ² + ν/f² = n + ν, where n are the degrees of freedom of the speeds and ν those that the laws count for. Many speeds
/// determine the scatter themselves.
pub(super) fn with_prior(
    rays: &[Ray],
    errors: &[f64],
    sharp: &fit::Fit,
    grains: f64,
) -> Result<ScatteredFit, ChristoffelError> {
    let prior = prior(rays, &sharp.specific, sharp.open.is_empty(), grains);
    let fitted = |factor: f64| {
        let all: Vec<f64> = errors.iter().zip(&prior).map(|(e, p)| e.hypot(factor * p)).collect();
        let (weights, unit) = weights::weights(Some(&all), rays.len());
        let fit = fit::fit(rays, &weights, unit)?;
        let chi_square: f64 = fit.residuals.iter().zip(&all).map(|(r, e)| (r / e).powi(2)).sum();
        let freedom = rays.len().saturating_sub(fit.rank) as f64;
        let excess = chi_square + WORTH / factor.powi(2) - freedom - WORTH;
        Ok((fit, unit, excess))
    };
    let (factor, fit, unit) = tightest(RANGE, |low, high| (low * high).sqrt(), fitted)?;
    let mean = (prior.iter().map(|p| p * p).sum::<f64>() / prior.len() as f64).sqrt();
    Ok(ScatteredFit { added: factor * mean, usual: mean, fit, unit })
}

/// The least error in a range whose fit has no excess of χ², by bisection at `middle`, with this fit and its error of a speed of weight 1.
/// `fitted`: fit, error of a speed of weight 1 and excess of χ².
pub(super) fn tightest(
    [mut low, mut high]: [f64; 2],
    middle: impl Fn(f64, f64) -> f64,
    fitted: impl Fn(f64) -> Result<(fit::Fit, Option<f64>, f64), ChristoffelError>,
) -> Result<(f64, fit::Fit, Option<f64>), ChristoffelError> {
    let mut best = fitted(high)?;
    while high - low > PRECISION * high {
        let at = middle(low, high);
        let next = fitted(at)?;
        if next.2 > 0.0 {
            low = at;
        } else {
            (high, best) = (at, next);
        }
    }
    Ok((high, best.0, best.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::{Vec3, WaveSpeed};

    fn rays() -> Vec<Ray> {
        let wave = |direction: Vec3, polarization: Vec3| WaveSpeed {
            direction,
            polarization,
            speed: 1.0,
            stddev: None,
        };
        let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
        let of = |(k, w): (usize, &WaveSpeed)| Ray::new(k, w, &z, false).unwrap();
        [wave(z, z), wave(x, x), wave(x, z), wave(x, y)].iter().enumerate().map(of).collect()
    }

    #[test]
    fn samples_of_more_grains_scatter_less_and_soft_ones_more() {
        // z 5.5 and z 4.3: G/Theta .8 and .27.
        let firm = Column::from([2.5, 2.6, 0.6, 0.93, 0.9]);
        let soft = Column::from([2.5, 2.6, 1.6, 0.5, 0.5]);
        let (firm_scatter, soft_scatter) =
            (prior(&rays(), &firm, true, 2e3), prior(&rays(), &soft, true, 2e3));
        assert!(firm_scatter.iter().zip(&soft_scatter).all(|(f, s)| f < s));
        assert!(
            (0.003..0.010).contains(&firm_scatter[3]) && (0.010..0.050).contains(&soft_scatter[3]),
            "{soft_scatter:?}"
        );
        let large = prior(&rays(), &firm, true, 8e3);
        assert!(large.iter().zip(&firm_scatter).all(|(l, f)| (l / f - 0.5).abs() < 1e-12));
        assert!(firm_scatter[0] < 0.3 * firm_scatter[1]);
    }
}
