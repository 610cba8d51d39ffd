//! The arrival in a record, without crosstalk, earlier and later waves.

use super::ambient::Ambient;
use super::band::{Band, centre};
use super::chosen::{Chosen, STRONG, chosen};
use super::distinct::Windows;
use super::passage::Passage;
use crate::noise::Noise;
use crate::time_of_flight::pick::onset;
use crate::time_of_flight::spectrum::Spectrum;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;
use std::sync::Arc;

/// Least correlation of an arrival with its source over that of noise, whose largest of a hundred is about 3.
pub(super) const STANDS_OUT: f64 = 5.5;

/// Crosstalk below this fraction of the arrival is left in the record.
const AUDIBLE: f64 = 0.02;

/// Least part of the energy of a wave that is not also of the crosstalk.
const APART: f64 = 0.3;

/// Rate at which what is left of crosstalk decays after the source, over its duration, or over a period if that is shorter.
const FADES: f64 = 2.0;

/// Wavelengths of the shortest path: crosstalk that electronics delay cannot be told from a wave of a shorter one.
const SHORTEST: f64 = 0.75;

/// Durations of the source before and after the crest of a wave in which the correlation is largest, and periods more.
const NEAR: [f64; 2] = [0.25, 0.5];

/// Periods in which a record fades out where a larger wave follows.
const CUT: f64 = 0.5;

/// Periods before and after the place where a compression wave stands out, in which its onset is looked for.
const AROUND: [f64; 2] = [2.5, 2.2];

/// Periods before and after the crest of another wave in which its onset is looked for.
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
    pub(super) ambient: Arc<Ambient>,
    /// Root mean square of white noise with the same power in the band of the source.
    pub(super) noise: f64,
    /// Correlation with the source, without crosstalk, over that of noise.
    pub(super) stands_out: f64,
    /// True if the wave is one that noise is not.
    pub(super) is_clear: bool,
    /// Delay of a compression wave by the place where it first stands out of the noise, samples.
    pub(super) begins: Option<f64>,
    pub(super) is_cut: bool,
    /// Correlation of the opposite sign over that of the arrival, where the sign is not known.
    pub(super) opposite: f64,
    /// Time of the other candidate less that of the arrival, where the largest wave follows the first strong one.
    pub(super) other: Option<f64>,
    /// Time of the onset after that of the source.
    pub(super) onset: f64,
    /// Signal in the two periods before the onset, over that after it.
    pub(super) early: f64,
    /// Sample from which the record fades out, because a larger wave follows.
    pub(super) cut: Option<usize>,
}

impl Separated {
    /// A computed record with this arrival, and the sign, crosstalk and noise of this one.
    pub(super) fn with(&self, arrival: &[f64], passage: &Passage, band: &Band, random: &mut Noise) -> Self {
        let scale = fitted(&self.receiver, arrival).1;
        let (sign, talk) = (if self.reversed { -scale } else { scale }, self.crosstalk * scale);
        let noise = self.ambient.drawn(arrival.len(), random);
        let receiver = arrival.iter().zip(&self.source).zip(noise).map(|((a, s), n)| sign * a + talk * s + n);
        let receiver = faded(receiver.collect(), self.cut, CUT / band.frequency);
        separated(self.source.clone(), receiver, &self.ambient, passage, band, self.is_cut)
    }
}

pub(super) fn largest(signal: &[f64]) -> f64 {
    signal.iter().fold(0.0, |most: f64, s| most.max(s.abs()))
}

/// Returns a signal that fades out from the sample `cut` on, within `over` samples.
fn faded(mut signal: Vec<f64>, cut: Option<usize>, over: f64) -> Vec<f64> {
    let fade = |k: usize| (FRAC_PI_2 * (k as f64 / over).min(1.0)).cos().powi(2);
    signal.iter_mut().skip(cut.unwrap_or(usize::MAX)).enumerate().for_each(|(k, s)| *s *= fade(k));
    signal
}

/// The arrival of a source whose crosstalk has no delay, by the delay and sign that both together explain the record best with.
pub(super) fn separated(
    source: Vec<f64>,
    receiver: Vec<f64>,
    ambient: &Arc<Ambient>,
    passage: &Passage,
    band: &Band,
    is_cut: bool,
) -> Separated {
    let spectrum = Spectrum::new(source.len(), 1);
    let sent = spectrum.of(&source);
    let auto = spectrum.correlation(&sent, &sent);
    let zero = auto.len() / 2;
    let energy = auto[zero].re;
    let mixed = source.iter().zip(&receiver).map(|(s, r)| s * r).sum::<f64>()
        / source.iter().map(|s| s * s).sum::<f64>();
    let period = 1.0 / band.frequency;
    let is_p = passage.longitudinal == Some(true);
    let windows = Windows::new(band.frequency);
    let (crest_of_source, of_source) = windows.crest(&source);
    let clear: Vec<f64> = receiver.iter().zip(&source).map(|(r, s)| r - mixed * s).collect();
    let chosen = passage.longitudinal.and_then(|is_p| {
        let ends = band.from as f64 + band.duration;
        let masked = |k: usize| {
            let later = (k as f64 - crest_of_source as f64 - CLIMB * band.duration).max(0.0);
            (mixed * of_source).abs() * (-FADES * later / band.duration.min(period)).exp()
        };
        let start = crest_of_source as f64 + SHORTEST * period + band.system.max(0.0);
        let rise_of_source = windows.rise(&source);
        let rise = |share: f64| if is_p { rise_of_source(share) } else { f64::INFINITY };
        let range = (start as usize, (ends + 2.0 * period) as usize);
        let waves = windows.waves(&clear, ambient, range, masked, rise);
        chosen(&waves, is_p, |wave| (wave.crest as f64 - crest_of_source as f64 - band.system) / period)
    });
    // What comes after a compression wave as long as the source is of other waves.
    let delay = |chosen: Chosen| chosen.wave.begins as f64 + chosen.wave.rise - crest_of_source as f64;
    let begins = chosen.filter(|_| is_p).map(delay);
    let cut = match begins {
        Some(delay) => Some((delay + band.from as f64 + band.duration).max(0.0) as usize),
        None => chosen.filter(|chosen| chosen.is_followed).map(|chosen| chosen.wave.ends),
    };
    let whole = receiver.clone();
    let receiver = faded(receiver, cut, CUT * period);
    let cross = spectrum.correlation(&spectrum.of(&receiver), &sent);
    // The part of a wave that is not also crosstalk.
    let explained = |k: usize| {
        let apart = 1.0 - (auto[k].norm() / energy).powi(2);
        let left = cross[k] - auto[k] * mixed;
        (left / apart, if apart > APART { left.norm_sqr() / apart } else { 0.0 })
    };
    let variance = ambient.variance(&sent);
    // The whole wave is in the record.
    let end = source.len() as f64 - band.from as f64 - band.duration;
    let last = (zero + end.max(2.0) as usize).min(cross.len() - 1);
    let shortest = band.system.max(0.0) + SHORTEST / band.frequency;
    let start = (zero + shortest as usize).clamp(zero + 1, last - 1);
    let top = |range: Range<usize>| {
        range.max_by(|a, b| explained(*a).1.total_cmp(&explained(*b).1)).unwrap_or(start)
    };
    let strongest = || {
        let loudest = top(start..last);
        let talk = |k: usize| {
            let later = ((k - zero) as f64 / band.duration - CLIMB).max(0.0);
            (mixed * energy * (-FADES * later).exp()).powi(2)
        };
        let level = (STRONG.powi(2) * explained(loudest).1).max(STANDS_OUT.powi(2) * variance);
        let first = (start..last).find(|k| explained(*k).1 > level.max(talk(*k)))?;
        let first = top(first..(first + (CLIMB * band.duration) as usize).min(last));
        // A source of shear waves also sends weaker compression waves, so that the larger of two waves is taken as S.
        let strong = if passage.longitudinal == Some(false) { first.max(loudest) } else { first };
        let is_behind = !is_p && first < loudest;
        Some((strong, is_behind.then(|| (first + loudest) as f64 - 2.0 * strong as f64)))
    };
    let correlated = match &chosen {
        Some(chosen) => {
            let reach = NEAR[0] * band.duration + NEAR[1] * period;
            let delay = begins.unwrap_or(chosen.wave.crest as f64 - crest_of_source as f64);
            let middle = zero as f64 + delay;
            let [from, to] = [middle - reach, middle + reach].map(|k| (k as usize).clamp(start, last));
            Some((top(from..to), chosen.other))
        }
        None => strongest(),
    };
    let (strong, other) = correlated.unwrap_or((start, None));
    // The crest of either sign next to the peak of the envelope.
    let real = |k: usize| explained(k).0.re;
    let reach = 0.6 / centre(&spectrum, &source);
    let near = |k: &usize| (*k as f64 - strong as f64).abs() <= reach && explained(*k).1 > 0.0;
    let crest = |sign: f64| {
        (start..last)
            .filter(near)
            .max_by(|a, b| (sign * real(*a)).total_cmp(&(sign * real(*b))))
            .unwrap_or(strong)
    };
    let is_reversed = passage.reversed.unwrap_or_else(|| -real(crest(-1.0)) > real(crest(1.0)));
    let sign = if is_reversed { -1.0 } else { 1.0 };
    let at = crest(sign);
    let height = real(at) / energy;
    let opposite = if passage.reversed.is_none() { -real(crest(-sign)) / real(at) } else { 0.0 };
    let crosstalk = mixed - height * auto[at].re / energy;
    let over = crosstalk / height.abs();
    let taken = if over.abs() > AUDIBLE { crosstalk } else { 0.0 };
    let noise = (variance / energy).sqrt();
    let middle = (band.from + at - zero) as f64 + 0.5 * band.duration;
    let kept = |k: usize| {
        let [flat, far] = FADED.map(|part| (0.5 + part) * band.duration);
        let off = ((k as f64 - middle).abs() - flat) / (far - flat);
        (FRAC_PI_2 * off.clamp(0.0, 1.0)).cos().powi(2)
    };
    let without_crosstalk =
        |of: &[f64]| of.iter().zip(&source).map(|(r, s)| sign * (r - taken * s)).collect::<Vec<f64>>();
    let clear = without_crosstalk(&whole);
    let mut receiver = without_crosstalk(&receiver);
    // A compression wave is the first that arrives; what precedes a shear wave by more is not its own.
    let crest_of_strong = (band.from + strong - zero) as f64 + 0.5 * band.duration;
    let stop = crest_of_strong + AFTER * period;
    let [before, stop] = match &chosen {
        Some(chosen) if is_p => {
            let begins = chosen.wave.begins as f64;
            [begins - AROUND[0] * period, stop.clamp(begins + period, begins + AROUND[1] * period)]
        }
        _ if is_p => [(band.from + start - zero) as f64, stop],
        _ => [crest_of_strong - BEFORE * period, stop],
    };
    let stop = stop.min(cut.unwrap_or(usize::MAX) as f64);
    let onset = onset(&receiver, before.max(0.0) as usize, stop.max(0.0) as usize, 0.0);
    let onset = onset.unwrap_or(f64::NAN) - band.from as f64;
    let crest_of = |from: f64, to: f64| {
        largest(receiver.get(from.max(0.0) as usize..to.max(0.0) as usize).unwrap_or_default())
    };
    let began = onset + band.from as f64;
    let early =
        crest_of(began - BEFORE * period, began - EARLY * period) / crest_of(began, began + band.duration);
    receiver.iter_mut().enumerate().for_each(|(k, r)| *r *= kept(k));
    let stands_out = correlated.map_or(0.0, |_| (explained(strong).1 / variance).sqrt());
    let delay = at as f64 - zero as f64;
    Separated {
        source,
        receiver,
        clear,
        crosstalk: over,
        delay,
        reversed: is_reversed,
        ambient: Arc::clone(ambient),
        noise,
        stands_out,
        is_clear: stands_out >= STANDS_OUT || begins.is_some(),
        begins,
        is_cut,
        opposite: opposite.max(0.0),
        other,
        onset,
        early: if early.is_finite() { early } else { 0.0 },
        cut,
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
