//! The axis of symmetry, from the speeds.
//!
//! For every axis of a grid on the hemisphere the best medium is fitted linearly; from the best axes, moduli and axis
//! are refined together. An axis is found if it fits better than isotropy, and better than every other axis, beyond
//! chance.

use super::agreement::{Agreement, agreement};
use super::axis_error::AxisError;
use super::error::ChristoffelError;
use super::hemisphere::{angle, hemisphere, upward, widest_gap};
use super::profile::{Speeds, Stand};
use super::ray::{Ray, paired};
use super::search::seen;
use super::weights::{errors, weights};
use crate::normal::score;
use grainlab_core::{Mat3, Vec3, WaveSpeed};
use nalgebra::{Matrix2, SymmetricEigen, Vector2};

/// Number of axes of the grid (10° apart), and of directions proposed for the next measurement (5° apart).
const GRID: usize = 200;
const FINE: usize = 800;

/// Number of axes that are refined, and the least angle between them, rad.
const REFINED: usize = 8;
const APART: f64 = 0.35;

/// Number of standard deviations by which an axis must fit better than isotropy. It is above the usual three because
/// the axis is chosen among many.
const PREFERRED: f64 = 4.0;

/// Number of standard deviations by which an axis must fit better than another.
const UNIQUE: f64 = 4.0;

/// Least angle between two distinct axes, rad: 6°.
const DISTINCT: f64 = 0.1;

/// Standard deviation of an axis beyond which axes a radian away are tried too, rad: 17°.
const LOOSE: f64 = 0.3;

/// Relative misfit of a speed that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// An axis of symmetry found from wave speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisEstimate {
    /// The axis: a unit vector with z ≥ 0.
    pub axis: Vec3,
    /// Covariance of its error, rad², zero along the axis; from the errors of the speeds or from their scatter,
    /// whichever is larger.
    pub covariance: Mat3,
    /// Number of standard deviations by which the best medium about it fits better than the best isotropic one.
    pub sigma: f64,
}

impl AxisEstimate {
    /// Largest standard deviation of the axis over all directions, rad.
    pub fn stddev(&self) -> f64 {
        SymmetricEigen::new(self.covariance).eigenvalues.max().max(0.0).sqrt()
    }
}

/// The axis about which a transversely isotropic medium fits `speeds` best.
///
/// It needs more speeds than unknowns: the combinations of moduli that the speeds determine, and two for the axis; in
/// general eight speeds. Polarizations must be those of modes, and numbers valid, as for [`super::moduli_from_speeds`].
/// If no speed has an uncertainty, equal relative ones are estimated from the scatter.
///
/// ```
/// use grainlab_emt::christoffel;
/// use grainlab_core::{TransverseIsotropy, Vec3, WaveSpeed};
/// let medium = TransverseIsotropy { c11: 270.0, c12: 60.0, c13: 65.0, c33: 320.0, g13: 110.0, g12: 105.0, residual: 0.0 };
/// let about_x = nalgebra::Rotation3::from_axis_angle(&Vec3::y_axis(), std::f64::consts::FRAC_PI_2);
/// let stiffness = medium.stiffness().rotated(about_x.matrix());
/// let mut speeds = Vec::new();
/// for (x, y, z) in [(1., 0., 0.), (0., 1., 0.), (0., 0., 1.), (1., 1., 0.), (1., -1., 0.), (0., 1., 1.), (1., 0., 1.)] {
///     let direction = Vec3::new(x, y, z).normalize();
///     let waves = stiffness.plane_waves(&direction);
///     for (modulus, polarization) in waves.moduli.into_iter().zip(waves.polarizations) {
///         speeds.push(WaveSpeed { direction, polarization, speed: modulus.sqrt(), stddev: Some(0.001 * modulus.sqrt()) });
///     }
/// }
/// let found = christoffel::find_axis(&speeds).unwrap();
/// assert!(found.axis.x.abs() > 0.999_999 && found.stddev() < 0.02);
/// ```
pub fn find_axis(speeds: &[WaveSpeed]) -> Result<AxisEstimate, AxisError> {
    if speeds.is_empty() {
        return Err(ChristoffelError::NoSpeeds.into());
    }
    for (index, speed) in speeds.iter().enumerate() {
        Ray::about(index, speed, &Vec3::z())?;
    }
    let errors = errors(speeds.iter().map(|s| s.stddev.map(|stddev| stddev / s.speed)));
    let (weights, unit) = weights(errors.as_deref(), speeds.len());
    let paired = paired(speeds);
    let speeds = Speeds { measured: speeds, weights: &weights, paired: &paired };
    let stands = minima(&speeds);
    let best = stands.first().ok_or(ChristoffelError::NoMedium)?;
    let (_, rank) = seen(&best.point.rows);
    let scatter = errors.is_none();
    let unknowns = rank + 2 + usize::from(scatter);
    if speeds.measured.len() < unknowns {
        let direction = widest_gap(speeds.measured, FINE);
        return Err(AxisError::TooFew { speeds: speeds.measured.len(), unknowns, scatter, direction });
    }
    let noise = Noise::new(&speeds, best, errors.as_deref(), unit, rank + 2);
    let (isotropic, kinds) = isotropic(&speeds);
    let sigma = noise.score(isotropic - best.point.cost, rank + 2 - kinds);
    if sigma.is_nan() || sigma < PREFERRED {
        return Err(AxisError::Isotropic { sigma, needed: PREFERRED });
    }
    let tilts = speeds.tilts(best).ok_or(ChristoffelError::NoMedium)?;
    let eigen = SymmetricEigen::new(tilts.curvature);
    // The error of an axis is at most a right angle.
    let variances = eigen.eigenvalues.map(|c| (noise.variance / c.max(0.0)).min(2.5));
    let towards = eigen.eigenvectors.column_iter().zip(variances.iter());
    let loose = towards.filter(|(_, variance)| variance.sqrt() > LOOSE).flat_map(|(towards, _)| {
        let step: Vector2<f64> = towards.into_owned();
        [0.8 * step, -0.8 * step]
            .map(|step| speeds.stand(tilts.tilted(&best.axis, &step), best.point.specific))
    });
    let others = stands[1..].iter().cloned().chain(loose.flatten());
    let rivals = others.filter(|s| noise.score(s.point.cost - best.point.cost, 2) < UNIQUE);
    if let Some(rival) = rivals.min_by(|a, b| a.point.cost.total_cmp(&b.point.cost)) {
        let (direction, difference) = most_different(&speeds, best, &rival);
        return Err(AxisError::NotUnique {
            axes: [best, &rival].map(|s| upward(s.axis)),
            direction,
            difference,
        });
    }
    let covariance = eigen.eigenvectors * Matrix2::from_diagonal(&variances) * eigen.eigenvectors.transpose();
    let frame = nalgebra::Matrix3x2::from_columns(&tilts.towards);
    let covariance: Mat3 = frame * covariance * frame.transpose();
    Ok(AxisEstimate { axis: upward(best.axis), covariance, sigma })
}

/// The error of a speed of weight 1.
struct Noise {
    variance: f64,
    /// Degrees of freedom of its estimate; `None` if it was given.
    freedom: Option<usize>,
}

impl Noise {
    fn new(
        speeds: &Speeds<'_>,
        best: &Stand,
        errors: Option<&[f64]>,
        unit: Option<f64>,
        unknowns: usize,
    ) -> Self {
        let freedom = speeds.measured.len() - unknowns;
        let found = best.point.cost / freedom.max(1) as f64;
        let (Some(errors), Some(unit)) = (errors, unit) else {
            return Self { variance: found.max(ROUNDING * ROUNDING), freedom: Some(freedom) };
        };
        let residuals: Vec<f64> = best.point.rows.iter().map(|(residual, _)| *residual).collect();
        match agreement(&residuals, errors, &vec![0.0; residuals.len()], freedom) {
            Agreement::Within => Self { variance: unit * unit, freedom: None },
            _ => Self { variance: found, freedom: Some(freedom) },
        }
    }

    /// Significance of the decrease `gain` of the sum of squares by superfluous unknowns, in standard
    /// deviations.
    fn score(&self, gain: f64, unknowns: usize) -> f64 {
        score(gain / unknowns as f64 / self.variance, unknowns, self.freedom)
    }
}

/// The axes of locally best fit, the best first.
fn minima(speeds: &Speeds<'_>) -> Vec<Stand> {
    let mut grid: Vec<_> = hemisphere(GRID)
        .filter_map(|axis| speeds.linear(&axis).map(|(medium, cost)| (axis, medium, cost)))
        .filter(|(.., cost)| cost.is_finite())
        .collect();
    grid.sort_by(|a, b| a.2.total_cmp(&b.2));
    let mut starts: Vec<(Vec3, _)> = Vec::new();
    for (axis, medium, _) in grid {
        if starts.len() < REFINED && starts.iter().all(|(other, _)| angle(other, &axis) > APART) {
            starts.push((axis, medium));
        }
    }
    let stands = starts.into_iter().filter_map(|(axis, medium)| speeds.stand(axis, medium));
    let mut ends: Vec<Stand> = stands.map(|stand| speeds.descend(stand)).collect();
    ends.sort_by(|a, b| a.point.cost.total_cmp(&b.point.cost));
    let mut minima: Vec<Stand> = Vec::new();
    for end in ends {
        if minima.iter().all(|other| angle(&other.axis, &end.axis) > DISTINCT) {
            minima.push(end);
        }
    }
    minima
}

/// Weighted sum of squares of the best isotropic medium, and the number of its moduli that the speeds determine.
fn isotropic(speeds: &Speeds<'_>) -> (f64, usize) {
    let (mut cost, mut kinds) = (0.0, 0);
    for compressional in [true, false] {
        let of_kind = |s: &WaveSpeed| (s.direction.dot(&s.polarization).powi(2) > 0.5) == compressional;
        let kind = || speeds.measured.iter().zip(speeds.weights).filter(|(s, _)| of_kind(s));
        let (first, second) = kind().fold((0.0, 0.0), |(first, second), (s, weight)| {
            (first + weight / s.speed, second + weight / (s.speed * s.speed))
        });
        if second > 0.0 {
            let speed = first / second;
            cost += kind().map(|(s, weight)| weight * (1.0 - speed / s.speed).powi(2)).sum::<f64>();
            kinds += 1;
        }
    }
    (cost, kinds)
}

/// The direction in which two media differ most, with the relative difference of their P speeds; if no P speed was measured,
/// the direction furthest from all measured ones.
fn most_different(speeds: &Speeds<'_>, one: &Stand, other: &Stand) -> (Vec3, Option<f64>) {
    let square = |stand: &Stand, n: &Vec3| {
        let wave = WaveSpeed { direction: *n, polarization: *n, speed: 1.0, stddev: None };
        let (ray, _) = Ray::about(0, &wave, &stand.axis).ok()?;
        ray.response(&stand.point.specific).map(|response| response.square)
    };
    let difference = |n: &Vec3| Some((0.5 * (square(one, n)? / square(other, n)?).ln()).abs());
    let compressional = |s: &WaveSpeed| s.direction.dot(&s.polarization).powi(2) > 0.5;
    let differences = hemisphere(FINE).filter_map(|n| Some((n, difference(&n)?)));
    let most = differences.max_by(|a, b| a.1.total_cmp(&b.1));
    match most.filter(|_| speeds.measured.iter().any(compressional)) {
        Some((n, difference)) => (n, Some(difference)),
        None => (widest_gap(speeds.measured, FINE), None),
    }
}
