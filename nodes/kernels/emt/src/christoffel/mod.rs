//! From wave speeds to moduli.
//!
//! A plane wave along the unit vector n obeys Γ p = ρ v² p with Γ_ik = C_ijkl n_j n_l (see [`grainlab_core::waves`]). In a medium
//! that is isotropic about an axis, with θ between n and the axis, one mode moves across the plane of n and axis,
//! ρ v² = C66 sin²θ + C44 cos²θ, and two in that plane: ρ v² are the eigenvalues of
//!
//! ```text
//! | C11 sin²θ + C44 cos²θ    (C13 + C44) sin θ cos θ  |
//! | (C13 + C44) sin θ cos θ  C44 sin²θ + C33 cos²θ    |
//! ```
//!
//! So P and S speeds along and across the axis give C33, C11, C44 and C66, and C13, and with it the bulk modulus, needs a
//! speed in between. These only know (C13 + C44)²: C13 + C44 > 0 is assumed, as it is in every packing.
//!
//! What the speeds leave open is left open. What they determine more than once is a weighted least-squares fit, and how
//! well they agree is told. Where several media have the same speeds (without P speeds along and across the axis that
//! happens), the moduli in which they differ are left open, too. A packing is not quite isotropic about any axis: speeds
//! that scatter more than they err, and no more than those of a packing, are not at odds with each other, but their scatter
//! is then their error. The axis is given, or [`find_axis`] finds it from speeds in enough directions. The density is that
//! of the mass that moves with the wave: rattlers do not.

mod agreement;
mod axis;
mod axis_error;
mod chance;
mod determined;
mod error;
mod fit;
mod hemisphere;
mod profile;
mod ray;
mod search;

pub use agreement::{Departure, SpeedConflict};
pub use axis::{AxisFound, find_axis};
pub use axis_error::AxisError;
pub use error::ChristoffelError;

use crate::conditions::{Conditions, Measured};
use crate::moduli::{Moduli, Modulus};
use crate::observation::Observation;
use agreement::Agreement;
use grainlab_core::{Vec3, WaveSpeed};
use ray::Ray;

/// Relative precision of the error that a sample's own scatter adds.
const OWN_ERROR_PRECISION: f64 = 1e-4;

/// Moduli from wave speeds, and how well the speeds agree.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    /// The moduli that the speeds determine about the axis as e3, with their covariance if any speed has an uncertainty.
    pub observation: Observation,
    /// The moduli that they do not.
    pub undetermined: Vec<Modulus>,
    /// Weighted sum of squares of speeds measured less fitted; `None` if their uncertainty is not known.
    pub chi_square: Option<f64>,
    /// Speeds less combinations of moduli that they determine.
    pub degrees_of_freedom: usize,
    /// Of every speed: measured less fitted, over measured.
    pub residuals: Vec<f64>,
    /// Speeds without an uncertainty, where others have one; they were given the largest relative one of the others.
    pub assumed: usize,
    /// Whether the speeds contradict each other beyond their uncertainty and what a sample of some thousand grains differs
    /// from a transversely isotropic medium, and which most.
    pub conflict: Option<SpeedConflict>,
    /// Whether they differ beyond their uncertainty, but by no more than such a sample does. The covariance is then that of
    /// their scatter.
    pub departure: Option<Departure>,
}

impl Fitted {
    /// Root mean square of the relative residuals per degree of freedom: an estimate of the relative error of the speeds
    /// that asks for no uncertainty; `None` without a degree of freedom.
    pub fn scatter(&self) -> Option<f64> {
        let sum: f64 = self.residuals.iter().map(|r| r * r).sum();
        (self.degrees_of_freedom > 0).then(|| (sum / self.degrees_of_freedom as f64).sqrt())
    }
}

/// The moduli of a medium that is isotropic about `axis` from the speeds of its waves, with the density of the mass that
/// moves with them, kg/m³, in the state `conditions`.
///
/// The moduli are those of a frame with the axis as e3. Any set of speeds will do: [`Fitted::undetermined`] are the moduli
/// it leaves open. Equal relative errors are taken if no speed has an uncertainty; the moduli then have none either.
/// Errors of speeds are independent, that of the density moves all moduli together. Where speeds scatter more than they may,
/// but no more than those of a packing do, which is never quite isotropic about an axis, every speed has the error of that
/// scatter as well ([`Fitted::departure`]).
///
/// Refused: an axis that is not known, vectors that are not of unit length, numbers that are not positive and finite, a
/// polarisation more than 30° from every mode of its direction, and speeds that only an unstable medium has. Of two S waves
/// along one direction that were both measured, the motions may be any perpendicular ones: a sample that is not quite
/// isotropic about the axis turns them, for their speeds are nearly the same.
///
/// ```
/// use grainlab_emt::{Conditions, Measured, Modulus, christoffel};
/// use grainlab_core::{Vec3, WaveSpeed};
/// let wave = |direction, polarization, speed| WaveSpeed { direction, polarization, speed, stddev: Some(0.003 * speed) };
/// let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
/// let speeds = [wave(z, z, 500.0), wave(x, x, 480.0), wave(z, x, 300.0), wave(x, z, 301.0), wave(x, y, 290.0)];
/// let density = Measured { value: 1600.0, stddev: 8.0 };
/// let fitted = christoffel::observation(&speeds, density, Some(z), Conditions::at(50e3)).unwrap();
/// let c33 = fitted.observation.moduli.get(Modulus::C33).unwrap();
/// assert!((c33 - 1600.0 * 500.0 * 500.0).abs() < 1e-3);
/// assert_eq!(fitted.undetermined, [Modulus::Theta, Modulus::C13]);
/// assert_eq!((fitted.degrees_of_freedom, fitted.conflict), (1, None));
/// ```
pub fn observation(
    speeds: &[WaveSpeed],
    density: Measured,
    axis: Option<Vec3>,
    conditions: Conditions,
) -> Result<Fitted, ChristoffelError> {
    let rays = rays(speeds, axis)?;
    check_density(density)?;
    let errors = errors(rays.iter().map(|r| r.error));
    let (weights, unit) = weights(errors.as_deref(), rays.len());
    let fit = fit::fit(&rays, &weights, unit)?;
    // Where the motion said it all, a mode that moves otherwise is a matter of the speeds.
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
    let (mut fit, mut error, mut departure, mut conflict) = (fit, unit, None, None);
    match (agreement, &errors) {
        (Agreement::Beyond(found), Some(errors)) => {
            let (added, with_it, unit) = with_own_error(&rays, errors, &fit)?;
            let scatter = 2.0 * added;
            (fit, error) = (with_it, unit);
            if scatter <= agreement::OWN_SCATTER {
                departure = Some(Departure { scatter });
            } else {
                conflict = Some(found);
            }
        }
        (Agreement::Conflict(found), _) => conflict = Some(found),
        _ => {}
    }
    let (moduli, covariance) = determined::moduli(&fit, density, error);
    if !moduli.known().all(|(_, value)| value.is_finite()) {
        return Err(ChristoffelError::NoMedium);
    }
    if is_unstable(&moduli) {
        return Err(ChristoffelError::Unstable { moduli: listed(&moduli) });
    }
    Ok(Fitted {
        observation: Observation { covariance, ..Observation::new(moduli, conditions) },
        undetermined: Modulus::ALL.into_iter().filter(|m| moduli.get(*m).is_none()).collect(),
        chi_square,
        degrees_of_freedom,
        assumed: if errors.is_some() { rays.iter().filter(|r| r.error.is_none()).count() } else { 0 },
        conflict,
        departure,
        residuals: fit.residuals,
    })
}

/// χ² of a fit to speeds with these relative errors and one more.
fn chi_square(fit: &fit::Fit, errors: &[f64], added: f64) -> f64 {
    fit.residuals.iter().zip(errors).map(|(r, e)| r * r / (e * e + added * added)).sum()
}

/// The relative error added to `errors` with which χ² is as large as the degrees of freedom, the fit with it, and the error of
/// a speed of weight 1. `sharp` is the fit without it.
fn with_own_error(
    rays: &[Ray],
    errors: &[f64],
    sharp: &fit::Fit,
) -> Result<(f64, fit::Fit, Option<f64>), ChristoffelError> {
    let fitted = |added: f64| {
        let errors: Vec<f64> = errors.iter().map(|e| e.hypot(added)).collect();
        let (weights, unit) = weights(Some(&errors), rays.len());
        Ok((fit::fit(rays, &weights, unit)?, unit))
    };
    // χ² is below one a speed with an error as large as the largest residual, and a better fit only lowers it.
    let largest = sharp.residuals.iter().fold(0.0, |most: f64, r| most.max(r.abs()));
    let (mut low, mut high) = (0.0, largest * rays.len() as f64);
    let mut best = fitted(high)?;
    while high - low > OWN_ERROR_PRECISION * high {
        let middle = 0.5 * (low + high);
        let next = fitted(middle)?;
        let freedom = rays.len().saturating_sub(next.0.rank) as f64;
        if chi_square(&next.0, errors, middle) > freedom {
            low = middle;
        } else {
            (high, best) = (middle, next);
        }
    }
    Ok((high, best.0, best.1))
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

fn check_density(density: Measured) -> Result<(), ChristoffelError> {
    if !(density.value > 0.0 && density.value.is_finite()) {
        return Err(ChristoffelError::Density { value: density.value });
    }
    if !(density.stddev >= 0.0 && density.stddev.is_finite()) {
        return Err(ChristoffelError::DensityStddev { value: density.stddev });
    }
    Ok(())
}

/// Relative error of every speed; `None` if none is known.
fn errors(known: impl Iterator<Item = Option<f64>> + Clone) -> Option<Vec<f64>> {
    let largest = known.clone().flatten().reduce(f64::max)?;
    Some(known.map(|error| error.unwrap_or(largest)).collect())
}

/// Weights of `speeds` speeds with these relative errors, and the error of a speed of weight 1; all of weight 1 if no error
/// is known.
fn weights(errors: Option<&[f64]>, speeds: usize) -> (Vec<f64>, Option<f64>) {
    let Some(errors) = errors else { return (vec![1.0; speeds], None) };
    let unit = errors.iter().copied().fold(f64::INFINITY, f64::min);
    (errors.iter().map(|e| (unit / e).powi(2)).collect(), Some(unit))
}

fn is_unstable(moduli: &Moduli) -> bool {
    let negative = moduli.known().any(|(modulus, value)| value <= 0.0 && modulus != Modulus::C13);
    negative || moduli.unstable()
}

fn listed(moduli: &Moduli) -> String {
    let parts: Vec<String> = moduli.known().map(|(m, v)| format!("{m} = {:.3} MPa", v / 1e6)).collect();
    parts.join(", ")
}
