//! Noise of a receiver, from the samples in which neither source nor receiver has a signal.
//!
//! Few samples are known, and the noise need not be white: amplifiers colour noise, and mains and radio add tones. An autoregressive process has the
//! spectrum of these samples, so that it tells how much noise passes a filter, and draws other noise of the same kind.

use crate::noise::Noise;
use crate::time_of_flight::spectrum::Analytic;
use std::f64::consts::TAU;
use std::ops::Range;

/// Samples for each factor of the process, at least, and the largest number of factors.
const SAMPLES_PER_FACTOR: usize = 6;
const MAX_FACTORS: usize = 16;

/// An autoregressive process with the spectrum of the noise of a receiver.
#[derive(Clone, Debug)]
pub(super) struct Ambient {
    /// Factors of the numbers before, the last first.
    factors: Vec<f64>,
    /// Standard deviation of the part of a number that the numbers before do not give.
    innovation: f64,
    /// Standard deviation of rounding by the digitizer, which the samples do not show.
    pub(super) rounding: f64,
    pub(super) rms: f64,
    /// Number of independent complex numbers whose mean square is as certain as the power at one frequency.
    pub(super) degrees: f64,
    /// Power at each frequency of a transform; white noise of unit variance has 1.
    pub(super) powers: Vec<f64>,
}

impl Ambient {
    /// Finds the process of the samples `quiet` by Burg's method, with as many factors as Akaike's corrected criterion allows.
    ///
    /// `rounding` is what a digitizer adds (see [`rounding`]), `frequency` the frequency of the source (samples⁻¹), and `length` the number
    /// of frequencies.
    pub(super) fn new(quiet: &[f64], rounding: f64, frequency: f64, length: usize) -> Self {
        let n = quiet.len() as f64;
        let mut variance = quiet.iter().map(|s| s * s).sum::<f64>() / n;
        let rms = variance.sqrt().hypot(rounding);
        let criterion = |variance: f64, factors: usize| {
            let known = factors as f64 + 1.0;
            n * variance.ln() + 2.0 * known * n / (n - known - 1.0)
        };
        let (mut best, mut least) = ((Vec::new(), variance), criterion(variance, 0));
        let (mut ahead, mut back, mut factors) = (quiet.to_vec(), quiet.to_vec(), Vec::new());
        for count in 1..=(quiet.len() / SAMPLES_PER_FACTOR).min(MAX_FACTORS) {
            let pairs = || ahead.iter().skip(count).zip(back.iter().skip(count - 1));
            let both: f64 = pairs().map(|(a, b)| a * b).sum();
            let all: f64 = pairs().map(|(a, b)| a * a + b * b).sum();
            if all <= 0.0 {
                break;
            }
            let reflected = 2.0 * both / all;
            let turned: Vec<f64> = factors.iter().rev().map(|f| reflected * f).collect();
            factors.iter_mut().zip(turned).for_each(|(f, t): (&mut f64, f64)| *f -= t);
            factors.push(reflected);
            for k in (count..quiet.len()).rev() {
                let (a, b) = (ahead[k], back[k - 1]);
                (ahead[k], back[k]) = (a - reflected * b, b - reflected * a);
            }
            variance *= 1.0 - reflected * reflected;
            if criterion(variance, count) < least {
                least = criterion(variance, count);
                best = (factors.clone(), variance);
            }
        }
        let (factors, variance) = best;
        let power = |k: usize| {
            let turn = |j: usize| Analytic::cis(-TAU * (j + 1) as f64 * k as f64 / length as f64);
            let left: Analytic = 1.0 - factors.iter().enumerate().map(|(j, f)| turn(j) * f).sum::<Analytic>();
            variance / left.norm_sqr() + rounding * rounding
        };
        let powers: Vec<f64> = (0..length).map(power).collect();
        let mean = |of: &dyn Fn(f64) -> f64| powers.iter().map(|p| of(*p)).sum::<f64>() / length as f64;
        // Bartlett's number of independent samples, of coloured noise: the sum of its squared autocorrelation is the ratio of these means.
        let independent = n * mean(&|p| p).powi(2) / mean(&|p| p * p);
        let degrees = (0.5 * independent / (factors.len() + 1) as f64).max(n * frequency);
        Self { innovation: variance.sqrt(), rounding, rms, degrees, powers, factors }
    }

    pub(super) fn variance(&self, response: &[Analytic]) -> f64 {
        let passed = response.iter().zip(&self.powers).map(|(line, power)| line.norm_sqr() * power);
        passed.sum::<f64>() / response.len() as f64
    }

    pub(super) fn drawn(&self, samples: usize, random: &mut Noise) -> Vec<f64> {
        // As many before them, so that the process is what it is after a long time.
        let before = if self.factors.is_empty() { 0 } else { samples };
        let mut drawn: Vec<f64> = Vec::with_capacity(before + samples);
        for _ in 0..before + samples {
            let given: f64 = self.factors.iter().zip(drawn.iter().rev()).map(|(f, s)| f * s).sum();
            drawn.push(given + self.innovation * random.next());
        }
        drawn.iter().skip(before).map(|s| s + self.rounding * random.next()).collect()
    }
}

/// Returns the standard deviation of the errors of rounding that the quiet samples of a receiver do not show.
///
/// A digitizer rounds to its steps, by errors of step/√12. Noise that is larger than a step makes these errors random, and contains them: what is
/// left falls by its characteristic function (Widrow and Kollár, Quantization Noise).
pub(super) fn rounding(receiver: &[f64], quiet: &Range<usize>) -> f64 {
    let mut sorted = receiver.to_vec();
    sorted.sort_by(f64::total_cmp);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0);
    let step = steps.fold(f64::INFINITY, f64::min);
    let quiet = receiver.get(quiet.clone()).unwrap_or_default();
    let n = quiet.len() as f64;
    let mean = quiet.iter().sum::<f64>() / n;
    let noise = (quiet.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / n).sqrt();
    if step.is_finite() { step / 12f64.sqrt() * (-0.5 * (TAU * noise / step).powi(2)).exp() } else { 0.0 }
}
