//! z of a sample under other assumptions than its estimate has.

use super::component::Mixture;
use super::doubted::Doubted;
use super::estimate::{FAR, HIGHEST_Z, Interval, SEED, SeriesEstimate};
use super::forward::Forward;
use super::prior::SeriesPrior;
use super::sample::SpeedSeries;
use crate::calibration::RelaxationCalibration;
use crate::error::EmtError;
use grainlab_core::notes::Status;
use serde::Serialize;

/// Drift of ln k_t/k_n per decade that is tried.
const DRIFT: f64 = 0.1;

/// Slope of z per decade without the prior's: mean and standard deviation.
const NO_SLOPE: [f64; 2] = [0.0, 1.0];

/// z under other assumptions, at each pressure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sensitivity {
    /// With k_t/k_n falling and rising by 10 % per decade of pressure.
    pub drifted: [Vec<f64>; 2],
    /// Without the prior's slope of z.
    pub without_slope: Vec<f64>,
    /// z of the bulk modulus less z of the shear modulus, the contact shared: mean and standard deviation.
    pub bulk_less_shear: Vec<[f64; 2]>,
    /// z without each pressure and each row that the others contradict.
    pub doubted: Vec<Doubted>,
}

impl SeriesEstimate {
    /// Returns the status of the sample, which is the status of its worst pressure.
    pub fn status(&self, sensitivity: &Sensitivity) -> Status {
        match () {
            () if self.is_contradictory() || sensitivity.is_contradictory() => Status::Contradictory,
            () if self.pressures.iter().any(|p| p.outside.is_some()) => Status::Extrapolated,
            () => Status::Ok,
        }
    }
}

/// Nodes and weights of a quadrature over a normal distribution (Gauss and Hermite, of order 5).
const QUADRATURE: [[f64; 2]; 5] = [
    [-2.856_970_013_872_806, 0.011_257_411_327_720_69],
    [-1.355_626_179_974_266, 0.222_075_922_005_612_7],
    [0.0, 0.533_333_333_333_333_3],
    [1.355_626_179_974_266, 0.222_075_922_005_612_7],
    [2.856_970_013_872_806, 0.011_257_411_327_720_69],
];

impl Mixture<'_> {
    /// Means of z by the normal approximations.
    fn z(&self) -> Vec<f64> {
        let (n, first) = (self.forward.count(), self.forward.ratio() - self.forward.count());
        let mut mean = vec![0.0; n];
        for (solution, weight) in self.solutions.iter().zip(&self.weights) {
            let variances = solution.variances();
            for (k, mean) in mean.iter_mut().enumerate() {
                let at = |x: f64| {
                    Forward::z_of(solution.component.unknowns[first + k] + x * variances[first + k].sqrt())[0]
                };
                *mean += weight * QUADRATURE.iter().map(|[x, w]| w * at(*x)).sum::<f64>();
            }
        }
        mean.into_iter().map(|z| z.min(HIGHEST_Z)).collect()
    }
}

impl Sensitivity {
    /// True if the bulk modulus and the shear modulus have no z in common, or if z depends on rows that the others contradict.
    pub fn is_contradictory(&self) -> bool {
        self.has_split_moduli() || self.doubted.iter().any(Doubted::is_decisive)
    }

    /// True if the bulk modulus and the shear modulus have no z in common.
    pub fn has_split_moduli(&self) -> bool {
        self.bulk_less_shear.iter().any(|[difference, stddev]| difference.abs() > FAR * stddev)
    }

    /// Returns z under other assumptions; `estimate` is the estimate of `series`. This takes four more inversions by their normal
    /// approximations, and one for each pressure and row outside the central 95 % of its prediction.
    ///
    /// # Errors
    /// As [`infer_series`](crate::infer_series).
    pub fn of(
        estimate: &SeriesEstimate,
        series: &SpeedSeries,
        network: &RelaxationCalibration,
        prior: &SeriesPrior,
    ) -> Result<Self, EmtError> {
        series.check()?;
        let z =
            |prior: SeriesPrior| Mixture::of(Forward::new(series, network, &prior), series.ln_crossover).z();
        let split = SeriesPrior { is_split: true, ..prior.clone() };
        let apart = Mixture::of(Forward::new(series, network, &split), series.ln_crossover);
        let (draws, _) = apart.draws(SEED);
        let difference = |k: usize| {
            let all = Interval::of(draws.iter().map(|d| (d.bulk_less_shear[k], d.weight)));
            [all.mean, all.stddev]
        };
        Ok(Self {
            drifted: [-DRIFT, DRIFT].map(|drift| z(SeriesPrior { drift, ..prior.clone() })),
            without_slope: z(SeriesPrior { other_slope: Some(NO_SLOPE), ..prior.clone() }),
            bulk_less_shear: (0..apart.forward.count()).map(difference).collect(),
            doubted: Doubted::of(estimate, series, network, prior),
        })
    }
}
