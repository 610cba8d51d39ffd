//! Experiments that are simulated, and what they determine: a plan before any speed is measured.

use super::component::{Mixture, cells};
use super::draws::{SeriesDraw, normal};
use super::estimate::{Interval, SEED};
use super::forward::Forward;
use super::prior::SeriesPrior;
use super::sample::SpeedSeries;
use crate::calibration::RelaxationCalibration;
use crate::error::EmtError;
use crate::random::Random;
use nalgebra::{Cholesky, DVector};

/// An element of a list of weights that add up to 1.
fn chosen<T>(mut of: impl Iterator<Item = (T, f64)>, random: &mut Random) -> Option<T> {
    let mut left = random.uniform();
    of.find(|(_, weight)| {
        left -= weight;
        left <= 0.0
    })
    .map(|(found, _)| found)
}

/// A quantity of a sample that a series of speeds is about: `z`, `eps` and `eps_stiffness` (ε weighted by contact stiffness) at each
/// pressure, ε where directions are known; `stiffness_ratio` (k_t/k_n of the contacts) and `level` (ln of the moduli over those of the
/// contact law).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleQuantity {
    /// Name of the quantity.
    pub name: &'static str,
    /// Pressure, Pa, of those that depend on it.
    pub pressure: Option<f64>,
    /// Value, or standard deviation.
    pub value: f64,
}

/// The quantities of a sample from those at each pressure: z, ε and ε weighted by stiffness.
fn quantities(
    series: &SpeedSeries,
    of_pressures: [Vec<f64>; 3],
    [ratio, level]: [f64; 2],
) -> Vec<SampleQuantity> {
    let pressures = series.pressures();
    let names = ["z", "eps", "eps_stiffness"].into_iter().take(if series.has_directions() { 3 } else { 1 });
    let at = |(name, values): (&'static str, Vec<f64>)| {
        let each = pressures.clone().into_iter().zip(values);
        each.map(move |(p, value)| SampleQuantity { name, pressure: Some(p), value })
    };
    let last = [("stiffness_ratio", ratio), ("level", level)];
    let last = last.map(|(name, value)| SampleQuantity { name, pressure: None, value });
    names.zip(of_pressures).flat_map(at).chain(last).collect()
}

/// Draws a sample from the prior and simulates the rows of `series`, whose speeds are set: the true values of the sample. The same seed
/// gives the same sample, and the same errors in units of their standard deviations; `noise` is the error over the stated one, drawn
/// from the prior if it is not given.
///
/// # Errors
/// An invalid number.
pub fn simulate_series(
    series: &mut SpeedSeries,
    network: &RelaxationCalibration,
    prior: &SeriesPrior,
    noise: Option<f64>,
    seed: u64,
) -> Result<Vec<SampleQuantity>, EmtError> {
    let mut random = Random::new(seed);
    let random = &mut random;
    series.rows.iter_mut().for_each(|row| row.speed = Some(1.0));
    series.check()?;
    let forward = Forward::new(series, network, prior);
    let all = cells(&forward, prior, series.ln_crossover);
    let component = chosen(all.iter().map(|c| (c, c.ln_prior.exp())), random).unwrap_or(&all[0]);
    let drawn = chosen(prior.noises().into_iter().map(|[n, w]| (n, w)), random).unwrap_or(1.0);
    let (mean, _, factor) = &*component.normal;
    let unknowns = loop {
        let unknowns = mean + factor * normal(random, mean.len());
        if unknowns[forward.ratio()] > forward.lowest_ratio() {
            break unknowns;
        }
    };
    let at = forward.about(component.kind, component.preparation, &unknowns);
    let m = forward.rows.len();
    let cholesky = Cholesky::new(forward.unexplained(&at, m, noise.unwrap_or(drawn)));
    let cholesky =
        cholesky.ok_or(EmtError::NotFinite { quantity: "covariance of the speeds", value: f64::NAN })?;
    let off = cholesky.l() * normal(random, m);
    // A quantity with this covariance with the speeds and this variance, given the speeds.
    let mut given = |with: &DVector<f64>, variance: f64| {
        let left = variance - with.dot(&cholesky.solve(with));
        with.dot(&cholesky.solve(&off)) + left.max(0.0).sqrt() * random.normal::<1>()[0]
    };
    let mut eps_stiffness = forward.eps_stiffness(component.kind, &unknowns);
    for (k, eps) in eps_stiffness.iter_mut().enumerate() {
        let (with, variance) = forward.with_eps_stiffness(&at, k, m);
        *eps += given(&with, variance);
    }
    let ratio = unknowns[forward.ratio()].min(forward.mindlin);
    let level = given(&(Forward::by_level(&at, m) * forward.level), forward.level);
    let of_pressures = [forward.z(&unknowns), forward.eps_of(&unknowns), eps_stiffness];
    for (j, given) in forward.given.clone().into_iter().enumerate() {
        series.rows[given].speed = Some((at.ln_speed[j] + off[j]).exp());
    }
    Ok(quantities(series, of_pressures, [ratio, level]))
}

/// Standard deviations of what the speeds of `series` determine, and those of the prior.
///
/// # Errors
/// As [`infer_series`](super::estimate::infer_series).
pub fn series_stddev(
    series: &SpeedSeries,
    network: &RelaxationCalibration,
    prior: &SeriesPrior,
) -> Result<[Vec<SampleQuantity>; 2], EmtError> {
    series.check()?;
    let mixture = Mixture::of(Forward::new(series, network, prior), series.ln_crossover);
    if mixture.solutions.is_empty() {
        return Err(EmtError::NotFinite { quantity: "likelihood of the speeds", value: f64::NAN });
    }
    let of = |draws: &[SeriesDraw]| {
        let stddev =
            |of: &dyn Fn(&SeriesDraw) -> f64| Interval::of(draws.iter().map(|d| (of(d), d.weight))).stddev;
        let each =
            |of: fn(&SeriesDraw) -> &[f64]| (0..of(&draws[0]).len()).map(|k| stddev(&|d| of(d)[k])).collect();
        let of_pressures = [each(|d| &d.z), each(|d| &d.eps), each(|d| &d.eps_stiffness)];
        quantities(series, of_pressures, [stddev(&|d| d.stiffness_ratio), stddev(&|d| d.level)])
    };
    Ok([of(&mixture.draws(SEED).0), of(&mixture.of_prior(SEED))])
}
