//! The distinct waves of a receiver, in the order of their arrival.
//!
//! A wave stands out of what precedes it: of the noise while source and receiver are quiet, of what arrived since the source ended, and of
//! what is left of crosstalk. It does not matter how large the waves after it are: the envelope is of a window of two periods, so that it
//! contains nothing that arrives more than one period later.

use super::ambient::Ambient;
use crate::time_of_flight::spectrum::{Analytic, Spectrum};
use std::f64::consts::TAU;

/// Share of records of noise alone in which a wave may be there, and in which one is clear (`noise_of_any_colour_seems_a_wave_as_rarely_as_is_stated`).
pub(super) const FALSE_ALARMS: [f64; 2] = [1e-2, 1e-4];

/// Independent windows in a period of noise: the rate at which its envelope rises above 3 to 5 times its mean, over the share of the time
/// that it is above.
const WINDOWS_PER_PERIOD: f64 = 4.0;

/// Ratio of a crest to the trough between two waves, from which they are two.
const DIVIDES: f64 = 2.0;

/// Periods before a place that do not count as what precedes it.
const GUARD: f64 = 1.5;

/// Periods by which losses may delay the crest of a wave.
const LATER: f64 = 0.25;

/// A wave of the receiver. Times are in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wave {
    /// Where its envelope first stands out.
    pub(super) begins: usize,
    /// Largest envelope, and its place.
    pub(super) crest: usize,
    pub(super) height: f64,
    /// How long a wave of this height rises from the place where it begins, samples.
    pub(super) rise: f64,
    /// True if noise does not have such a crest.
    pub(super) is_clear: bool,
    /// Least envelope between this wave and the next, or the end of the record.
    pub(super) ends: usize,
}

/// Windows of two periods.
pub(super) struct Windows {
    window: Vec<Analytic>,
    period: f64,
}

impl Windows {
    /// For waves of the frequency `frequency`, samples⁻¹.
    pub(super) fn new(frequency: f64) -> Self {
        let half = (1.0 / frequency).round().max(2.0) as i64;
        let hann = |k: i64| (0.25 * TAU * k as f64 / (half + 1) as f64).cos().powi(2);
        let turn = |k: i64| Analytic::cis(TAU * frequency * k as f64);
        let sum: f64 = (-half..=half).map(hann).sum();
        // Without the mean, so that an offset has no envelope.
        let mean = (-half..=half).map(|k| turn(k) * hann(k)).sum::<Analytic>() / sum;
        let window = (-half..=half).map(|k| (turn(k) - mean) * hann(k)).collect();
        Self { window, period: 1.0 / frequency }
    }

    /// Square of the envelope around each sample.
    fn energies(&self, signal: &[f64]) -> Vec<f64> {
        let half = self.window.len() / 2;
        let around = |k: usize| {
            let from = k.saturating_sub(half);
            let to = (k + half + 1).min(signal.len());
            let window = &self.window[from + half - k..];
            signal[from..to].iter().zip(window).map(|(s, w)| w * s).sum::<Analytic>().norm_sqr()
        };
        (0..signal.len()).map(around).collect()
    }

    /// Returns the largest envelope of a step of height 1.
    fn of_step(&self) -> f64 {
        let grown = |sum: &mut Analytic, w: &Analytic| {
            *sum += w;
            Some(sum.norm())
        };
        self.window.iter().scan(Analytic::default(), grown).fold(0.0, f64::max)
    }

    /// Place and height of the largest envelope of a signal.
    pub(super) fn crest(&self, signal: &[f64]) -> (usize, f64) {
        highest(&self.energies(signal))
    }

    /// Returns how long a wave with the shape of `source` rises from a share of its largest envelope on, samples.
    pub(super) fn rise(&self, source: &[f64]) -> impl Fn(f64) -> f64 {
        let energies = self.energies(source);
        let (crest, height) = highest(&energies);
        let below = move |share: f64| (0..crest).rfind(|k| energies[*k].sqrt() < share * height);
        move |share| (crest - below(share).map_or(0, |k| k + 1)) as f64
    }

    /// The waves of `receiver` from the sample `start` on. What precedes them is the noise `ambient`, and what follows the sample `silent`.
    /// `masked` is the envelope below which a place may be crosstalk, and `rise` how long a wave rises from a share of its largest envelope on:
    /// what comes later is of another wave.
    pub(super) fn waves(
        &self,
        receiver: &[f64],
        ambient: &Ambient,
        (start, silent): (usize, usize),
        masked: impl Fn(usize) -> f64,
        rise: impl Fn(f64) -> f64,
    ) -> Vec<Wave> {
        let energies = self.energies(receiver);
        let spectrum = Spectrum::new(receiver.len(), 1);
        let part = |of: fn(&Analytic) -> f64| self.window.iter().map(of).collect::<Vec<f64>>();
        let noise: f64 =
            [part(|w| w.re), part(|w| w.im)].iter().map(|part| ambient.variance(&spectrum.of(part))).sum();
        // A step of the digitizer is no wave.
        let edge = 12f64.sqrt() * ambient.rounding * self.of_step();
        let trials = WINDOWS_PER_PERIOD * receiver.len().saturating_sub(start) as f64 / self.period;
        let levels = |mean: f64, degrees: f64| {
            FALSE_ALARMS.map(|share| mean * exceeded((share / trials).min(1.0), degrees))
        };
        let guard = (GUARD * self.period) as usize;
        let mut waves: Vec<Wave> = Vec::new();
        let (mut sum, mut count) = (0.0, 0);
        let (mut crest, mut trough, mut least) = (None::<Wave>, start, 0.0);
        let mut is_any_clear = false;
        for (k, energy) in energies.iter().copied().enumerate().skip(start) {
            if let Some(before) =
                k.checked_sub(guard).filter(|before| *before >= silent && !is_any_clear && crest.is_none())
            {
                sum += energies[before];
                count += 1;
            }
            let (arrived, windows) =
                if count > guard { (sum / count as f64, count as f64 / self.period) } else { (0.0, 0.0) };
            let [may, clear] = levels(noise.max(arrived), ambient.degrees + windows);
            match &mut crest {
                Some(wave) => {
                    let expected = rise((energies[wave.begins] / energy.max(wave.height)).sqrt().min(1.0));
                    let is_late = (k - wave.begins) as f64 > expected + LATER * self.period;
                    let is_other = is_late && energy > DIVIDES.powi(2) * wave.height;
                    if energy > wave.height && !is_late {
                        (wave.crest, wave.height, wave.rise) = (k, energy, expected);
                        wave.is_clear |= energy > least;
                    } else if is_other || energy < wave.height / DIVIDES.powi(2) {
                        is_any_clear |= wave.is_clear;
                        waves.push(*wave);
                        (crest, trough) = (None, if is_other { wave.crest } else { k });
                    }
                }
                None => {
                    if energy < energies[trough] {
                        trough = k;
                    }
                    let floor = masked(k).max(edge).powi(2);
                    let level = may.max(floor);
                    let rises = waves.is_empty() || energy > DIVIDES.powi(2) * energies[trough];
                    if energy > level && rises {
                        if let Some(last) = waves.last_mut() {
                            last.ends = trough;
                        }
                        least = clear.max(floor * clear / may);
                        let is_clear = energy > least;
                        crest = Some(Wave {
                            begins: k,
                            crest: k,
                            height: energy,
                            rise: rise(1.0),
                            is_clear,
                            ends: receiver.len(),
                        });
                    }
                }
            }
        }
        waves.extend(crest);
        waves.iter_mut().for_each(|wave| wave.height = wave.height.sqrt());
        waves
    }
}

/// Place and height of the largest of these squares of envelopes.
fn highest(energies: &[f64]) -> (usize, f64) {
    let crest = (0..energies.len()).max_by(|a, b| energies[*a].total_cmp(&energies[*b])).unwrap_or(0);
    (crest, energies[crest].sqrt())
}

/// Returns the square of an envelope, over its mean in `degrees` independent windows of noise, that noise exceeds with the probability `share`.
///
/// Both are sums of squares of normal numbers, so that their ratio has an F distribution. With many windows it is −ln `share`.
fn exceeded(share: f64, degrees: f64) -> f64 {
    degrees * (share.powf(-1.0 / degrees) - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;
    use crate::record::ambient::rounding;
    use rayon::prelude::*;

    const PERIOD: f64 = 40.0;

    const RECORDS: u64 = 4000;

    fn sine(sample: usize, start: usize) -> f64 {
        let phase = (sample as f64 - start as f64) / PERIOD;
        if (0.0..1.0).contains(&phase) { (TAU * phase).sin() } else { 0.0 }
    }

    fn waves(signal: &[f64]) -> Vec<Wave> {
        let step = rounding(signal, &(0..80));
        let ambient =
            Ambient::new(&signal[..80], step, 1.0 / PERIOD, Spectrum::new(signal.len(), 1).padded());
        Windows::new(1.0 / PERIOD).waves(signal, &ambient, (160, 220), |_| 0.0, |_| f64::INFINITY)
    }

    #[test]
    fn a_wave_stands_out_of_the_noise_whatever_follows() {
        for height in [1.0, 10.0, 100.0, 1e3, 1e4] {
            let mut random = Noise::at(1, &[height as u64]);
            let sample = |k| sine(k, 400) - height * sine(k, 520) + 0.1 * random.next();
            let signal: Vec<f64> = (0..900).map(sample).collect();
            let found = waves(&signal);
            assert!(found.len() >= 2 && found[0].is_clear, "{height}: {found:?}");
            assert!(found[0].crest.abs_diff(420) < 8 && found[0].ends < 520, "{height}: {:?}", found[0]);
        }
    }

    /// Returns the least number that at most one in a thousand counts of `of` records exceeds, if each counts with this probability.
    fn most(share: f64, of: i32) -> usize {
        let (mut one, mut sum, mut k) = ((1.0 - share).powi(of), 0.0, 0);
        while sum + one < 0.999 {
            sum += one;
            one *= f64::from(of - k) / f64::from(k + 1) * share / (1.0 - share);
            k += 1;
        }
        k as usize
    }

    #[test]
    fn noise_of_any_colour_seems_a_wave_as_rarely_as_is_stated() {
        assert_eq!([most(0.01, 200), most(FALSE_ALARMS[1], 200)], [8, 1]);
        let of = |seed: u64, keeps: f64| {
            let mut random = Noise::at(seed, &[2]);
            let mut last = 0.0;
            let noise: Vec<f64> = std::iter::repeat_with(|| {
                last = keeps * last + random.next();
                last
            })
            .skip(100)
            .take(900)
            .collect();
            let found = waves(&noise);
            [!found.is_empty(), found.iter().any(|wave| wave.is_clear)]
        };
        for keeps in [0.0, 0.7, 0.95] {
            let all: Vec<[bool; 2]> = (0..RECORDS).into_par_iter().map(|seed| of(seed, keeps)).collect();
            let wrong: [usize; 2] = std::array::from_fn(|k| all.iter().filter(|found| found[k]).count());
            let bounds = FALSE_ALARMS.map(|share| most(share, RECORDS as i32));
            assert!(wrong[0] <= bounds[0] && wrong[1] <= bounds[1], "{wrong:?} of {RECORDS} at {keeps}");
        }
    }

    #[test]
    fn a_digitizer_that_rounds_the_noise_to_nothing_has_the_noise_of_its_steps() {
        let sample = |k: usize| ((0.6 * (0.001 * k as f64).sin() + 20.0 * sine(k, 600)) * 2.0).round() / 2.0;
        let signal: Vec<f64> = (0..900).map(sample).collect();
        assert!(signal[..80].iter().all(|s| *s == 0.0));
        let found = waves(&signal);
        assert!(found.first().is_some_and(|wave| wave.crest.abs_diff(620) < 8), "{found:?}");
    }
}
