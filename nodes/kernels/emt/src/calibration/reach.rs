//! Ranges of the packings of a calibration, and the distance of another packing from them.

use super::laws::{NetworkState, REFERENCE_PRESSURE, REFERENCE_STIFFNESS_RATIO};
use grainlab_core::notes::Note;
use serde::{Deserialize, Serialize};

/// Distance, in widths of a range, beyond which there is no estimate.
const UNKNOWN: f64 = 0.5;

/// Factor of the variance at the distance [`UNKNOWN`], less 1. The laws are smooth, but their errors outside are those of an
/// extrapolation: packings outside the packings taught (`tests/ensembles` of `grainlab_calibration`) need it.
const GROWTH: f64 = 12.0;

/// Factor of the variance just outside, at the distance [`TOLERANCE`].
const OUTSIDE: f64 = 1.8;

/// Share of a range beyond its ends over which the variance grows to [`OUTSIDE`], and that the domain of the model contains:
/// random packings do not reach the ends of the ranges that they were drawn from.
const TOLERANCE: f64 = 0.02;

/// Share of a range beyond each end up to which nothing is said: for q/p and z a rounding; the packings taught do not reach
/// the stated ends of ε, of the sizes, of k_t/k_n and of p/E*.
const ROUNDING: f64 = 1e-3;
const EPS_END: f64 = 0.015;
const SIZE_END: f64 = 0.007;
const RATIO_END: f64 = 0.006;
const PRESSURE_END: f64 = 0.017;

/// Least width of a range by which distances from it are measured: of ln p, of z, and of the others.
const LN_WIDTH: f64 = 1.0;
const Z_WIDTH: f64 = 0.5;
const WIDTH: f64 = 0.1;

/// Lowest and highest of the packings of a calibration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reach {
    /// Range of z.
    pub z: [f64; 2],
    /// Range of ε.
    pub eps: [f64; 2],
    /// Range of p/E*.
    pub pressure: [f64; 2],
    /// Range of k_t/k_n.
    pub stiffness_ratio: [f64; 2],
    /// Standard deviation of the radii over their mean.
    pub size_spread: [f64; 2],
    /// (σ_33 − (σ_11 + σ_22)/2)/p.
    pub stress_ratio: [f64; 2],
}

/// One quantity beyond its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Outside {
    pub(crate) quantity: &'static str,
    pub(crate) value: f64,
    pub(crate) range: [f64; 2],
    /// Distance from the range in widths of it.
    distance: f64,
    /// Distance up to which it is one of the ends of the range.
    end: f64,
}

impl Outside {
    pub(crate) fn note(&self) -> Note {
        Note::state_outside_calibration(self.quantity, self.value, self.range[0], self.range[1])
    }

    /// True for an extrapolation, false for the ends of the range.
    pub(crate) fn is_extrapolation(&self) -> bool {
        self.distance.is_nan() || self.distance > self.end
    }

    /// True if it is too far for an estimate.
    pub(crate) fn is_too_far(&self) -> bool {
        self.distance.is_nan() || self.distance > UNKNOWN
    }

    /// Factor of the variances of an estimate.
    pub(crate) fn growth(&self) -> f64 {
        let step = (OUTSIDE - 1.0) * (self.distance / TOLERANCE).min(1.0);
        1.0 + step + GROWTH * (self.distance / UNKNOWN).powi(2)
    }
}

impl Reach {
    pub(crate) fn outside(&self, pressure: f64, state: &NetworkState) -> Vec<Outside> {
        let size_spread = state.size_variance.max(0.0).sqrt();
        let stiffness_ratio = state.stiffness_ratio + REFERENCE_STIFFNESS_RATIO;
        [
            beyond("p/E*", pressure, self.pressure, f64::ln, (LN_WIDTH, PRESSURE_END)),
            beyond("k_t/k_n", stiffness_ratio, self.stiffness_ratio, |v| v, (WIDTH, RATIO_END)),
            beyond("the spread of the grain sizes", size_spread, self.size_spread, |v| v, (WIDTH, SIZE_END)),
            beyond("the axial stress ratio", state.stress_ratio, self.stress_ratio, |v| v, (WIDTH, ROUNDING)),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// The states at the ends of the ranges of p and k_t/k_n, of equal grains in isotropic stress.
    pub(crate) fn corners(&self) -> impl Iterator<Item = NetworkState> {
        let [low, high] = self.stiffness_ratio.map(|ratio| ratio - REFERENCE_STIFFNESS_RATIO);
        self.pressure.into_iter().flat_map(move |pressure| {
            let ln_pressure = (pressure / REFERENCE_PRESSURE).ln();
            [low, high].map(|stiffness_ratio| NetworkState {
                ln_pressure,
                stiffness_ratio,
                size_variance: 0.0,
                stress_ratio: 0.0,
            })
        })
    }

    /// The ranges of z, ε, q/p and the spread of the sizes that count as inside.
    pub(crate) fn with_ends(&self) -> Self {
        let wider = |[low, high]: [f64; 2], least: f64| {
            let by = TOLERANCE * (high - low).max(least);
            [low - by, high + by]
        };
        Self {
            z: wider(self.z, Z_WIDTH),
            eps: wider(self.eps, WIDTH),
            size_spread: wider(self.size_spread, WIDTH),
            stress_ratio: wider(self.stress_ratio, WIDTH),
            pressure: wider(self.pressure.map(f64::ln), LN_WIDTH).map(f64::exp),
            stiffness_ratio: wider(self.stiffness_ratio, WIDTH),
        }
    }

    /// The range of ε with estimates: half a width wider at each end.
    pub(crate) fn eps_with_estimates(&self) -> [f64; 2] {
        let [low, high] = self.eps;
        let wider = UNKNOWN * (high - low).max(WIDTH);
        [low - wider, high + wider]
    }

    /// The inferred structure, if it is beyond the ranges; ε `None` is inside.
    pub(crate) fn outside_structure(&self, z: f64, eps: Option<f64>) -> Vec<Outside> {
        let of_eps = eps.and_then(|eps| beyond("eps", eps, self.eps, |v| v, (WIDTH, EPS_END)));
        beyond("z", z, self.z, |v| v, (Z_WIDTH, ROUNDING)).into_iter().chain(of_eps).collect()
    }

    /// The ranges of z and ε without a warning.
    pub(crate) fn without_warning(&self) -> [[f64; 2]; 2] {
        let wider = |[low, high]: [f64; 2], by: f64| [low - by * (high - low), high + by * (high - low)];
        [wider(self.z, ROUNDING), wider(self.eps, EPS_END)]
    }
}

/// The value, if it is beyond the range: the distance is measured on the given scale, in widths of the range or of `least`, if that is
/// wider; `end` is the share of it that is an end of the range.
fn beyond(
    quantity: &'static str,
    value: f64,
    range: [f64; 2],
    scale: fn(f64) -> f64,
    (least, end): (f64, f64),
) -> Option<Outside> {
    let [low, high] = range.map(scale);
    let width = (high - low).max(least);
    let at = scale(value);
    let distance = (low - at).max(at - high) / width;
    let is_beyond = distance.is_nan() || distance > 0.0;
    is_beyond.then_some(Outside { quantity, value, range, distance, end })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variances_grow_with_the_distance_and_half_a_range_away_there_is_no_estimate() {
        let at = |value| beyond("the axial stress ratio", value, [-0.2, 0.3], |v| v, (0.1, ROUNDING));
        assert_eq!(at(0.3), None);
        let [end, beyond] = [-0.2004, -0.2006].map(|v| at(v).unwrap());
        assert!(!end.is_extrapolation() && beyond.is_extrapolation());
        assert!((at(0.300_001).unwrap().growth() - 1.0).abs() < 1e-3, "the variance does not jump");
        let near = at(0.35).unwrap();
        assert!(!near.is_too_far() && (near.growth() - (OUTSIDE + GROWTH * 0.04)).abs() < 1e-9, "{near:?}");
        let far = at(-0.46).unwrap();
        assert!(far.is_too_far() && at(f64::NAN).unwrap().is_too_far());
    }

    #[test]
    fn a_pressure_is_compared_by_its_logarithm() {
        let at = |value| beyond("p/E*", value, [1e-7, 1e-5], f64::ln, (1.0, ROUNDING));
        let (above, below) = (at(5e-5).unwrap(), at(2e-8).unwrap());
        assert!((above.growth() - below.growth()).abs() < 1e-9 && !above.is_too_far());
        assert!(at(1.1e-4).unwrap().is_too_far());
    }
}
