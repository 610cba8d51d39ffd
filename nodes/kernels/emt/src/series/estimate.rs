//! Inferred structure of a sample, and its dependence on what was assumed.

use super::check::LeftOut;
use super::component::Mixture;
use super::draws::SeriesDraw;
use super::forward::Forward;
use super::gain::ContactKind;
use super::prior::SeriesPrior;
use super::sample::SpeedSeries;
use crate::calibration::{NetworkState, RelaxationCalibration};
use crate::checks::FALSE_ALARM;
use crate::error::EmtError;
use grainlab_core::notes::Note;
use serde::Serialize;

/// No z above is stated: packings of the calibration have none.
pub(super) const HIGHEST_Z: f64 = 6.6;

/// Effective number of draws below which nothing is stated.
pub(super) const FEWEST: f64 = 30.0;

pub(super) const SEED: u64 = 31;

/// k_t/k_n closer than this to an end of its range is at it.
const AT_END: f64 = 0.05;

/// Standard deviations of a difference that contradicts.
pub(super) const FAR: f64 = 3.0;

/// Probability of a contact law or preparation below which nothing is said of it.
const UNLIKELY: f64 = 0.05;

/// A marginal distribution: mean, standard deviation, and the ends of the central 95 %.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Interval {
    /// Mean of the distribution.
    pub mean: f64,
    /// Standard deviation of it.
    pub stddev: f64,
    /// 2.5 % quantile.
    pub low: f64,
    /// 97.5 % quantile.
    pub high: f64,
    /// Standard deviation of the prior.
    pub prior_stddev: f64,
}

impl Interval {
    /// Distribution of weighted values; the weights need not add up to 1.
    pub(super) fn of(values: impl Iterator<Item = (f64, f64)>) -> Self {
        let mut all: Vec<(f64, f64)> = values.collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let sum: f64 = all.iter().map(|(_, w)| w).sum();
        let mean = all.iter().map(|(v, w)| v * w).sum::<f64>() / sum;
        let variance = all.iter().map(|(v, w)| (v - mean).powi(2) * w).sum::<f64>() / sum;
        let quantile = |q: f64| {
            let mut below = 0.0;
            let place = all.iter().position(|(_, w)| {
                below += w;
                below >= q * sum
            });
            place.map_or(f64::NAN, |n| all[n].0)
        };
        Self {
            mean,
            stddev: variance.sqrt(),
            low: quantile(0.025),
            high: quantile(0.975),
            prior_stddev: f64::NAN,
        }
    }

    /// Share of the standard deviation of the prior that is left.
    pub fn left(&self) -> f64 {
        self.stddev / self.prior_stddev
    }

    /// True if the data say almost nothing: more than .8 of the prior's standard deviation is left.
    pub fn is_undetermined(&self) -> bool {
        self.left() > 0.8
    }

    /// True if 0 is further off than is assumed: more than three standard deviations of the prior.
    pub(crate) fn is_far(&self) -> bool {
        self.mean.abs() > FAR * self.prior_stddev
    }

    pub(super) fn cut(self) -> Self {
        let cut = |v: f64| v.min(HIGHEST_Z);
        Self { mean: cut(self.mean), low: cut(self.low), high: cut(self.high), ..self }
    }
}

/// The structure at one pressure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PressureEstimate {
    /// Confining pressure, Pa.
    pub pressure: f64,
    /// Coordination number without rattlers.
    pub z: Interval,
    /// Probability of a z beyond those that are stated.
    pub z_beyond: f64,
    /// Probability of a z below the lowest of the calibration's packings.
    pub z_below: f64,
    /// ε; `None` without speeds in two directions.
    pub eps: Option<Interval>,
    /// ε weighted by contact stiffness.
    pub eps_stiffness: Option<Interval>,
    /// Probability of worse speeds at this pressure, predicted from the others; `None` of the only pressure.
    pub p: Option<f64>,
    /// The quantity of the state that is outside the packings of the calibration: p/E* first, then the sizes.
    #[serde(skip)]
    pub outside: Option<Note>,
}

/// One row of the series.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RowEstimate {
    /// Speed predicted from the other pressures (of the only pressure: from the other rows), m/s, and its standard deviation; of a
    /// row without a speed from all rows.
    pub predicted: f64,
    /// Standard deviation of the prediction, m/s.
    pub stddev: f64,
    /// The measured speed against it.
    pub left_out: Option<LeftOut>,
    /// The measured speed against its prediction from all other rows.
    pub by_rows: Option<LeftOut>,
    /// Probability of a worse speed, predicted from all other rows.
    pub p: Option<f64>,
}

/// A family of contact laws, after the data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LawEstimate {
    /// Family of the law.
    pub law: ContactKind,
    /// Probability of the family.
    pub probability: f64,
    /// ln of the crossover pressure, Pa; `None` without one.
    pub ln_crossover: Option<Interval>,
    /// Mean of z at each pressure under this family alone.
    pub z: Vec<f64>,
}

/// Inferred structure and contacts of a sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeriesEstimate {
    /// Structure at each pressure.
    pub pressures: Vec<PressureEstimate>,
    /// Rows, in the order of the series.
    pub rows: Vec<RowEstimate>,
    /// k_t/k_n of the contacts.
    pub stiffness_ratio: Interval,
    /// Probability that k_t/k_n is at the lowest that was assumed, and at Mindlin's.
    pub at_ends: [f64; 2],
    /// ln of the moduli over those of the contact law with the given material and density: one scale of grain modulus, density and
    /// contact stiffness.
    pub level: Interval,
    /// Scatter of the speeds over the stated errors; below 1, what it leaves of these is common to the rows of a mode and direction.
    pub noise: Interval,
    /// Families of contact laws.
    pub laws: Vec<LawEstimate>,
    /// Preparations with their probabilities.
    pub preparations: Vec<(String, f64)>,
    /// Probability of data that are less probable than these, under all that was assumed.
    pub p: f64,
    /// Probability of speeds that differ more by their stated errors, of waves that are one modulus; `None` without such waves.
    pub p_twins: Option<f64>,
    /// ln of the evidence.
    pub ln_evidence: f64,
    /// Effective number of draws.
    pub effective_draws: f64,
}

impl SeriesEstimate {
    /// p below which data contradict each other or the model.
    pub const CONTRADICTORY: f64 = 0.01;

    /// True if the data contradict each other, or what was assumed: as a whole, at one of the pressures (of a
    /// single one, in one row), by their level, or in waves that are one modulus.
    pub fn is_contradictory(&self) -> bool {
        let of_pressures: Vec<f64> = self.pressures.iter().filter_map(|p| p.p).collect();
        let of_rows = || self.rows.iter().filter_map(|r| r.p).collect();
        let parts = if of_pressures.is_empty() { of_rows() } else { of_pressures };
        let of_parts = parts.iter().copied().fold(1.0, f64::min) * parts.len() as f64;
        self.p.min(of_parts) < Self::CONTRADICTORY || self.has_far_level() || self.has_unequal_twins()
    }

    /// True if waves that are one modulus differ by more than chance and their stated errors allow.
    pub fn has_unequal_twins(&self) -> bool {
        self.p_twins.is_some_and(|p| p < FALSE_ALARM)
    }

    /// True if the moduli are further from those of the law with the given material and density than is assumed of any sample.
    pub fn has_far_level(&self) -> bool {
        self.level.is_far()
    }
}

/// Infers the structure of a sample at each pressure, and its contacts. Takes about a second.
///
/// # Errors
/// An invalid number, or data so far beyond the model that its posterior cannot be sampled.
pub fn infer_series(
    series: &SpeedSeries,
    network: &RelaxationCalibration,
    prior: &SeriesPrior,
) -> Result<SeriesEstimate, EmtError> {
    series.check()?;
    let mixture = Mixture::of(Forward::new(series, network, prior), series.ln_crossover);
    if mixture.solutions.is_empty() {
        return Err(EmtError::NotFinite { quantity: "likelihood of the speeds", value: f64::NAN });
    }
    let (draws, effective_draws) = mixture.draws(SEED);
    if !effective_draws.is_finite() || effective_draws < FEWEST {
        return Err(EmtError::NotSampled {
            model: "of a series",
            reason: "the sampling failed; do not use these numbers: the speeds are far from those of any contacts between these grains; check the \
                     columns, pressure, material, density and units",
        });
    }
    let before = mixture.of_prior(SEED);
    let forward = &mixture.forward;
    let marginal = |of: &dyn Fn(&SeriesDraw) -> f64| {
        let spread = |all: &[SeriesDraw]| Interval::of(all.iter().map(|d| (of(d), d.weight)));
        Interval { prior_stddev: spread(&before).stddev, ..spread(&draws) }
    };
    let probability = |of: &dyn Fn(&SeriesDraw) -> bool| -> f64 {
        draws.iter().filter(|d| of(d)).map(|d| d.weight).fold(0.0, |a, w| a + w)
    };
    let determined = series.has_directions();
    let groups = Groups::of(&mixture);
    let pressures = (0..forward.count())
        .map(|k| PressureEstimate {
            pressure: forward.pressures[k],
            z: marginal(&|d| d.z[k]).cut(),
            z_beyond: probability(&|d| d.z[k] > HIGHEST_Z),
            z_below: probability(&|d| d.z[k] < network.reach.z[0]),
            eps: determined.then(|| marginal(&|d| d.eps[k])),
            eps_stiffness: determined.then(|| marginal(&|d| d.eps_stiffness[k])),
            p: groups.of_pressures[k],
            outside: outside(series, network, forward.pressures[k]),
        })
        .collect();
    let laws = prior.contact.iter().map(|c| c.law).map(|law| {
        let probability = probability(&|d| d.kind == law);
        let is_likely = law.has_crossover() && probability > UNLIKELY;
        let of_law = |all: &[SeriesDraw]| {
            Interval::of(all.iter().filter(|d| d.kind == law).map(|d| (d.ln_crossover, d.weight)))
        };
        let ln_crossover =
            is_likely.then(|| Interval { prior_stddev: of_law(&before).stddev, ..of_law(&draws) });
        let z = (0..forward.count()).map(|k| {
            let of_law = draws.iter().filter(|d| d.kind == law).map(|d| (d.z[k], d.weight));
            Interval::of(of_law).mean.min(HIGHEST_Z)
        });
        LawEstimate { law, probability, ln_crossover, z: z.collect() }
    });
    let preparations = prior.preparation.iter().enumerate();
    let preparations = preparations.map(|(n, of)| (of.name.clone(), probability(&|d| d.preparation == n)));
    let mut rows = vec![None; forward.rows.len()];
    for (j, given) in forward.given.iter().enumerate() {
        rows[*given] = Some(match j.checked_sub(forward.measured) {
            None => {
                let left = groups.rows[j];
                let stddev = left.map_or(f64::NAN, |l| l.stddev);
                let ln = mixture.data[j] - left.map_or(f64::NAN, |l| l.residual);
                let p = groups.of_rows[j];
                let by_rows = groups.by_rows[j];
                RowEstimate { predicted: ln.exp(), stddev: stddev * ln.exp(), left_out: left, by_rows, p }
            }
            Some(n) => {
                let ln = Interval::of(draws.iter().map(|d| (d.predicted[n], d.weight)));
                RowEstimate {
                    predicted: ln.mean.exp(),
                    stddev: ln.stddev * ln.mean.exp(),
                    left_out: None,
                    by_rows: None,
                    p: None,
                }
            }
        });
    }
    Ok(SeriesEstimate {
        pressures,
        rows: rows.into_iter().flatten().collect(),
        stiffness_ratio: marginal(&|d| d.stiffness_ratio),
        at_ends: [
            probability(&|d| d.stiffness_ratio < prior.lowest_stiffness_ratio + AT_END),
            probability(&|d| d.stiffness_ratio > forward.mindlin - AT_END),
        ],
        level: marginal(&|d| d.level),
        noise: marginal(&|d| d.noise),
        laws: laws.collect(),
        preparations: preparations.collect(),
        p: mixture.contradiction(SEED),
        p_twins: series.p_twins(),
        ln_evidence: mixture.ln_evidence(),
        effective_draws,
    })
}

/// The first quantity of the state at this pressure that is outside the packings of the calibration. k_t/k_n is inferred, from a
/// range of its own.
fn outside(series: &SpeedSeries, network: &RelaxationCalibration, pressure: f64) -> Option<Note> {
    let sizes = series.size_variance[0].sqrt();
    let state = NetworkState::of(pressure, &series.material, sizes, series.stress_ratio[0]);
    let all = network.reach.outside(pressure / series.material.effective_young(), &state);
    let of_state = all.into_iter().filter(|o| o.is_extrapolation() && o.quantity != "k_t/k_n");
    of_state.map(|outside| outside.note()).next()
}

/// Predictions without each pressure, and without each row.
struct Groups {
    rows: Vec<Option<LeftOut>>,
    by_rows: Vec<Option<LeftOut>>,
    of_pressures: Vec<Option<f64>>,
    of_rows: Vec<Option<f64>>,
}

impl Groups {
    fn of(mixture: &Mixture<'_>) -> Self {
        let forward = &mixture.forward;
        let m = forward.measured;
        let mut found = Self {
            rows: vec![None; m],
            by_rows: vec![None; m],
            of_pressures: vec![None; forward.count()],
            of_rows: vec![None; m],
        };
        if m < 2 {
            return found;
        }
        for j in 0..m {
            let (rows, p) = mixture.leave_out(&[j]);
            (found.by_rows[j], found.of_rows[j]) = (rows.first().copied(), Some(p));
            found.rows[j] = found.by_rows[j];
        }
        for k in 0..forward.count() {
            let group: Vec<usize> = (0..m).filter(|j| forward.place[*j] == k).collect();
            if group.is_empty() || group.len() == m {
                continue;
            }
            let (rows, p) = mixture.leave_out(&group);
            found.of_pressures[k] = Some(p);
            group.iter().zip(rows).for_each(|(j, row)| found.rows[*j] = Some(row));
        }
        found
    }
}
