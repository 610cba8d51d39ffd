//! Computed records of a transducer that sends P and S, in a medium of constant Q.
//!
//! A record has crosstalk, a near field, P, S, white noise and, in half of the records, a later wave that is larger than S. The medium
//! has Azimi's law (Aki and Richards, Quantitative Seismology, eq. 5.81), whose waves have causal onsets.

use grainlab_acoustics::record::{Passage, Record};
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use std::sync::Arc;

/// Number of samples of a record, and of its transforms.
const SAMPLES: usize = 900;
const PADDED: usize = 4096;

/// Number of samples before the source starts.
const QUIET: usize = 80;

/// Sampling rate, Hz.
const RATE: f64 = 400e3;

/// Place of the numbers that are not of the ratio and of the noise.
const PLACE: u64 = 1 << 32;

/// Distance, m.
const DISTANCE: f64 = 0.15;

/// A computed record, and what is true of it.
#[derive(Clone, Debug)]
pub(crate) struct Computed {
    /// The record.
    pub(crate) record: Record,
    /// The path, with the mode of the wave.
    pub(crate) passage: Passage,
    /// Speed of the wave of the mode at the mean frequency of the source, m/s.
    pub(crate) speed: f64,
}

/// Conditions of a computed record.
#[derive(Clone, Debug)]
pub(crate) struct Conditions {
    /// Peak of S over the peak of P.
    pub(crate) s_over_p: f64,
    /// Root mean square of the noise over the peak of the wave of the mode.
    pub(crate) noise: f64,
    /// Travel time of P, periods.
    pub(crate) periods: Range<f64>,
    /// Resonance frequency of the receiver over the frequency of the source, and quality factor; `None` if the receiver does not ring.
    pub(crate) resonance: Option<[f64; 2]>,
    /// Time from the arrival to the end of the record, in durations of the source; `None` if the record has the whole arrival.
    pub(crate) after: Option<f64>,
    /// Number of the noise: records that differ in nothing else are repetitions.
    pub(crate) repetition: u64,
}

/// A source and its spectrum.
struct Source {
    samples: Vec<f64>,
    spectrum: Vec<Complex<f64>>,
    /// Mean frequency of its energy, samples⁻¹.
    frequency: f64,
    inverse: Arc<dyn Fft<f64>>,
}

impl Source {
    /// A sine of `cycles` periods, under a Hann window if there is more than one, of the frequency `frequency` (samples⁻¹).
    fn new(frequency: f64, cycles: f64) -> Self {
        let sample = |k: usize| {
            let phase = (k as f64 - QUIET as f64) * frequency;
            let window = if cycles > 1.0 { (PI * phase / cycles).sin().powi(2) } else { 1.0 };
            if (0.0..cycles).contains(&phase) { window * (TAU * phase).sin() } else { 0.0 }
        };
        let samples: Vec<f64> = (0..SAMPLES).map(sample).collect();
        let mut planner = FftPlanner::new();
        let mut spectrum: Vec<Complex<f64>> = samples.iter().map(|s| Complex::new(*s, 0.0)).collect();
        spectrum.resize(PADDED, Complex::default());
        planner.plan_fft_forward(PADDED).process(&mut spectrum);
        let energy = |k: usize| spectrum[k].norm_sqr();
        let moment: f64 = (1..PADDED / 2).map(|k| k as f64 / PADDED as f64 * energy(k)).sum();
        let frequency = moment / (1..PADDED / 2).map(energy).sum::<f64>();
        Self { samples, spectrum, frequency, inverse: planner.plan_fft_inverse(PADDED) }
    }

    /// The wave, of peak 1, that arrives after `time` samples in a medium of the quality factor `q`, by a receiver that may ring.
    fn arrival(&self, time: f64, q: f64, resonance: Option<[f64; 2]>) -> Vec<f64> {
        let mut lines = self.spectrum.clone();
        for k in 1..PADDED / 2 {
            let f = k as f64 / PADDED as f64;
            let late = time * (1.0 - (f / self.frequency).ln() / (PI * q));
            lines[k] *= (-PI * f * time / q).exp() * Complex::cis(-TAU * f * late);
            if let Some([over, quality]) = resonance {
                let f = f / (over * self.frequency);
                lines[k] /= Complex::new(1.0 - f * f, f / quality);
            }
            lines[PADDED - k] = lines[k].conj();
        }
        lines[0] = Complex::default();
        lines[PADDED / 2] = Complex::default();
        self.inverse.process(&mut lines);
        let peak = lines[..SAMPLES].iter().map(|l| l.re.abs()).fold(0.0, f64::max);
        lines[..SAMPLES].iter().map(|l| l.re / peak).collect()
    }

    /// The near field between the arrivals of P and S, relative to a point source of one wave of peak 1 (Aki and Richards, eq. 4.23).
    fn near(&self, [p, s]: [f64; 2], of_p: bool) -> Vec<f64> {
        let scale = if of_p { 2.0 / p.powi(2) } else { -1.0 / s.powi(2) };
        let mut near = vec![0.0; SAMPLES];
        for tau in p.ceil() as usize..s as usize {
            near.iter_mut().skip(tau).zip(&self.samples).for_each(|(n, f)| *n += scale * tau as f64 * f);
        }
        near
    }
}

/// Returns the usual conditions of the record of number `seed`. S is 1 to 300 times P, the noise 1 to 20 % of the wave of the mode.
pub(crate) fn usual(seed: u64) -> Conditions {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut between = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut random);
    let s_over_p = between(0.0, 300f64.ln()).exp();
    let noise = between(0.01f64.ln(), 0.2f64.ln()).exp();
    Conditions { s_over_p, noise, periods: 5.0..9.0, resonance: None, after: None, repetition: 0 }
}

/// Returns true if a wave that is larger than S follows S in the record of number `seed`.
pub(crate) fn has_later(seed: u64) -> bool {
    (seed / 2).is_multiple_of(2)
}

/// Computes the record of number `seed` under these conditions. It is of P if the number is even, else of S.
pub(crate) fn computed(seed: u64, conditions: &Conditions) -> Computed {
    let Conditions { s_over_p, noise, resonance, .. } = *conditions;
    let mut random = Pcg64Mcg::seed_from_u64(seed ^ PLACE);
    let mut between = |low: f64, high: f64| Uniform::new(low, high).unwrap().sample(&mut random);
    let longitudinal = seed.is_multiple_of(2);
    let cycles = if between(0.0, 1.0) < 0.5 { 1.0 } else { 2.0 };
    let period = between(24.0, 50.0);
    let source = Source::new(1.0 / period, cycles);
    let q = between(12.0, 50.0);
    let ratio = between(1.45, 1.75);
    let p = (period * between(conditions.periods.start, conditions.periods.end)).min(400.0 / ratio);
    let [s, later] = [p * ratio, p * ratio * between(1.24, 1.5)];
    let sign = |u: f64| if u < 0.5 { -1.0 } else { 1.0 };
    let heights = [1.0, s_over_p * sign(between(0.0, 1.0)), s_over_p * between(1.3, 2.0)];
    let reversed = sign(between(0.0, 1.0));
    // The wave of the mode has the peak 1.
    let unit = reversed / if longitudinal { 1.0 } else { heights[1].abs() };
    let crosstalk = between(0.0, 1.0);
    let near_share = between(0.0, 1.0);
    let waves = [p, s, later].map(|time| source.arrival(time, q, resonance));
    let near = source.near([p, s], longitudinal);
    let time = if longitudinal { p } else { s };
    let end = conditions.after.map(|after| QUIET + (time + after * cycles * period) as usize);
    let samples = end.unwrap_or(SAMPLES).min(SAMPLES);
    let sent = source.samples[..samples].to_vec();
    for _ in 0..conditions.repetition * SAMPLES as u64 {
        let _: f64 = StandardNormal.sample(&mut random);
    }
    let receiver = (0..samples)
        .map(|k| {
            let later = if has_later(seed) { heights[2] * sign(heights[1]) * waves[2][k] } else { 0.0 };
            let near = near_share * near[k] * if longitudinal { 1.0 } else { heights[1] };
            let gauss: f64 = StandardNormal.sample(&mut random);
            unit * (waves[0][k] + heights[1] * waves[1][k] + later + near)
                + crosstalk * sent[k]
                + noise * gauss
        })
        .collect();
    let passage = Passage {
        distance: DISTANCE,
        distance_stddev: 0.0,
        delay: 0.0,
        delay_stddev: 0.0,
        lowpass: None,
        highpass: None,
        filter_order: 1,
        reversed: None,
        // 500 grains and more per wavelength: no dispersion except by the losses.
        diameter: 3e-5,
        longitudinal: Some(longitudinal),
    };
    Computed {
        record: Record { sample_rate: RATE, quiet: 0..QUIET - 8, source: sent, receiver },
        passage,
        speed: DISTANCE / time * RATE,
    }
}
