//! Picks with their bias and error.

use super::ambient::rounding;
use super::cleaned::{LEAST_PER_PERIOD, cleaned, thinned};
use super::forward::Path;
use super::passage::{Passage, Record};
use super::separated::{Separated, fitted, largest};
use crate::error::AcousticsError;
use crate::noise::Noise;
use crate::time_of_flight::ArrivalPick;
use crate::time_of_flight::pick::Picker;
use grainlab_core::WaveMethod;
use rayon::prelude::*;

/// Number of computed records. Their scatter has an error of 9 % (1/√128).
const COPIES: u64 = 64;

/// Number of rounds in which the time at which the bias is found follows the time without it.
///
/// One round less makes the median error of waves in packings 0.03 % larger.
const ROUNDS: usize = 2;

/// Half a period. A feature that is further off belongs to another crest, and a wave of the wrong sign is off by this much.
///
/// Half a period bounds the bias. A computed record whose pick is off by more widens the error instead.
const HALF_PERIOD: f64 = 0.5;

/// Difference of two picks, in standard deviations, above which they contradict each other.
///
/// Normal errors differ by more in 0.3 %. The test of stated errors in packings allows 1 % of its records.
const APART: f64 = 3.0;

/// Standard deviation of a peak or a correlation of an unlike wave, periods over the relative difference of the correlations.
///
/// `records_that_end_inside_the_arrival_teach_the_error_of_an_unlike_shape` fits it.
const UNLIKE: f64 = 1.1;

/// Standard deviation of an onset beyond the scatter of computed records, periods.
///
/// `transducers_that_ring_teach_the_error_of_an_onset` fits it.
const BY_EYE: f64 = 0.11;

/// Standard deviation of a shear wave with a signal just before it, periods over the ratio of both signals.
///
/// `short_paths_teach_the_error_of_s_after_p` fits it.
const EARLIER: f64 = 2.5;

/// Standard deviation of a wave whose end is not in the record, over the time that is missing.
///
/// `records_that_end_early_in_the_arrival_teach_the_error_of_what_is_missing` fits it.
const UNSEEN: f64 = 0.37;

/// Errors that records of known speed taught, in the order of [`Pick::causes`].
pub(super) const TAUGHT: [f64; 4] = [UNLIKE, BY_EYE, EARLIER, UNSEEN];

/// Standard deviations from the middle to an end of a 95 % interval.
pub(super) const OF_INTERVAL: f64 = 1.96;

/// Share of the variance of a time that records of one path and mode have in common.
///
/// The share is 0.3 if the transducers do not ring, and 1 if they ring.
/// `records_of_one_path_have_less_in_common_than_is_stated_and_more_if_the_transducers_ring` tests that this constant is between.
pub(super) const ALIKE: f64 = 0.5;

/// Least length of a path, wavelengths, and speeds of waves in packings of grains, m/s.
///
/// Other results are refused, because they are no waves, or have a wrong unit.
const SHORTEST: f64 = 0.5;
const SPEEDS: std::ops::Range<f64> = 1.0..1e4;

/// Place of the noise of copies.
const PLACE: u64 = u64::MAX - 2;

/// The travel time of long waves by one pick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The feature that was picked.
    pub method: WaveMethod,
    /// Travel time, without that of the system and without the bias, s.
    pub time: f64,
    /// Standard deviation of the time, s.
    pub time_stddev: f64,
    /// Bias that was taken off: the feature arrives this much later than long waves, s.
    pub bias: f64,
    /// Speed of long waves, m/s.
    pub speed: f64,
    /// Standard deviation of the speed, m/s, with those of the distance and of the delay.
    pub speed_stddev: f64,
    /// Part of it that the records of one path and mode share, m/s: distance, delay, and half of the variance of the time but for what
    /// contradictory picks add.
    pub speed_common_stddev: f64,
    /// Part of the error of the time by which contradictory picks differ, s.
    apart: f64,
    /// What the constants of [`TAUGHT`] multiply, s.
    pub(super) causes: [f64; 4],
}

/// The picks of a record, and what was found of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Picks {
    /// The picks that found an arrival.
    pub picks: Vec<Pick>,
    /// Index of the one with the least error.
    pub recommended: usize,
    /// Reasons of the picks that found none.
    pub missing: Vec<(WaveMethod, String)>,
    /// Mean frequency of the source, Hz.
    pub frequency: f64,
    /// Distance over the wavelength at that frequency.
    pub wavelengths: f64,
    /// Largest sample of the arrival over the noise.
    pub signal_to_noise: f64,
    /// True if the receiver shows the wave with the opposite sign.
    pub reversed: bool,
    /// Crosstalk over the arrival.
    pub crosstalk: f64,
    /// The amplifier cut the largest samples of the receiver.
    pub is_cut: bool,
    /// Correlation of the arrival with a computed one, and the mean of those of computed records.
    pub alike: [f64; 2],
    /// From 0 to 1: the opposite sign fits the receiver no better than in computed records, or as well as the sign that was found. 0
    /// where the sign is given.
    pub sign_doubt: f64,
    /// True if two picks are further apart than their errors allow; the errors are then as large as the difference.
    pub contradictory: bool,
    /// Speed of the other candidate, m/s; the errors reach it. Of P it is a weaker wave before the one that was picked, which may be noise.
    /// Of S it is an earlier strong wave, which may be P. Without a mode it is the largest wave, where that follows the first strong one.
    pub other_speed: Option<f64>,
    /// Speed of the slowest wave that the record shows whole, m/s.
    pub slowest: f64,
    /// Sampling rate of the receiver as it was picked, Hz.
    pub sample_rate: f64,
    /// The receiver without offset and crosstalk, with the sign of the source, over the largest sample of the arrival.
    pub receiver: Vec<f64>,
}

/// Picks the arrival in `record` by every feature. `seed` is that of the computed records.
///
/// # Errors
/// Numbers out of range, and a record without an arrival that stands out of its noise by any pick.
pub fn picks(record: &Record, passage: &Passage, seed: u64) -> Result<Picks, AcousticsError> {
    let rounding = rounding(&record.receiver, &record.quiet);
    let record = &thinned(record)?;
    let (found, band) = cleaned(record, rounding, passage)?;
    let samples = found.source.len();
    let system = passage.delay * record.sample_rate;
    let pickers = [ArrivalPick::FirstArrival, ArrivalPick::CrossCorrelation, ArrivalPick::Peak].map(|pick| {
        let sent = &found.source[band.from..(band.from + band.duration as usize).min(samples)];
        (pick.method(), Picker::of(pick, sent, band.duration, band.frequency, samples))
    });
    let delay = |of: &Separated, (method, picker): &(WaveMethod, Picker)| {
        if *method == WaveMethod::FirstArrival {
            return Some(of.onset).filter(|t| t.is_finite()).ok_or("there is no onset before it".to_owned());
        }
        let height = largest(&of.receiver);
        let receiver: Vec<f64> = of.receiver.iter().map(|r| r / height).collect();
        let times = picker.times(&[&of.source, &receiver], of.noise / height)?;
        Ok::<f64, String>(times[1] - times[0])
    };
    let observed = pickers.each_ref().map(|picker| delay(&found, picker));
    let mut time = (found.delay - system).max(1.0);
    let kind = (passage.distance / passage.diameter, passage.longitudinal);
    let path = Path::between(&found.source, &found.receiver, &band, kind);
    let typical = path.typical();
    let mut picks = Vec::new();
    let mut missing = Vec::new();
    let (mut alike, mut opposite, mut early, mut first) = ([1.0; 2], 0.0, 0.0, None);
    for _ in 0..ROUNDS {
        let expected = path.arrival(time, system, &typical);
        let copy = |k: u64| {
            let mut random = Noise::at(seed, &[PLACE, k]);
            let arrival = path.arrival(time, system, &path.drawn(&mut random));
            let copy = found.with(&arrival, passage, &band, &mut random);
            let times = pickers.each_ref().map(|picker| delay(&copy, picker).ok());
            let begins = copy.begins.map(|begins| begins - system - time);
            let shape = [fitted(&copy.receiver, &expected).0, copy.opposite, copy.early];
            ComputedPick { times, shape, begins }
        };
        let copies: Vec<ComputedPick> = (0..COPIES).into_par_iter().map(copy).collect();
        first = found.begins.map(|observed| {
            let errors: Vec<f64> = copies.iter().filter_map(|copy| copy.begins).collect();
            let [late, _] = bias(&errors, HALF_PERIOD / band.frequency);
            (observed - system - late) / record.sample_rate
        });
        let mean = |k: usize| copies.iter().map(|copy| copy.shape[k]).sum::<f64>() / COPIES as f64;
        alike = [fitted(&found.receiver, &expected).0, mean(0)];
        opposite = mean(1);
        // Noise makes no larger signal before the onset of 64 computed records.
        early = found.early - copies.iter().map(|copy| copy.shape[2]).fold(0.0, f64::max);
        picks.clear();
        missing.clear();
        for (k, observed) in observed.iter().enumerate() {
            let method = pickers[k].0;
            let errors: Vec<f64> =
                copies.iter().filter_map(|copy| copy.times[k]).map(|t| t - system - time).collect();
            match observed {
                Ok(_) if errors.len() < 2 => missing.push((method, "the noise is too large".to_owned())),
                Ok(late) => {
                    let of_copies =
                        bias(&errors, HALF_PERIOD / band.frequency).map(|t| t / record.sample_rate);
                    picks.push(Pick::new(method, (late - system) / record.sample_rate, of_copies, passage));
                }
                Err(reason) => missing.push((method, reason.clone())),
            }
        }
        picks.retain(|p: &Pick| p.time > 0.0);
        let Some(best) = least(&picks) else { break };
        time = picks[best].time * record.sample_rate;
    }
    let period = 1.0 / (band.frequency * record.sample_rate);
    let whole = (samples as f64 - band.from as f64 - band.duration - system).max(1.0) / record.sample_rate;
    // Over the mean, which noise makes smaller, so that noise does not make the difference smaller.
    let unlike = (1.0 - alike[0] / alike[1]).max(0.0) * period;
    let sign_doubt = ((found.opposite - opposite) / (1.0 - opposite).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    // Where there is another candidate, it is the earlier signal, and the error covers both.
    let may_be_later = f64::from(passage.longitudinal != Some(true) && found.other.is_none());
    // Interpolation is of second order in the interval between samples. At the fewest samples in a period a feature is anywhere between
    // two samples of the source, and of the receiver.
    let sampled = (2.0 / 12f64).sqrt() * LEAST_PER_PERIOD * band.frequency.powi(2) * period;
    for p in &mut picks {
        // An onset has neither the shape nor the sign of a wave.
        let features = f64::from(p.method != WaveMethod::FirstArrival);
        p.causes = [
            features * unlike,
            (1.0 - features) * period,
            may_be_later * early.max(0.0) * period,
            (p.time - whole).max(0.0),
        ];
        let taught = std::array::from_fn::<f64, 4, _>(|k| TAUGHT[k] * p.causes[k]);
        let after = first.map_or(0.0, |first: f64| (p.time - first).max(0.0));
        let others = [p.time_stddev, HALF_PERIOD * features * sign_doubt * period, after, sampled];
        p.time_stddev = taught.iter().chain(&others).map(|e| e * e).sum::<f64>().sqrt();
        *p = p.with_speed(passage);
    }
    // An onset is found in any signal: the wave is that of another pick.
    if picks.iter().all(|p| p.method == WaveMethod::FirstArrival) {
        picks.clear();
    }
    let Some(recommended) = least(&picks) else {
        let reason = missing.first().map_or("it does not come after the source".to_owned(), |m| m.1.clone());
        return Err(AcousticsError::NoArrival(reason));
    };
    let best = picks[recommended];
    let apart = |p: &Pick| (p.time - best.time).abs();
    let contradictory = picks.iter().any(|p| apart(p) > APART * p.time_stddev.hypot(best.time_stddev));
    if contradictory {
        let most = picks.iter().map(apart).fold(0.0, f64::max);
        for p in &mut picks {
            *p = Pick { time_stddev: p.time_stddev.hypot(most), apart: most, ..*p }.with_speed(passage);
        }
    }
    let other =
        found.other.map(|late| late / record.sample_rate).filter(|late| picks[recommended].time + late > 0.0);
    let other_speed = other.map(|late| passage.distance / (picks[recommended].time + late));
    for p in picks.iter_mut().filter(|_| other.is_some()) {
        // The interval holds the other wave with its own error.
        let off = other_speed.map_or(0.0, |speed| (speed / p.speed - 1.0).abs() / OF_INTERVAL);
        *p = Pick { time_stddev: p.time_stddev + off * p.time, ..*p }.with_speed(passage);
    }
    let best = picks[recommended];
    let wavelengths = best.time * band.frequency * record.sample_rate;
    let per_grain = wavelengths * passage.diameter / passage.distance;
    let refusal = match best {
        _ if wavelengths < SHORTEST => Some(format!("its path would be {wavelengths:.1} wavelengths long")),
        _ if per_grain > 0.5 => Some(format!("its wavelength would be {:.1} diameters", 1.0 / per_grain)),
        p if band.from as f64 + (p.time + passage.delay) * record.sample_rate > samples as f64 => {
            Some("it would come after the end of the record".to_owned())
        }
        p if !SPEEDS.contains(&p.speed) => {
            Some(format!("its speed would be {:.1e} m/s; check the units", p.speed))
        }
        p if p.speed_stddev > 0.5 * p.speed => Some("the error is more than half of the speed".to_owned()),
        _ => None,
    };
    if let Some(refusal) = refusal {
        return Err(AcousticsError::NoArrival(refusal));
    }
    let frequency = band.frequency * record.sample_rate;
    Ok(Picks {
        recommended,
        missing,
        frequency,
        wavelengths,
        signal_to_noise: largest(&found.receiver) / found.ambient.rms,
        reversed: found.reversed,
        crosstalk: found.crosstalk,
        is_cut: found.is_cut,
        contradictory,
        alike,
        sign_doubt,
        other_speed,
        slowest: passage.distance / whole,
        sample_rate: record.sample_rate,
        receiver: found.clear.iter().map(|r| r / largest(&found.receiver)).collect(),
        picks,
    })
}

fn least(picks: &[Pick]) -> Option<usize> {
    (0..picks.len()).min_by(|a, b| picks[*a].time_stddev.total_cmp(&picks[*b].time_stddev))
}

/// What is picked in one computed record.
struct ComputedPick {
    /// Time of each picker, samples; `None` without a pick.
    times: [Option<f64>; 3],
    /// Agreement with the expected arrival, with its negative, and signal before the onset over the signal after it.
    shape: [f64; 3],
    /// Beginning of the wave later than the computed one, samples.
    begins: Option<f64>,
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

impl Pick {
    /// A pick of a feature after the time `read`, s, less its bias, s.
    fn new(method: WaveMethod, read: f64, [bias, time_stddev]: [f64; 2], passage: &Passage) -> Self {
        let [speed, speed_stddev, speed_common_stddev, apart] = [0.0; 4];
        let time = read - bias;
        let causes = [0.0; 4];
        Self { method, time, time_stddev, bias, speed, speed_stddev, speed_common_stddev, apart, causes }
            .with_speed(passage)
    }

    fn with_speed(self, passage: &Passage) -> Self {
        let speed = passage.distance / self.time;
        let of = |time_stddev: f64| {
            let relative = time_stddev.hypot(passage.delay_stddev) / self.time;
            speed * relative.hypot(passage.distance_stddev / passage.distance)
        };
        let speed_common_stddev =
            of((ALIKE * (self.time_stddev.powi(2) - self.apart.powi(2))).max(0.0).sqrt());
        Self { speed, speed_stddev: of(self.time_stddev), speed_common_stddev, ..self }
    }

    /// Part of the standard deviation of the speed that is of this record alone, m/s.
    pub fn speed_own_stddev(&self) -> f64 {
        (self.speed_stddev.powi(2) - self.speed_common_stddev.powi(2)).max(0.0).sqrt()
    }
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
