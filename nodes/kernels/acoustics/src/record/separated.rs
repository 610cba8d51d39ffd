//! The arrival in a record, without crosstalk, earlier and later waves.

use super::band::{Band, centre};
use super::passage::Passage;
use crate::time_of_flight::pick::onset;
use crate::time_of_flight::spectrum::Spectrum;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

/// Least correlation of an arrival with its source over that of noise, whose largest of a hundred is about 3.
pub(super) const STANDS_OUT: f64 = 5.5;

/// Crosstalk below this fraction of the arrival is left in the record.
const AUDIBLE: f64 = 0.02;

/// Least part of the energy of a wave that is not also of the crosstalk.
const APART: f64 = 0.3;

/// Correlation of the first wave over that of the largest: a compression wave has none before it, a shear wave has weaker ones.
const FIRST: [f64; 2] = [0.03, 0.4];

/// Rate at which what is left of crosstalk decays after the source, over its duration.
const FADES: f64 = 2.0;

/// Wavelengths of the shortest path: crosstalk that electronics delay cannot be told from a wave of a shorter one.
const SHORTEST: f64 = 0.75;

/// Periods before and after the crest of a wave in which its onset is looked for; before a compression wave, everywhere.
const BEFORE: f64 = 2.0;
const AFTER: f64 = 0.6;
const EARLY: f64 = 0.25;

/// Durations of the source in which the correlation of the first wave rises to its largest.
const CLIMB: f64 = 1.25;

/// Durations of the source before and after a wave at which the record fades out, first and last: echoes and later waves follow.
const FADED: [f64; 2] = [0.25, 0.75];

/// A source and a receiver with one arrival. Times are in samples.
#[derive(Clone, Debug)]
pub(super) struct Separated {
    pub(super) source: Vec<f64>,
    pub(super) receiver: Vec<f64>,
    /// The receiver with what precedes and follows the arrival.
    pub(super) clear: Vec<f64>,
    /// Crosstalk over the arrival.
    pub(super) crosstalk: f64,
    /// Delay and sign of the arrival, by correlation alone.
    pub(super) delay: f64,
    pub(super) reversed: bool,
    /// Root mean square of the noise of the receiver.
    pub(super) noise: f64,
    /// Correlation with the source, without crosstalk, over that of noise.
    pub(super) stands_out: f64,
    pub(super) is_cut: bool,
    /// Correlation of the opposite sign over that of the arrival, where the sign is not known.
    pub(super) opposite: f64,
    /// Time of the other candidate less that of the arrival, where the largest wave follows the first strong one.
    pub(super) other: Option<f64>,
    /// Time of the onset after that of the source.
    pub(super) onset: f64,
    /// Signal in the two periods before the onset, over that after it.
    pub(super) early: f64,
}

impl Separated {
    /// A computed record with this arrival, and the sign, crosstalk and noise of this one.
    pub(super) fn with(
        &self,
        arrival: &[f64],
        quiet: &Range<usize>,
        passage: &Passage,
        band: &Band,
        mut random: impl FnMut() -> f64,
    ) -> Self {
        let scale = fitted(&self.receiver, arrival).1;
        let (sign, talk) = (if self.reversed { -scale } else { scale }, self.crosstalk * scale);
        let receiver =
            arrival.iter().zip(&self.source).map(|(a, s)| sign * a + talk * s + self.noise * random());
        separated(self.source.clone(), receiver.collect(), quiet, passage, band, self.is_cut)
    }
}

pub(super) fn largest(signal: &[f64]) -> f64 {
    signal.iter().fold(0.0, |most: f64, s| most.max(s.abs()))
}

/// The arrival of a source whose crosstalk has no delay, by the delay and sign that both together explain the record best with.
pub(super) fn separated(
    source: Vec<f64>,
    receiver: Vec<f64>,
    quiet: &Range<usize>,
    passage: &Passage,
    band: &Band,
    is_cut: bool,
) -> Separated {
    let spectrum = Spectrum::new(source.len(), 1);
    let (sent, got) = (spectrum.of(&source), spectrum.of(&receiver));
    let (cross, auto) = (spectrum.correlation(&got, &sent), spectrum.correlation(&sent, &sent));
    let zero = cross.len() / 2;
    let energy = auto[zero].re;
    let mixed = cross[zero].re / energy;
    // The part of a wave that is not also crosstalk.
    let explained = |k: usize| {
        let apart = 1.0 - (auto[k].norm() / energy).powi(2);
        let left = cross[k] - auto[k] * mixed;
        (left / apart, if apart > APART { left.norm_sqr() / apart } else { 0.0 })
    };
    // Variance of the correlation of noise, by its spectrum before the source starts: it may be hum.
    let before = spectrum.of(&receiver[quiet.clone()]);
    let lines = before.iter().zip(&sent).map(|(noise, sent)| noise.norm_sqr() * sent.norm_sqr());
    let variance = lines.sum::<f64>() / (quiet.len() * sent.len()) as f64;
    // The whole wave is in the record.
    let end = source.len() as f64 - band.from as f64 - band.duration;
    let last = (zero + end.max(2.0) as usize).min(cross.len() - 1);
    let shortest = band.system.max(0.0) + SHORTEST / band.frequency;
    let start = (zero + shortest as usize).clamp(zero + 1, last - 1);
    let top = |range: Range<usize>| {
        range.max_by(|a, b| explained(*a).1.total_cmp(&explained(*b).1)).unwrap_or(start)
    };
    let is_p = passage.longitudinal == Some(true);
    let loudest = top(start..last);
    let most = explained(loudest).1;
    let talk = |k: usize| {
        let later = ((k - zero) as f64 / band.duration - CLIMB).max(0.0);
        (mixed * energy * (-FADES * later).exp()).powi(2)
    };
    let wave = |share: f64| {
        let level = (share.powi(2) * most).max(STANDS_OUT.powi(2) * variance);
        let first = (start..last).find(|k| explained(*k).1 > level.max(talk(*k)))?;
        Some(top(first..(first + (CLIMB * band.duration) as usize).min(last)))
    };
    let first = wave(FIRST[1]);
    // A source of shear waves also sends weaker compression waves, so that the larger of two waves is taken as S.
    let is_s = passage.longitudinal == Some(false);
    let strong = first.map(|first: usize| if is_s { first.max(loudest) } else { first });
    let weak = if is_p { wave(FIRST[0]) } else { strong };
    let (strong, coarse) = (strong.unwrap_or(start), weak.unwrap_or(start));
    // The crest of either sign next to the peak of the envelope.
    let real = |k: usize| explained(k).0.re;
    let reach = 0.6 / centre(&spectrum, &source);
    let near = |k: &usize| (*k as f64 - coarse as f64).abs() <= reach && explained(*k).1 > 0.0;
    let crest = |sign: f64| {
        (start..last)
            .filter(near)
            .max_by(|a, b| (sign * real(*a)).total_cmp(&(sign * real(*b))))
            .unwrap_or(coarse)
    };
    let is_reversed = passage.reversed.unwrap_or_else(|| -real(crest(-1.0)) > real(crest(1.0)));
    let sign = if is_reversed { -1.0 } else { 1.0 };
    let at = crest(sign);
    let height = real(at) / energy;
    let opposite = if passage.reversed.is_none() { -real(crest(-sign)) / real(at) } else { 0.0 };
    let crosstalk = mixed - height * auto[at].re / energy;
    let over = crosstalk / height.abs();
    let taken = if over.abs() > AUDIBLE { crosstalk } else { 0.0 };
    let noise = (receiver[quiet.clone()].iter().map(|r| r * r).sum::<f64>() / quiet.len() as f64).sqrt();
    let middle = (band.from + at - zero) as f64 + 0.5 * band.duration;
    let kept = |k: usize| {
        let [flat, far] = FADED.map(|part| (0.5 + part) * band.duration);
        let off = ((k as f64 - middle).abs() - flat) / (far - flat);
        (FRAC_PI_2 * off.clamp(0.0, 1.0)).cos().powi(2)
    };
    let mut receiver: Vec<f64> = receiver.iter().zip(&source).map(|(r, s)| sign * (r - taken * s)).collect();
    // A compression wave is the first that arrives; what precedes a shear wave by more is not its own.
    let period = 1.0 / band.frequency;
    let crest_of_strong = (band.from + strong - zero) as f64 + 0.5 * band.duration;
    let before = if is_p { (band.from + start - zero) as f64 } else { crest_of_strong - BEFORE * period };
    let onset = onset(&receiver, before.max(0.0) as usize, (crest_of_strong + AFTER * period) as usize, 0.0);
    let onset = onset.unwrap_or(f64::NAN) - band.from as f64;
    let crest_of = |from: f64, to: f64| {
        largest(receiver.get(from.max(0.0) as usize..to.max(0.0) as usize).unwrap_or_default())
    };
    let began = onset + band.from as f64;
    let early =
        crest_of(began - BEFORE * period, began - EARLY * period) / crest_of(began, began + band.duration);
    let clear = receiver.clone();
    receiver.iter_mut().enumerate().for_each(|(k, r)| *r *= kept(k));
    let behind = first.filter(|first| !is_p && *first < loudest);
    let other = behind.map(|first| (first + loudest) as f64 - 2.0 * strong as f64);
    let stands_out = weak.map_or(0.0, |k| (explained(k).1 / variance).sqrt());
    let delay = at as f64 - zero as f64;
    Separated {
        source,
        receiver,
        clear,
        crosstalk: over,
        delay,
        reversed: is_reversed,
        noise,
        stands_out,
        is_cut,
        opposite: opposite.max(0.0),
        other,
        onset,
        early: if early.is_finite() { early } else { 0.0 },
    }
}

/// Largest correlation of two signals, at most 1, and the factor of the other that is nearest to the one.
pub(super) fn fitted(one: &[f64], other: &[f64]) -> (f64, f64) {
    let spectrum = Spectrum::new(one.len(), 1);
    let correlation = spectrum.correlation(&spectrum.of(one), &spectrum.of(other));
    let square = |signal: &[f64]| signal.iter().map(|s| s * s).sum::<f64>();
    let both = correlation.iter().map(|c| c.re).fold(0.0, f64::max);
    (both / (square(one) * square(other)).sqrt(), both / square(other))
}
