//! Checks of a record, and its source and receiver without offset, of unit height.

use super::ambient::Ambient;
use super::band::Band;
use super::filter::filtered;
use super::passage::{Passage, Record};
use super::separated::{STANDS_OUT, Separated, largest, separated};
use crate::error::{AcousticsError, setting};
use crate::time_of_flight::spectrum::Spectrum;
use std::ops::Range;
use std::sync::Arc;

/// Least number of samples per period, of a record, and before the source starts.
pub(super) const LEAST_PER_PERIOD: f64 = 4.0;
const LEAST_SAMPLES: usize = 32;
const LEAST_QUIET: usize = 8;

/// Number of samples per period that show the shape of a signal.
const ENOUGH_PER_PERIOD: f64 = 40.0;

/// First sample of a source over its largest, and its sum over that of the magnitudes, above which the record is refused.
const STARTED: f64 = 0.2;
const ONE_SIDED: f64 = 0.5;

/// Least correlation of a source with what was recorded as its receiver, of another channel that follows it.
const EXCHANGED: f64 = 0.5;

/// Least number of equal samples in a row, at an end of the range, of a signal that is cut there.
const CUT: usize = 3;

/// Checks and cleans a record, whose receiver has errors of rounding of this standard deviation (see [`super::ambient::rounding`]).
pub(super) fn cleaned(
    record: &Record,
    rounding: f64,
    passage: &Passage,
) -> Result<(Separated, Band), AcousticsError> {
    for (name, value) in [
        ("sample_rate", Some(record.sample_rate)),
        ("distance", Some(passage.distance)),
        ("diameter", Some(passage.diameter)),
        ("lowpass", passage.lowpass),
        ("highpass", passage.highpass),
    ] {
        let is_positive = value.is_none_or(|v| v.is_finite() && v > 0.0);
        setting(name, value.unwrap_or(0.0), is_positive, "more than 0 and finite")?;
    }
    for (name, value) in [("distance_sigma", passage.distance_stddev), ("delay_sigma", passage.delay_stddev)]
    {
        setting(name, value, value.is_finite() && value >= 0.0, "0 or more and finite")?;
    }
    setting("delay", passage.delay, passage.delay.is_finite(), "finite")?;
    let passes = passage.lowpass.zip(passage.highpass).is_none_or(|(low, high)| high <= low);
    setting("highpass", passage.highpass.unwrap_or(0.0), passes, "at most lowpass")?;
    let order = passage.filter_order;
    setting("filter_order", f64::from(order), (1..=8).contains(&order), "from 1 to 8")?;
    let samples = record.source.len();
    setting("samples", samples as f64, samples >= LEAST_SAMPLES, "32 or more")?;
    let same = record.receiver.len() == samples;
    setting("samples of the receiver", record.receiver.len() as f64, same, "as many as of the source")?;
    let duration = samples as f64 / record.sample_rate;
    if passage.delay.abs() >= duration {
        return Err(AcousticsError::NoArrival(format!(
            "the delay, {} s, is longer than the record, {duration:.3e} s; s is expected",
            passage.delay
        )));
    }
    for value in record.source.iter().chain(&record.receiver) {
        setting("samples", *value, value.is_finite(), "finite")?;
    }
    let quiet = record.quiet.clone();
    let refused = |reason: &str| Err(AcousticsError::NoArrival(reason.to_owned()));
    if record.source == record.receiver {
        return refused("source and receiver are the same signal: give the channels of both");
    }
    if is_exchanged(&centred(&record.source, &quiet)?, &centred(&record.receiver, &quiet)?) {
        return refused("the receiver has the wave before the source has it: exchange the channels of both");
    }
    let source = filtered(&centred(&record.source, &quiet)?, record.sample_rate, passage);
    let height = largest(&source);
    let source: Vec<f64> = source.iter().map(|s| s / height).collect();
    if source[0].abs() > STARTED {
        return refused("the record begins after its source: record the source from its start");
    }
    if source.iter().sum::<f64>().abs() > ONE_SIDED * source.iter().map(|s| s.abs()).sum::<f64>() {
        return refused(
            "the source has one sign, so that its wave cannot be told from crosstalk: send a sine or a burst",
        );
    }
    let band = Band::of(&source, passage.delay * record.sample_rate);
    let per_period = 1.0 / band.frequency;
    if per_period < LEAST_PER_PERIOD {
        return Err(AcousticsError::NoArrival(format!(
            "a period of the source has {per_period:.3} samples, and {LEAST_PER_PERIOD} or more are needed: sample faster"
        )));
    }
    let receiver = centred(&record.receiver, &quiet)?;
    let height = largest(&receiver);
    let receiver: Vec<f64> = receiver.iter().map(|s| s / height).collect();
    let is_cut = is_cut(&receiver);
    let frequencies = Spectrum::new(samples, 1).padded();
    let ambient = Arc::new(Ambient::new(&receiver[quiet], rounding / height, band.frequency, frequencies));
    let found = separated(source, receiver, &ambient, passage, &band, is_cut);
    if !found.is_clear {
        return Err(AcousticsError::NoArrival(format!(
            "the correlation with the source is {:.1} times that of noise, and {STANDS_OUT} are needed",
            found.stands_out
        )));
    }
    Ok((found, band))
}

/// A record of fewer samples, each the mean of some, where it has many more in a period of its source than its shape needs.
pub(super) fn thinned(record: &Record) -> Result<Record, AcousticsError> {
    let period = 1.0 / Band::of(&centred(&record.source, &record.quiet)?, 0.0).frequency;
    let each = ((period / ENOUGH_PER_PERIOD) as usize).min(record.quiet.len() / (2 * LEAST_QUIET));
    if each < 2 {
        return Ok(record.clone());
    }
    let mean = |of: &[f64]| of.chunks_exact(each).map(|c| c.iter().sum::<f64>() / each as f64).collect();
    let quiet = record.quiet.start.div_ceil(each)..record.quiet.end / each;
    let sample_rate = record.sample_rate / each as f64;
    Ok(Record { sample_rate, quiet, source: mean(&record.source), receiver: mean(&record.receiver) })
}

/// A signal less its mean where it is quiet.
fn centred(signal: &[f64], quiet: &Range<usize>) -> Result<Vec<f64>, AcousticsError> {
    let part = signal.get(quiet.clone()).filter(|part| part.len() >= LEAST_QUIET);
    let requirement = "8 or more: offset and noise are theirs";
    setting("samples without a signal", quiet.len() as f64, part.is_some(), requirement)?;
    let offset = part.unwrap_or_default().iter().sum::<f64>() / quiet.len() as f64;
    let centred: Vec<f64> = signal.iter().map(|s| s - offset).collect();
    if largest(&centred) > 0.0 {
        Ok(centred)
    } else {
        Err(AcousticsError::NoArrival("a signal is constant".to_owned()))
    }
}

/// Returns true if the receiver is most like the source of a later time, by more than a period.
fn is_exchanged(source: &[f64], receiver: &[f64]) -> bool {
    let spectrum = Spectrum::new(source.len(), 1);
    let correlation = spectrum.correlation(&spectrum.of(receiver), &spectrum.of(source));
    let height = |k: &usize| correlation[*k].norm();
    let top = (0..correlation.len()).max_by(|a, b| height(a).total_cmp(&height(b))).unwrap_or(0);
    let energies = [source, receiver].map(|signal| signal.iter().map(|s| s * s).sum::<f64>());
    let period = 1.0 / Band::of(source, 0.0).frequency;
    let lead = (correlation.len() / 2) as f64 - top as f64;
    lead > period && height(&top) > EXCHANGED * (energies[0] * energies[1]).sqrt()
}

fn is_cut(signal: &[f64]) -> bool {
    let (low, high) = signal.iter().fold((0.0, 0.0), |(l, h): (f64, f64), s| (l.min(*s), h.max(*s)));
    let at = |end: f64| signal.windows(CUT).any(|w| w.iter().all(|s| *s == end) && end != 0.0);
    at(low) || at(high)
}
