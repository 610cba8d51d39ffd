//! The moduli of the medium that fits wave speeds best.

use super::agreement::{self, Agreement, SpeedConflict};
use super::error::ChristoffelError;
use super::prior_scatter::{self, ScatteredFit, tightest};
use super::ray::{self, Ray};
use super::weights::{errors, weights};
use super::{departure, determined, fit};
use crate::conditions::{Conditions, Measured};
use crate::moduli::{Moduli, Modulus};
use crate::observation::Observation;
use grainlab_core::{Vec3, WaveSpeed};

/// Scatter over the usual one of a sample beyond which the speeds are in conflict.
const UNUSUAL: f64 = 3.0;

/// Moduli from wave speeds, and how well the speeds agree.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedFit {
    /// The moduli that the speeds determine, with the axis as e3, and their covariance if any speed has an uncertainty.
    pub observation: Observation,
    /// The moduli that the speeds do not determine.
    pub undetermined: Vec<Modulus>,
    /// Weighted sum of squares of measured minus fitted speeds; `None` if their uncertainty is not known.
    pub chi_square: Option<f64>,
    /// Number of speeds minus number of combinations of moduli that they determine.
    pub degrees_of_freedom: usize,
    /// For each speed, measured minus fitted over measured.
    pub residuals: Vec<f64>,
    /// Number of speeds without an uncertainty, where others have one. They are given the largest relative one of the
    /// others.
    pub assumed: usize,
    /// Set if the speeds contradict each other beyond their uncertainty and beyond the deviation of a sample
    /// of some thousand grains from a transversely isotropic medium. Contains the speed that deviates most.
    pub conflict: Option<SpeedConflict>,
    /// Set if they differ beyond their uncertainty, but not more than those of such a sample: the root mean square of the
    /// relative differences of ρ v² from those of a transversely isotropic medium that are due to the sample. Half of it
    /// is added in quadrature to the relative error of every speed, which makes χ² equal to the degrees of freedom (R.
    /// C. Paule & J. Mandel, J. Res. Natl. Bur. Stand. 87, 377 (1982)). It bounds the weight of very accurate speeds.
    pub anisotropy_scatter: Option<f64>,
}

impl SpeedFit {
    /// Root mean square of the relative residuals per degree of freedom: an estimate of the relative error of the
    /// speeds from their scatter alone; `None` without a degree of freedom.
    pub fn scatter(&self) -> Option<f64> {
        let sum: f64 = self.residuals.iter().map(|r| r * r).sum();
        (self.degrees_of_freedom > 0).then(|| (sum / self.degrees_of_freedom as f64).sqrt())
    }
}

/// The moduli of a medium that is isotropic about `axis` from the speeds of its waves, with the density of the mass
/// that moves with them, kg/m³, in the state `conditions`.
///
/// The moduli are those of a frame with the axis as e3. Any set of speeds is valid; [`SpeedFit::undetermined`] lists
/// the moduli that it does not determine. If no speed has an uncertainty, equal relative errors are taken, and the
/// moduli have none either. Errors of speeds are independent; the error of the density is common to all moduli. If
/// speeds scatter more than their errors, but not more than those of a packing, which is never exactly isotropic about
/// an axis, the scatter is added to the error of every speed ([`SpeedFit::anisotropy_scatter`]).
///
/// Errors: an unknown axis, vectors that are not of unit length, numbers that are not positive and finite, a
/// polarization more than 30° from every mode of its direction, and speeds of an unstable medium. If both S waves along
/// a direction were measured, their polarizations may be any two perpendicular ones: their speeds are nearly equal, so
/// that a small departure from isotropy about the axis turns them.
///
/// ```
/// use grainlab_emt::{Conditions, Measured, Modulus, christoffel};
/// use grainlab_core::{Vec3, WaveSpeed};
/// let wave = |direction, polarization, speed| WaveSpeed { direction, polarization, speed, stddev: Some(0.003 * speed) };
/// let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
/// let speeds = [wave(z, z, 500.0), wave(x, x, 480.0), wave(z, x, 300.0), wave(x, z, 301.0), wave(x, y, 290.0)];
/// let density = Measured { value: 1600.0, stddev: 8.0 };
/// let fitted = christoffel::moduli_from_speeds(&speeds, density, Some(z), Conditions::at(50e3)).unwrap();
/// let c33 = fitted.observation.moduli.get(Modulus::C33).unwrap();
/// assert!((c33 - 1600.0 * 500.0 * 500.0).abs() < 1e-3);
/// assert_eq!(fitted.undetermined, [Modulus::Theta, Modulus::C13]);
/// assert_eq!((fitted.degrees_of_freedom, fitted.conflict), (1, None));
/// ```
pub fn moduli_from_speeds(
    speeds: &[WaveSpeed],
    density: Measured,
    axis: Option<Vec3>,
    conditions: Conditions,
) -> Result<SpeedFit, ChristoffelError> {
    moduli_of_sample(speeds, density, axis, conditions, None)
}

/// Moduli of a sample of so many `grains`, 1 or more, if their number is known: the scatter that samples of this size and stiffness
/// have is then part of the errors of the moduli, also where the speeds are too few to show it.
pub fn moduli_of_sample(
    speeds: &[WaveSpeed],
    density: Measured,
    axis: Option<Vec3>,
    conditions: Conditions,
    grains: Option<f64>,
) -> Result<SpeedFit, ChristoffelError> {
    let rays = rays(speeds, axis)?;
    let of_density = "kg/m3 must be positive and finite: that of the mass that moves with the wave";
    ray::number(density.value > 0.0, || "the density".to_owned(), density.value, of_density)?;
    let (stddev, of_stddev) = (density.stddev, "kg/m3 must be finite and 0 or more");
    ray::number(stddev >= 0.0, || "the standard deviation of the density".to_owned(), stddev, of_stddev)?;
    let errors = errors(rays.iter().map(|r| r.error));
    let (weights, unit) = weights(errors.as_deref(), rays.len());
    let fit = fit::fit(&rays, &weights, unit)?;
    // A polarization that does not identify its mode by itself must be that of a mode of the fitted medium.
    for (index, (ray, share)) in rays.iter().zip(&fit.shares).enumerate() {
        if !ray.named && !ray::is_clear(*share) {
            return Err(ray::ambiguous(index, *share));
        }
    }
    let degrees_of_freedom = rays.len().saturating_sub(fit.rank);
    let chi_square = errors.as_ref().map(|errors| chi_square(&fit, errors, 0.0));
    let agreement = errors.as_ref().map_or(Agreement::Within, |errors| {
        agreement::agreement(&fit.residuals, errors, &fit.leverages, degrees_of_freedom)
    });
    let (mut fit, mut error, mut anisotropy_scatter) = (fit, unit, None);
    let (is_beyond, mut conflict) = match agreement {
        Agreement::Within => (false, None),
        Agreement::Beyond(found) => (true, Some(found)),
        Agreement::Conflict(found) => (false, Some(found)),
    };
    if let Some(errors) = errors.as_ref().filter(|_| is_beyond || (grains.is_some() && conflict.is_none())) {
        let scattered = match grains {
            Some(grains) => prior_scatter::with_prior(&rays, errors, &fit, grains.max(1.0))?,
            None => with_own_error(&rays, errors, &fit)?,
        };
        let scatter = 2.0 * scattered.added;
        let allowed = agreement::OWN_SCATTER.max(UNUSUAL * 2.0 * scattered.usual);
        (fit, error) = (scattered.fit, scattered.unit);
        if let (Some(_), Some(unit), Some(axis)) = (grains, error, axis) {
            fit.covariance = departure::covariance(speeds, &axis.normalize(), &fit, errors, scattered.added)
                / unit.powi(2);
        }
        if is_beyond && scatter <= allowed {
            (anisotropy_scatter, conflict) = (Some(scatter), None);
        }
    }
    let (moduli, covariance) = determined::moduli(&fit, density, error);
    if !moduli.known().all(|(_, value)| value.is_finite()) {
        return Err(ChristoffelError::NoMedium);
    }
    if is_unstable(&moduli) {
        return Err(ChristoffelError::Unstable { moduli: listed(&moduli) });
    }
    Ok(SpeedFit {
        observation: Observation { covariance, ..Observation::new(moduli, conditions) },
        undetermined: Modulus::ALL.into_iter().filter(|m| moduli.get(*m).is_none()).collect(),
        chi_square,
        degrees_of_freedom,
        assumed: if errors.is_some() { rays.iter().filter(|r| r.error.is_none()).count() } else { 0 },
        conflict,
        anisotropy_scatter,
        residuals: fit.residuals,
    })
}

/// χ² of a fit to speeds with these relative errors and `added` in quadrature.
fn chi_square(fit: &fit::Fit, errors: &[f64], added: f64) -> f64 {
    fit.residuals.iter().zip(errors).map(|(r, e)| r * r / (e * e + added * added)).sum()
}

/// The fit with the relative error added in quadrature to `errors` at which χ² equals the degrees of freedom. `sharp` is the fit
/// without it.
fn with_own_error(rays: &[Ray], errors: &[f64], sharp: &fit::Fit) -> Result<ScatteredFit, ChristoffelError> {
    let fitted = |added: f64| {
        let all: Vec<f64> = errors.iter().map(|e| e.hypot(added)).collect();
        let (weights, unit) = weights(Some(&all), rays.len());
        let fit = fit::fit(rays, &weights, unit)?;
        let freedom = rays.len().saturating_sub(fit.rank) as f64;
        let excess = chi_square(&fit, errors, added) - freedom;
        Ok((fit, unit, excess))
    };
    // With an error as large as the largest residual χ² is below one per speed, and refitting only lowers it.
    let largest = sharp.residuals.iter().fold(0.0, |most: f64, r| most.max(r.abs()));
    let range = [0.0, largest * rays.len() as f64];
    let (added, fit, unit) = tightest(range, |low, high| 0.5 * (low + high), fitted)?;
    Ok(ScatteredFit { added, usual: 0.0, fit, unit })
}

fn rays(speeds: &[WaveSpeed], axis: Option<Vec3>) -> Result<Vec<Ray>, ChristoffelError> {
    if speeds.is_empty() {
        return Err(ChristoffelError::NoSpeeds);
    }
    let axis = axis.ok_or(ChristoffelError::AxisUnknown)?;
    let axis = ray::unit(&axis, || "the axis".to_owned())?;
    let paired = ray::paired(speeds);
    let ray = |(index, (speed, paired))| Ray::new(index, speed, &axis, paired);
    speeds.iter().zip(paired).enumerate().map(ray).collect()
}

fn is_unstable(moduli: &Moduli) -> bool {
    let negative = moduli.known().any(|(modulus, value)| value <= 0.0 && modulus != Modulus::C13);
    negative || moduli.unstable(None, 0.0)
}

fn listed(moduli: &Moduli) -> String {
    let parts: Vec<String> = moduli.known().map(|(m, v)| format!("{m} = {:.3} MPa", v / 1e6)).collect();
    parts.join(", ")
}
