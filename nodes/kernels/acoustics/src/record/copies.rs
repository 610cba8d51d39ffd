//! The arrival in a record, and the picks less their bias in computed copies of the record.

use super::ambient::rounding;
use super::band::Band;
use super::cleaned::{cleaned, thinned};
use super::forward::Path;
use super::passage::{Passage, Record};
use super::pick::Pick;
use super::separated::{Separated, fitted, largest};
use crate::error::AcousticsError;
use crate::noise::Noise;
use crate::time_of_flight::ArrivalPick;
use crate::time_of_flight::pick::Picker;
use grainlab_core::WaveMethod;
use rayon::prelude::*;

/// Number of computed records. Their scatter has an error of 9 % (1/√128).
const COPIES: u64 = 64;

/// Half a period. A feature that is further off belongs to another crest, and a wave of the wrong sign is off by this much.
///
/// Half a period bounds the bias. A computed record whose pick is off by more widens the error instead.
pub(super) const HALF_PERIOD: f64 = 0.5;

const NOISE_PLACE: u64 = u64::MAX - 2;

/// The arrival in a record. Its times are in samples.
pub(super) struct Arrival<'a> {
    pub(super) found: Separated,
    pub(super) band: Band,
    pub(super) passage: &'a Passage,
    /// Sampling rate, Hz.
    pub(super) sample_rate: f64,
    path: Path,
    /// Pickers of the correlation and of the peak.
    pickers: [Picker; 2],
}

struct Copied {
    /// Time of each feature; `None` without a pick.
    times: [Option<f64>; 3],
    /// Beginning of a compression wave.
    begins: Option<f64>,
    /// Correlation with the expected arrival.
    correlation: f64,
    opposite: f64,
    early: f64,
}

/// A record compared with computed copies for one travel time.
pub(super) struct Compared {
    /// The picks less their bias, with the scatter in the copies as error.
    pub(super) picks: Vec<Pick>,
    /// Reasons of the features without a pick.
    pub(super) missing: Vec<(WaveMethod, String)>,
    /// Correlation of the arrival with the expected one, and the mean correlation of the copies.
    pub(super) correlations: [f64; 2],
    /// From 0 to 1: see `Picks::sign_doubt`.
    pub(super) sign_doubt: f64,
    /// Signal before the onset beyond any copy's, over the signal after it.
    pub(super) early: f64,
    /// Travel time by the place where the wave begins, s; `None` where it is not known.
    pub(super) begins: Option<f64>,
}

impl<'a> Arrival<'a> {
    pub(super) fn of(record: &Record, passage: &'a Passage) -> Result<Self, AcousticsError> {
        let rounding = rounding(&record.receiver, &record.quiet);
        let record = thinned(record)?;
        let (found, band) = cleaned(&record, rounding, passage)?;
        let samples = found.source.len();
        let sent = &found.source[band.from..(band.from + band.duration as usize).min(samples)];
        let pickers = [ArrivalPick::CrossCorrelation, ArrivalPick::Peak]
            .map(|pick| Picker::of(pick, sent, band.duration, band.frequency, samples));
        let kind = (passage.distance / passage.diameter, passage.longitudinal);
        let path = Path::between(&found.source, &found.receiver, &band, kind);
        Ok(Self { found, band, passage, sample_rate: record.sample_rate, path, pickers })
    }

    /// Travel time by correlation alone.
    pub(super) fn delay(&self) -> f64 {
        (self.found.delay - self.band.system).max(1.0)
    }

    /// Travel time of the slowest wave that the record shows whole, s.
    pub(super) fn longest_time(&self) -> f64 {
        let Band { from, duration, system, .. } = self.band;
        (self.found.source.len() as f64 - from as f64 - duration - system).max(1.0) / self.sample_rate
    }

    /// Times of onset, correlation and peak in a record of this arrival.
    fn times(&self, record: &Separated) -> [(WaveMethod, Result<f64, String>); 3] {
        let onset = Some(record.onset).filter(|time| time.is_finite());
        let height = largest(&record.receiver);
        let receiver: Vec<f64> = record.receiver.iter().map(|sample| sample / height).collect();
        let [correlation, peak] = self.pickers.each_ref().map(|picker| {
            let times = picker.times(&[&record.source, &receiver], record.noise / height)?;
            Ok(times[1] - times[0])
        });
        [
            (WaveMethod::FirstArrival, onset.ok_or_else(|| "there is no onset before it".to_owned())),
            (WaveMethod::CrossCorrelation, correlation),
            (WaveMethod::Peak, peak),
        ]
    }

    pub(super) fn compared(&self, time: f64, seed: u64) -> Compared {
        let (found, system) = (&self.found, self.band.system);
        let expected = self.path.arrival(time, system, &self.path.typical());
        let copy = |k: u64| {
            let mut random = Noise::at(seed, &[NOISE_PLACE, k]);
            let arrival = self.path.arrival(time, system, &self.path.drawn(&mut random));
            let found = found.with(&arrival, self.passage, &self.band, &mut random);
            let times = self.times(&found).map(|(_, time)| time.ok());
            let correlation = fitted(&found.receiver, &expected).0;
            let Separated { begins, opposite, early, .. } = found;
            Copied { times, begins, correlation, opposite, early }
        };
        let copies: Vec<Copied> = (0..COPIES).into_par_iter().map(copy).collect();
        let mean = |value: fn(&Copied) -> f64| copies.iter().map(value).sum::<f64>() / COPIES as f64;
        let bias_of = |times: &dyn Fn(&Copied) -> Option<f64>| {
            let errors: Vec<f64> = copies.iter().filter_map(times).map(|t| t - system - time).collect();
            (errors.len(), bias(&errors, HALF_PERIOD / self.band.frequency))
        };
        let (mut picks, mut missing) = (Vec::new(), Vec::new());
        for (feature, (method, observed)) in self.times(found).into_iter().enumerate() {
            match (observed, bias_of(&|copy| copy.times[feature])) {
                (Err(reason), _) => missing.push((method, reason)),
                (Ok(_), (0 | 1, _)) => missing.push((method, "the noise is too large".to_owned())),
                (Ok(late), (_, bias)) => {
                    let bias = bias.map(|samples| samples / self.sample_rate);
                    picks.push(Pick::new(method, (late - system) / self.sample_rate, bias));
                }
            }
        }
        picks.retain(|pick| pick.time > 0.0);
        let late = |begins: f64| begins - system - bias_of(&|copy| copy.begins).1[0];
        let opposite = mean(|copy| copy.opposite);
        Compared {
            picks,
            missing,
            correlations: [fitted(&found.receiver, &expected).0, mean(|copy| copy.correlation)],
            sign_doubt: ((found.opposite - opposite) / (1.0 - opposite).max(f64::MIN_POSITIVE))
                .clamp(0.0, 1.0),
            // Noise makes no larger signal before the onset of 64 computed records.
            early: (found.early - copies.iter().map(|copy| copy.early).fold(0.0, f64::max)).max(0.0),
            begins: found.begins.map(|begins| late(begins) / self.sample_rate),
        }
    }
}

/// Returns the mean error of a pick in computed records, which is at most `most`, and the standard deviation about it.
///
/// The mean leaves out errors that are further than `most` from their median.
fn bias(errors: &[f64], most: f64) -> [f64; 2] {
    let n = errors.len() as f64;
    let mut sorted = errors.to_vec();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let near: Vec<f64> = sorted.into_iter().filter(|e| (e - median).abs() <= most).collect();
    let bias = (near.iter().sum::<f64>() / near.len() as f64).clamp(-most, most);
    let variance = errors.iter().map(|e| (e - bias).powi(2)).sum::<f64>() / (n - 1.0);
    [bias, (variance * (1.0 + 1.0 / n)).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_records_whose_pick_is_off_by_a_period_widen_the_error_and_do_not_move_the_pick() {
        let errors: Vec<f64> =
            (0..64).map(|k| if k % 5 == 0 { -10.0 } else { f64::from(k % 3) * 0.1 }).collect();
        let [found, stddev] = bias(&errors, 5.0);
        assert!((found - 0.1).abs() < 0.02, "{found}");
        assert!((stddev - 10.0 * (13.0f64 / 64.0).sqrt()).abs() < 0.5, "{stddev}");
        assert_eq!(bias(&[-9.0; 64], 5.0)[0], -5.0);
    }
}
