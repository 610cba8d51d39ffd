//! z without rows that the others contradict: what an outlier does to an answer.

use super::component::Mixture;
use super::estimate::{FEWEST, Interval, SEED, SeriesEstimate};
use super::forward::Forward;
use super::prior::SeriesPrior;
use super::sample::SpeedSeries;
use crate::calibration::RelaxationCalibration;
use serde::Serialize;

/// Standard deviations of z by which rows that the others contradict may move it.
const MOVED: f64 = 2.0;

/// p below which a pressure or row is left out on trial: z may depend on speeds outside the central 95 % of their prediction, although
/// they do not contradict the others by [`SeriesEstimate::CONTRADICTORY`].
const OUTSIDE: f64 = 0.05;

/// Rows that the others contradict, all of one pressure or a single one, and z without them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Doubted {
    /// Places of the rows in the series.
    pub rows: Vec<usize>,
    /// z at each pressure without these rows: mean and standard deviation.
    pub z: Vec<[f64; 2]>,
    /// Place of the pressure at which they move z most.
    pub place: usize,
    /// Difference of z there without them and with them, in standard deviations of z with them.
    pub moved: f64,
}

impl Doubted {
    /// True if the rows move z by more than two of its standard deviations.
    pub fn is_decisive(&self) -> bool {
        self.moved.abs() > MOVED
    }

    /// The rows of each pressure, and each row, that all others contradict, or that are decisive and outside their prediction; none
    /// that leave nothing that can be sampled.
    pub(super) fn of(
        estimate: &SeriesEstimate,
        series: &SpeedSeries,
        network: &RelaxationCalibration,
        prior: &SeriesPrior,
    ) -> Vec<Self> {
        let pressures = series.pressures();
        let is_outside = |p: &Option<f64>| p.is_some_and(|p| p < OUTSIDE);
        let is_at = |n: &usize, k: usize| {
            series.rows[*n].speed.is_some() && SpeedSeries::place(&pressures, &series.rows[*n]) == k
        };
        let all = 0..series.rows.len();
        let of_pressures = estimate.pressures.iter().enumerate().map(|(k, of)| {
            let rows: Vec<usize> = all.clone().filter(|n| is_at(n, k)).collect();
            (rows, of.p)
        });
        let mut groups: Vec<_> = of_pressures.filter(|(_, p)| is_outside(p)).collect();
        for (n, of) in estimate.rows.iter().enumerate().filter(|(_, of)| is_outside(&of.p)) {
            if !groups.iter().any(|(rows, _)| *rows == [n]) {
                groups.push((vec![n], of.p));
            }
        }
        let without = |(rows, p): (Vec<usize>, Option<f64>)| {
            let z = z_without(&rows, series, network, prior)?;
            let moved =
                z.iter().zip(&estimate.pressures).map(|([z, _], with)| (z - with.z.mean) / with.z.stddev);
            let (place, moved) = moved.enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
            let doubted = Self { rows, z, place, moved };
            let is_contradicted = p.is_some_and(|p| p < SeriesEstimate::CONTRADICTORY);
            (is_contradicted || doubted.is_decisive()).then_some(doubted)
        };
        groups.into_iter().filter_map(without).collect()
    }
}

/// z at each pressure of the series, inferred without these rows; `None` if what is left cannot be sampled.
fn z_without(
    rows: &[usize],
    series: &SpeedSeries,
    network: &RelaxationCalibration,
    prior: &SeriesPrior,
) -> Option<Vec<[f64; 2]>> {
    let mut rest = series.clone();
    rows.iter().for_each(|n| rest.rows[*n].speed = None);
    let mixture = Mixture::of(Forward::new(&rest, network, prior), rest.ln_crossover);
    let (draws, effective_draws) = mixture.draws(SEED);
    let of = |k: usize| {
        let z = Interval::of(draws.iter().map(|d| (d.z[k], d.weight))).cut();
        [z.mean, z.stddev]
    };
    (effective_draws >= FEWEST).then(|| (0..mixture.forward.count()).map(of).collect())
}
