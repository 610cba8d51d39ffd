//! Spectra of sampled signals: filters, interpolation, correlation.

use rustfft::algorithm::Radix4;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftDirection, Length};
use std::sync::Arc;

/// A complex number whose real part is a signal and whose magnitude is its envelope.
pub(crate) type Analytic = Complex<f64>;

/// Transforms of signals of one length.
#[derive(Clone)]
pub(crate) struct Spectrum {
    samples: usize,
    forward: Arc<Radix4<f64>>,
    back: Arc<Radix4<f64>>,
    finer: usize,
}

impl Spectrum {
    /// For signals of `samples` samples, interpolated to `finer` times as many, a power of two. Zeros of the same number are
    /// appended, so that the ends of a signal do not interact. One algorithm on every processor, so that results are the same
    /// on all of them.
    pub(crate) fn new(samples: usize, finer: usize) -> Self {
        let padded = (2 * samples).next_power_of_two();
        let of = |length, direction| Arc::new(Radix4::new(length, direction));
        let (forward, back) = (of(padded, FftDirection::Forward), of(padded * finer, FftDirection::Inverse));
        Self { samples, forward, back, finer }
    }

    /// Number of the frequencies of a spectrum, of either sign.
    pub(crate) fn padded(&self) -> usize {
        self.forward.len()
    }

    /// Frequencies from zero to half the sampling rate, samples⁻¹.
    pub(crate) fn frequencies(&self) -> impl Iterator<Item = f64> {
        let padded = self.padded();
        (0..=padded / 2).map(move |k| k as f64 / padded as f64)
    }

    /// The spectrum of a signal, padded.
    pub(crate) fn of(&self, signal: &[f64]) -> Vec<Analytic> {
        let mut spectrum = vec![Complex::default(); self.padded()];
        spectrum.iter_mut().zip(signal).for_each(|(s, x)| s.re = *x);
        self.forward.process(&mut spectrum);
        spectrum
    }

    /// The magnitude of the spectrum of a signal, over its maximum: the zero-phase filter with the best ratio of that
    /// signal to white noise.
    pub(crate) fn shape(&self, signal: &[f64]) -> Vec<f64> {
        let magnitude: Vec<f64> =
            self.of(signal).iter().take(self.padded() / 2 + 1).map(|s| s.norm()).collect();
        let largest = magnitude.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        magnitude.iter().map(|m| m / largest).collect()
    }

    /// Root mean square of filtered white noise over that of the noise.
    pub(crate) fn passed(filter: &[f64]) -> f64 {
        (filter.iter().map(|f| f * f).sum::<f64>() / filter.len() as f64).sqrt()
    }

    /// The filtered analytic signal at the interpolated times; `filter` is one factor per frequency.
    pub(crate) fn filtered(&self, signal: &[f64], filter: &[f64]) -> Vec<Analytic> {
        let mut spectrum = self.of(signal);
        spectrum.iter_mut().zip(filter).for_each(|(s, f)| *s *= f);
        let mut fine = self.refined(&spectrum);
        fine.truncate(self.samples * self.finer);
        fine
    }

    /// The signal of a spectrum whose frequencies (samples⁻¹) are delayed by a phase, rad, at the interpolated times.
    pub(crate) fn delayed(&self, spectrum: &[Analytic], phase: impl Fn(f64) -> f64) -> Vec<f64> {
        let turned = |(s, f): (&Analytic, f64)| s * Complex::cis(-phase(f));
        let turned: Vec<Analytic> = spectrum.iter().zip(self.frequencies()).map(turned).collect();
        self.refined(&turned).iter().take(self.samples * self.finer).map(|s| s.re).collect()
    }

    /// The spectrum of an analytic signal at the original times, padded.
    pub(crate) fn of_analytic(&self, signal: Vec<Analytic>) -> Vec<Analytic> {
        let mut spectrum = signal;
        spectrum.resize(self.padded(), Complex::default());
        self.forward.process(&mut spectrum);
        spectrum
    }

    /// Correlation of two signals given by their spectra, at the interpolated delays: delay k − length/2 at index k.
    pub(crate) fn correlation(&self, late: &[Analytic], early: &[Analytic]) -> Vec<Analytic> {
        let product: Vec<Analytic> = late.iter().zip(early).map(|(l, e)| l * e.conj()).collect();
        let mut fine = self.refined(&product);
        let half = fine.len() / 2;
        fine.rotate_right(half);
        fine
    }

    /// The analytic signal of a spectrum: positive frequencies alone, doubled.
    fn refined(&self, spectrum: &[Analytic]) -> Vec<Analytic> {
        let half = self.padded() / 2;
        let mut fine = vec![Complex::default(); self.back.len()];
        let scale = 2.0 / self.padded() as f64;
        // Zero and the last frequency belong to both signs and are left out.
        fine[1..half].iter_mut().zip(&spectrum[1..half]).for_each(|(f, s)| *f = s * scale);
        self.back.process(&mut fine);
        fine
    }
}

/// Position and height of the maximum of `of`, interpolated by the parabola through its neighbours.
pub(crate) fn summit(of: impl Fn(usize) -> f64, places: std::ops::Range<usize>) -> Option<(f64, f64)> {
    let inner = places.start.max(1)..places.end.saturating_sub(1);
    let top = places.max_by(|a, b| of(*a).total_cmp(&of(*b)))?;
    Some(if inner.contains(&top) { vertex(&of, top) } else { (top as f64, of(top)) })
}

/// The vertex of the parabola through a point and its neighbours.
pub(crate) fn vertex(of: &impl Fn(usize) -> f64, top: usize) -> (f64, f64) {
    let (before, at, after) = (of(top - 1), of(top), of(top + 1));
    let bent = before - 2.0 * at + after;
    let shift = if bent < 0.0 { (0.5 * (before - after) / bent).clamp(-1.0, 1.0) } else { 0.0 };
    (top as f64 + shift, at - 0.25 * (before - after) * shift)
}
