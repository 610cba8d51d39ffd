//! Long-wave limits of nearly exact speeds.
//!
//! v² = v₀² (1 − b q² + c q⁴ − …) converges while the waves are slower than the softest motions of a packing. The limit
//! is that of a parabola in q². The terms beyond it change the limit by about the last term's change times the ratio
//! of the last two terms: exactly so in a geometric series, which is the response of one soft motion.

use crate::curve::{DispersionCurve, DispersionPoint};
use grainlab_core::Vec3;
use nalgebra::{DMatrix, DVector};

/// Ratio c q²/b at the shortest wave above which the series does not converge well enough to state an error.
const CONVERGED: f64 = 0.3;

/// Error of the limit over the change by the last term times the ratio of the last two terms: root mean square over 243
/// speeds of 27 packings of 14 recipes, z 4.3 to 6.3, none of which is in the judgement of `cargo run --release -p grainlab_bench -- acoustics`.
const BEYOND: f64 = 1.5;

/// Part of the other modes' errors that is added to that of each mode, where its own terms cancel by chance.
const OTHERS: f64 = 0.3;

/// Least relative error of v²: rounding.
const EXACT: f64 = 1e-9;

#[derive(Clone, Debug)]
struct Series {
    /// Coefficients of v² as a parabola in (q/q_max)², m²/s².
    terms: [f64; 3],
    /// Variance of the first, (m/s)⁴, from the errors of the points.
    variance: f64,
    /// Relative change of v₀² by the last term.
    bent: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Extrapolation {
    modes: Vec<(Vec3, Vec<DispersionPoint>, Series)>,
    /// Ratio of the last two terms at the shortest wave, of all modes together.
    pub(super) ratio: f64,
}

impl Extrapolation {
    /// Series of the modes of one ray, each with its polarization and its speeds at three or more wavelengths. `None` if a
    /// limit is not positive or not finite.
    pub(super) fn of(modes: Vec<(Vec3, Vec<DispersionPoint>)>) -> Option<Self> {
        let series = |(polarization, mut points): (Vec3, Vec<DispersionPoint>)| {
            points.sort_by(|a, b| a.wavenumber.total_cmp(&b.wavenumber));
            let series = Series::through(&points)?;
            Some((polarization, points, series))
        };
        let modes: Vec<_> = modes.into_iter().map(series).collect::<Option<_>>()?;
        let sum = |k: usize| modes.iter().map(|(.., s)| (s.terms[k] / s.terms[0]).powi(2)).sum::<f64>();
        let ratio = (sum(2) / sum(1)).sqrt();
        ratio.is_finite().then_some(Self { modes, ratio })
    }

    /// True if the series does not converge well enough to state an error, and its last term is more than a part
    /// `tolerance` of v².
    pub(super) fn is_too_short(&self, tolerance: f64) -> bool {
        let is_seen = |s: &Series| s.bent.abs() > (3.0 * s.variance.sqrt() / s.terms[0]).max(tolerance);
        self.ratio > CONVERGED && self.modes.iter().any(|(.., s)| is_seen(s))
    }

    /// The curves along `direction`; `unseen` is the relative error of v² by motions that no series shows.
    pub(super) fn curves(self, direction: Vec3, unseen: f64) -> Vec<DispersionCurve> {
        let count = self.modes.len() as f64;
        let common = (self.modes.iter().map(|(.., s)| s.bent.powi(2)).sum::<f64>() / count).sqrt();
        let curve = |(polarization, points, series): (Vec3, Vec<DispersionPoint>, Series)| {
            let [square, slope, _] = series.terms;
            let beyond = BEYOND * self.ratio.min(1.0) * series.bent.hypot(OTHERS * common);
            let speed = square.sqrt();
            let largest = points.last().map_or(1.0, |p| p.wavenumber);
            DispersionCurve {
                direction,
                polarization,
                points,
                speed,
                stddev: 0.5
                    * speed
                    * beyond.hypot(series.variance.sqrt() / square).hypot(EXACT).hypot(unseen),
                dispersion_coefficient: -slope / square / largest.powi(2),
            }
        };
        self.modes.into_iter().map(curve).collect()
    }
}

impl Series {
    /// By least squares with equal relative weights, as the error is that of the law; `points` has the longest wave
    /// first.
    fn through(points: &[DispersionPoint]) -> Option<Self> {
        let largest = points.last()?.wavenumber;
        let squares = DVector::from_iterator(points.len(), points.iter().map(|p| p.speed.powi(2)));
        // The weight of each point in each coefficient.
        let weights = |count: usize| {
            let rows = DMatrix::from_fn(points.len(), count, |i, k| {
                (points[i].wavenumber / largest).powi(2 * k as i32)
            });
            Some((rows.transpose() * &rows).try_inverse()? * rows.transpose())
        };
        let (straight, parabola) = (weights(2)? * &squares, weights(3)?);
        let terms = &parabola * &squares;
        let variance = |(weight, p): (&f64, &DispersionPoint)| (weight * 2.0 * p.speed * p.stddev).powi(2);
        let variance = parabola.row(0).iter().zip(points).map(variance).sum::<f64>();
        let series =
            Self { terms: [terms[0], terms[1], terms[2]], variance, bent: straight[0] / terms[0] - 1.0 };
        let finite = series.terms.iter().all(|t| t.is_finite()) && variance.is_finite();
        (finite && series.terms[0] > 0.0).then_some(series)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waves that are coupled to a motion with the wave number `resonance`, and the speed of long ones, 1.
    fn coupled(resonance: f64) -> Extrapolation {
        let speed = |q: f64| (1.0 - 0.1 * q * q / (1.0 - (q / resonance).powi(2))).sqrt();
        let point = |q: f64| DispersionPoint { wavenumber: q, speed: speed(q), stddev: 1e-12 };
        Extrapolation::of(vec![(Vec3::z(), [0.02, 0.03, 0.04].map(point).to_vec())]).unwrap()
    }

    #[test]
    fn the_error_is_that_of_the_next_term_however_small() {
        for resonance in [0.12, 0.16, 0.25] {
            let found = coupled(resonance);
            assert!(found.ratio < CONVERGED);
            let curve = &found.curves(Vec3::z(), 0.0)[0];
            let off = (curve.speed - 1.0).abs() / curve.stddev;
            assert!((0.2..1.5).contains(&off), "{resonance}: {off} {curve:?}");
        }
    }

    #[test]
    fn waves_near_a_soft_motion_have_a_series_that_does_not_converge() {
        assert!(coupled(0.045).ratio > CONVERGED && coupled(0.035).ratio > CONVERGED);
    }

    #[test]
    fn speeds_without_a_limit_have_none() {
        let point = |(q, speed): (f64, f64)| DispersionPoint { wavenumber: q, speed, stddev: 1e-6 };
        let of = |points: &[(f64, f64)]| {
            Extrapolation::of(vec![(Vec3::z(), points.iter().copied().map(point).collect())]).is_some()
        };
        assert!(!of(&[(0.1, 1.0), (0.2, 1.0)]) && !of(&[(0.1, 0.1), (0.2, 1.0), (0.3, 1.5)]));
        assert!(!of(&[(0.1, f64::NAN), (0.2, 1.0), (0.3, 1.0)]));
    }
}
