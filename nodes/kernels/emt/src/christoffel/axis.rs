//! The axis of symmetry, from the speeds themselves.
//!
//! The best medium about every axis of a grid on the hemisphere is fitted, linearly; from the best axes the sum of squares
//! goes down in moduli and axis together. The axis counts as found if the speeds prefer it to isotropy beyond chance, and
//! to every other axis.

use super::agreement::{Agreement, agreement};
use super::axis_error::AxisError;
use super::chance::score;
use super::hemisphere::{angle, hemisphere, upward, widest_gap};
use super::profile::{Speeds, Stand};
use super::ray::{Ray, paired};
use super::search::seen;
use super::{ChristoffelError, errors, weights};
use grainlab_core::{Mat3, Vec3, WaveSpeed};
use nalgebra::{Matrix2, SymmetricEigen, Vector2};

/// Axes of the grid: 10° apart; and directions to measure next, 5° apart.
const GRID: usize = 200;
const FINE: usize = 800;

/// Axes that are refined, and the least angle between them, rad.
const REFINED: usize = 8;
const APART: f64 = 0.35;

/// Standard deviations by which an axis must be preferred to isotropy. That the axis is free makes chance find more than
/// tables say.
const PREFERRED: f64 = 4.0;

/// The same, by which it must be preferred to another axis.
const UNIQUE: f64 = 4.0;

/// Least angle between two axes that are not one, rad: 6°.
const DISTINCT: f64 = 0.1;

/// Standard deviation of an axis beyond which its neighbours a radian away are looked at, rad: 17°.
const LOOSE: f64 = 0.3;

/// Relative misfit of a speed that is rounding.
const ROUNDING: f64 = 1e-9;

/// An axis of symmetry that the speeds tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisFound {
    /// The axis: a unit vector with z ≥ 0.
    pub axis: Vec3,
    /// Covariance of its error, rad²; nothing along the axis. That of the speeds' errors, or of their scatter, whichever is
    /// larger.
    pub covariance: Mat3,
    /// By how many standard deviations the speeds prefer the best medium about it to the best isotropic one.
    pub sigma: f64,
}

impl AxisFound {
    /// Standard deviation in the direction in which the axis is known worst, rad.
    pub fn stddev(&self) -> f64 {
        SymmetricEigen::new(self.covariance).eigenvalues.max().max(0.0).sqrt()
    }
}

/// The axis about which a transversely isotropic medium fits `speeds` best.
///
/// It takes a speed more than the moduli have combinations that the speeds see, and two: in general eight, for the moduli
/// are five. Particle motions must be those of modes, as in [`super::observation`]; what it refuses of numbers is refused.
/// If no speed has an uncertainty, equal relative ones are taken and found from their scatter.
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
pub fn find_axis(speeds: &[WaveSpeed]) -> Result<AxisFound, AxisError> {
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
    // An axis that is not known at all is a radian and a half off at most.
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
        let (direction, difference) = telling(&speeds, best, &rival);
        return Err(AxisError::NotUnique {
            axes: [best, &rival].map(|s| upward(s.axis)),
            direction,
            difference,
        });
    }
    let covariance = eigen.eigenvectors * Matrix2::from_diagonal(&variances) * eigen.eigenvectors.transpose();
    let frame = nalgebra::Matrix3x2::from_columns(&tilts.towards);
    let covariance: Mat3 = frame * covariance * frame.transpose();
    Ok(AxisFound { axis: upward(best.axis), covariance, sigma })
}

/// How large a speed of weight 1 errs.
struct Noise {
    /// The square of it.
    variance: f64,
    /// Of how many degrees of freedom it was found; `None` if it was stated.
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

    /// How rare it is that so many needless unknowns lower the sum of squares by so much, in standard deviations.
    fn score(&self, gain: f64, unknowns: usize) -> f64 {
        score(gain / unknowns as f64 / self.variance, unknowns, self.freedom)
    }
}

/// The axes that fit better than their neighbours, the best first.
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

/// Weighted sum of squares about the best isotropic medium, and how many moduli the speeds see of it.
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

/// The direction in which two media differ most, by the relative difference of their P speeds if these are known; else the
/// one furthest from all measured.
fn telling(speeds: &Speeds<'_>, one: &Stand, other: &Stand) -> (Vec3, Option<f64>) {
    let square = |stand: &Stand, n: &Vec3| {
        let wave = WaveSpeed { direction: *n, polarization: *n, speed: 1.0, stddev: None };
        let (ray, _) = Ray::about(0, &wave, &stand.axis).ok()?;
        ray.answer(&stand.point.specific).map(|answer| answer.square)
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
