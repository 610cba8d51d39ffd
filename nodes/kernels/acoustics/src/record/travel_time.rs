//! Picks with their bias and error.

use super::cleaned::LEAST_PER_PERIOD;
use super::copies::{Arrival, Compared, HALF_PERIOD};
use super::passage::{Passage, Record};
use super::pick::Pick;
use super::separated::largest;
use crate::error::AcousticsError;
use grainlab_core::WaveMethod;

/// Number of rounds in which the time at which the bias is found follows the time without it.
///
/// One round less makes the median error of waves in packings 0.03 % larger.
const ROUNDS: usize = 2;

/// Difference of two picks, in standard deviations, above which they contradict each other.
///
/// Normal errors differ by more in 0.3 %. The test of stated errors in packings allows 1 % of its records.
const PICK_CONFLICT_SIGMAS: f64 = 3.0;

/// Standard deviation of a peak or a correlation of an unlike wave, periods over the relative difference of the correlations.
///
/// `records_that_end_inside_the_arrival_teach_the_error_of_an_unlike_shape` fits it.
const UNLIKE_SHAPE_STDDEV: f64 = 1.1;

/// Standard deviation of an onset beyond the scatter of computed records, periods.
///
/// `transducers_that_ring_teach_the_error_of_an_onset` fits it.
const ONSET_STDDEV: f64 = 0.11;

/// Standard deviation of a shear wave with a signal just before it, periods over the ratio of both signals.
///
/// `short_paths_teach_the_error_of_s_after_p` fits it.
const EARLIER_SIGNAL_STDDEV: f64 = 2.5;

/// Standard deviation of a wave whose end is not in the record, over the time that is missing.
///
/// `records_that_end_early_in_the_arrival_teach_the_error_of_what_is_missing` fits it.
const UNSEEN_END_STDDEV: f64 = 0.37;

/// Errors that records of known speed taught, in the order of [`Pick::causes`].
pub(super) const TAUGHT: [f64; 4] =
    [UNLIKE_SHAPE_STDDEV, ONSET_STDDEV, EARLIER_SIGNAL_STDDEV, UNSEEN_END_STDDEV];

/// Standard deviations from the middle to an end of a 95 % interval.
pub(super) const SIGMAS_OF_INTERVAL: f64 = 1.96;

/// Least length of a path, wavelengths, and speeds of waves in packings of grains, m/s.
///
/// Other results are refused, because they are no waves, or have a wrong unit.
const LEAST_WAVELENGTHS: f64 = 0.5;
const SPEEDS: std::ops::Range<f64> = 1.0..1e4;

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
    let arrival = Arrival::of(record, passage)?;
    let mut compared = arrival.compared(arrival.delay(), seed);
    for _ in 1..ROUNDS {
        let Some(best) = least(&compared.picks) else { break };
        compared = arrival.compared(compared.picks[best].time * arrival.sample_rate, seed);
    }
    let mut picks: Vec<Pick> =
        compared.picks.iter().map(|pick| with_errors_beyond_copies(pick, &arrival, &compared)).collect();
    // An onset is found in any signal: the wave is that of another pick.
    if picks.iter().all(|p| p.method == WaveMethod::FirstArrival) {
        picks.clear();
    }
    let missing = compared.missing;
    let Some(recommended) = least(&picks) else {
        let reason = missing.first().map_or("it does not come after the source".to_owned(), |m| m.1.clone());
        return Err(AcousticsError::NoArrival(reason));
    };
    let contradictory = cover_contradiction(&mut picks, recommended, passage);
    let found = &arrival.found;
    let other = found.other.map(|late| picks[recommended].time + late / arrival.sample_rate);
    let other_speed = other.filter(|time| *time > 0.0).map(|time| passage.distance / time);
    for pick in picks.iter_mut().filter(|_| other_speed.is_some()) {
        // The interval holds the other wave with its own error.
        let off = other_speed.map_or(0.0, |speed| (speed / pick.speed - 1.0).abs() / SIGMAS_OF_INTERVAL);
        *pick = pick.with_error(pick.time_stddev + off * pick.time, passage);
    }
    let wavelengths = picks[recommended].time * arrival.band.frequency * arrival.sample_rate;
    if let Some(refusal) = refusal(&picks[recommended], wavelengths, &arrival) {
        return Err(AcousticsError::NoArrival(refusal));
    }
    Ok(Picks {
        recommended,
        missing,
        frequency: arrival.band.frequency * arrival.sample_rate,
        wavelengths,
        signal_to_noise: largest(&found.receiver) / found.ambient.rms,
        reversed: found.reversed,
        crosstalk: found.crosstalk,
        is_cut: found.is_cut,
        contradictory,
        alike: compared.correlations,
        sign_doubt: compared.sign_doubt,
        other_speed,
        slowest: passage.distance / arrival.longest_time(),
        sample_rate: arrival.sample_rate,
        receiver: found.clear.iter().map(|r| r / largest(&found.receiver)).collect(),
        picks,
    })
}

/// Widens the errors of all picks to the largest difference from the recommended one, if two contradict each other; then returns true.
fn cover_contradiction(picks: &mut [Pick], recommended: usize, passage: &Passage) -> bool {
    let best = picks[recommended];
    let difference = |pick: &Pick| (pick.time - best.time).abs();
    let is_far =
        |pick: &Pick| difference(pick) > PICK_CONFLICT_SIGMAS * pick.time_stddev.hypot(best.time_stddev);
    let contradictory = picks.iter().any(is_far);
    if contradictory {
        let apart = picks.iter().map(difference).fold(0.0, f64::max);
        for pick in picks {
            *pick = Pick { apart, ..*pick }.with_error(pick.time_stddev.hypot(apart), passage);
        }
    }
    contradictory
}

fn refusal(best: &Pick, wavelengths: f64, arrival: &Arrival<'_>) -> Option<String> {
    let passage = arrival.passage;
    let per_grain = wavelengths * passage.diameter / passage.distance;
    let arrives = arrival.band.from as f64 + (best.time + passage.delay) * arrival.sample_rate;
    if wavelengths < LEAST_WAVELENGTHS {
        Some(format!("its path would be {wavelengths:.1} wavelengths long"))
    } else if per_grain > 0.5 {
        Some(format!("its wavelength would be {:.1} diameters", 1.0 / per_grain))
    } else if arrives > arrival.found.source.len() as f64 {
        Some("it would come after the end of the record".to_owned())
    } else if !SPEEDS.contains(&best.speed) {
        Some(format!("its speed would be {:.1e} m/s; check the units", best.speed))
    } else if best.speed_stddev > 0.5 * best.speed {
        Some("the error is more than half of the speed".to_owned())
    } else {
        None
    }
}

fn least(picks: &[Pick]) -> Option<usize> {
    (0..picks.len()).min_by(|a, b| picks[*a].time_stddev.total_cmp(&picks[*b].time_stddev))
}

fn with_errors_beyond_copies(pick: &Pick, arrival: &Arrival<'_>, compared: &Compared) -> Pick {
    let (found, band, passage) = (&arrival.found, &arrival.band, arrival.passage);
    let period = 1.0 / (band.frequency * arrival.sample_rate);
    // An onset has neither the shape nor the sign of a wave.
    let is_onset = pick.method == WaveMethod::FirstArrival;
    let [of_onset, of_wave] = if is_onset { [period, 0.0] } else { [0.0, period] };
    // Over the mean, which noise makes smaller, so that noise does not make the difference smaller.
    let unlike = (1.0 - compared.correlations[0] / compared.correlations[1]).max(0.0);
    // Where there is another candidate, it is the earlier signal, and the error covers both.
    let may_be_later = passage.longitudinal != Some(true) && found.other.is_none();
    let causes = [
        unlike * of_wave,
        of_onset,
        if may_be_later { compared.early * period } else { 0.0 },
        (pick.time - arrival.longest_time()).max(0.0),
    ];
    let taught = std::array::from_fn::<f64, 4, _>(|k| TAUGHT[k] * causes[k]);
    // Interpolation is of second order in the interval between samples. At the fewest samples in a period a feature is anywhere
    // between two samples of the source, and of the receiver.
    let sampled = (2.0 / 12f64).sqrt() * LEAST_PER_PERIOD * band.frequency.powi(2) * period;
    let after = compared.begins.map_or(0.0, |begins| (pick.time - begins).max(0.0));
    let others = [pick.time_stddev, HALF_PERIOD * compared.sign_doubt * of_wave, after, sampled];
    let variance: f64 = taught.iter().chain(&others).map(|e| e * e).sum();
    Pick { causes, ..*pick }.with_error(variance.sqrt(), passage)
}
