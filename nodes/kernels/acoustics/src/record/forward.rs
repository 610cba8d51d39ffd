//! Records that are computed for a path of known speed.

use super::band::Band;
use crate::noise::Noise;
use crate::time_of_flight::spectrum::{Analytic, Spectrum};
use std::f64::consts::{PI, TAU};

/// Relative difference of ρ v² at the wave number q from that of long waves, over (q × mean diameter)²: mean and standard deviation of
/// packings, for P, S, and one of both.
const BEND: [(f64, f64); 3] = [(0.65, 0.17), (0.35, 0.14), (0.5, 0.2)];

/// Speed of P over that of S, which the near field lies between.
const FASTER: f64 = 1.6;

/// Logarithm of the ratio of the frequencies of long waves and of the source, in a medium of constant Q: standard deviation. The test
/// `stated_errors_hold_for_waves_in_packings` checks it, on waves whose limit of long waves is known.
const SLOWED: f64 = 1.0;

/// Frequency over that of the source up to which the delay grows with dispersion, so that it does not wrap around.
const BOUND: f64 = 3.0;

/// A path in units of samples and of its source.
#[derive(Clone)]
pub(super) struct Path {
    spectrum: Spectrum,
    lines: Vec<Analytic>,
    frequency: f64,
    /// Loss of amplitude, e-folds per unit of frequency.
    loss: f64,
    /// Distance over the mean diameter of the grains.
    diameters: f64,
    longitudinal: Option<bool>,
}

/// Properties of a path that a pair of records does not determine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unknown {
    bend: f64,
    slowed: f64,
    /// True for losses that are proportional to the frequency, false for losses that are proportional to its square.
    is_of_constant_q: bool,
    near: f64,
    longitudinal: bool,
}

impl Path {
    /// The path between a source and what arrived of it, of the loss that makes the mean frequency of the source that of the arrival, both
    /// weighted by the energy of the source.
    pub(super) fn between(
        source: &[f64],
        arrival: &[f64],
        band: &Band,
        (diameters, longitudinal): (f64, Option<bool>),
    ) -> Self {
        let spectrum = Spectrum::new(source.len(), 1);
        let lines = spectrum.of(source);
        // Weighted by the source, which has little energy where only noise arrives.
        let arrived = spectrum.of(arrival);
        let (mut energies, mut moments) = (Vec::new(), (0.0, 0.0));
        for ((f, s), a) in spectrum.frequencies().zip(&lines).zip(&arrived) {
            let [sent, arrived] = [s, a].map(|line| line.norm_sqr());
            energies.push((f, sent * sent));
            moments = (moments.0 + f * sent * arrived, moments.1 + sent * arrived);
        }
        let target = moments.0 / moments.1;
        let mean = |loss: f64| {
            let (m, e) = energies.iter().fold((0.0, 0.0), |(m, e), (f, s)| {
                let left = s * (-2.0 * loss * f).exp();
                (m + f * left, e + left)
            });
            m / e
        };
        let (mut low, mut high) = (0.0, 8.0 / band.frequency);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if mean(middle) > target { low = middle } else { high = middle }
        }
        Self { spectrum, lines, frequency: band.frequency, loss: 0.5 * (low + high), diameters, longitudinal }
    }

    pub(super) fn typical(&self) -> Unknown {
        let bend = BEND[self.longitudinal.map_or(2, |l| usize::from(!l))].0;
        let longitudinal = self.longitudinal == Some(true);
        Unknown { bend, slowed: 0.0, is_of_constant_q: true, near: 0.0, longitudinal }
    }

    pub(super) fn drawn(&self, random: &mut Noise) -> Unknown {
        let (mean, spread) = BEND[self.longitudinal.map_or(2, |l| usize::from(!l))];
        Unknown {
            bend: (mean + spread * random.next()).max(0.0),
            slowed: SLOWED * random.next(),
            is_of_constant_q: random.next() > 0.0,
            // From none, of a wide source, to that of a point.
            near: random.next().abs().min(1.5) / 1.5,
            longitudinal: self.longitudinal.unwrap_or_else(|| random.next() > 0.0),
        }
    }

    /// The signal that arrives after the travel time `time` of long waves and that of the system, samples.
    pub(super) fn arrival(&self, time: f64, system: f64, unknown: &Unknown) -> Vec<f64> {
        // (q d)² is (2π f d/v)², with d/v = time/diameters.
        let bend = 0.5 * unknown.bend * (TAU * time / self.diameters).powi(2);
        // Losses that are proportional to the frequency make low frequencies slower, so that nothing arrives before the wave (Aki and
        // Richards, eq. 5.81): by t/(π Q) = loss/π² per e-fold of the frequency. Losses by its square, as of viscous contacts and of
        // scattering, that shift the mean frequency alike, make low frequencies as fast as others to first order.
        let slowed = |f: f64| {
            let folds = (f.max(f64::MIN_POSITIVE) / self.frequency).ln();
            if unknown.is_of_constant_q { self.loss / PI.powi(2) * (unknown.slowed - folds) } else { 0.0 }
        };
        let loss =
            |f: f64| self.loss * if unknown.is_of_constant_q { f } else { 0.5 * f.powi(2) / self.frequency };
        let dispersed = |f: f64| 1.0 + bend * f.powi(2).min((BOUND * self.frequency).powi(2));
        let late = |f: f64| TAU * f * (system + time * dispersed(f) + slowed(f));
        let lost: Vec<Analytic> =
            self.lines.iter().zip(self.spectrum.frequencies()).map(|(s, f)| s * (-loss(f)).exp()).collect();
        let mut far = self.spectrum.delayed(&lost, late);
        if unknown.near > 0.0 {
            // Between the arrivals of P and S a point source moves grains by ∫ τ f(t − τ) dτ/r³, twice along and −1 times across the path
            // (Aki and Richards, Quantitative Seismology, eq. 4.23).
            let (from, to) = if unknown.longitudinal { (time, FASTER * time) } else { (time / FASTER, time) };
            let factor = if unknown.longitudinal { 2.0 } else { -1.0 } * unknown.near;
            let steps = (to - from).ceil().max(1.0) as usize;
            let width = (to - from) / steps as f64;
            let mut near = vec![0.0; far.len()];
            let source = self.spectrum.delayed(&lost, |f| TAU * f * (system + slowed(f)));
            for k in 0..steps {
                let tau = from + (k as f64 + 0.5) * width;
                let shift = tau.round() as usize;
                for (n, s) in near.iter_mut().skip(shift).zip(&source) {
                    *n += tau * width * s / time.powi(2);
                }
            }
            far.iter_mut().zip(near).for_each(|(f, n)| *f += factor * n);
        }
        far
    }
}
