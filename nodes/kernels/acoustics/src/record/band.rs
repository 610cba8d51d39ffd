//! Band of a source.

use crate::time_of_flight::spectrum::Spectrum;

/// Share of the energy of a source before and after its duration.
const TAIL: f64 = 0.005;

/// Band of a source: its duration (samples), and the mean frequency of its energy (samples⁻¹).
#[derive(Clone, Copy, Debug)]
pub(super) struct Band {
    pub(super) from: usize,
    pub(super) duration: f64,
    pub(super) frequency: f64,
    /// Travel time of the system, samples.
    pub(super) system: f64,
}

impl Band {
    pub(super) fn of(source: &[f64], system: f64) -> Self {
        let total: f64 = source.iter().map(|s| s * s).sum();
        let grown = |sum: &mut f64, s: &f64| {
            *sum += s * s / total;
            Some(*sum)
        };
        let share: Vec<f64> = source.iter().scan(0.0, grown).collect();
        let from = share.partition_point(|s| *s < TAIL);
        let to = share.partition_point(|s| *s < 1.0 - TAIL);
        let spectrum = Spectrum::new(source.len(), 1);
        Self { from, duration: (to - from + 1) as f64, frequency: centre(&spectrum, source), system }
    }
}

/// Mean frequency of the energy of a signal, samples⁻¹.
pub(super) fn centre(spectrum: &Spectrum, signal: &[f64]) -> f64 {
    let lines = spectrum.of(signal);
    let energies = spectrum.frequencies().zip(&lines).map(|(f, s)| (f, s.norm_sqr()));
    let (moment, energy) = energies.fold((0.0, 0.0), |(m, e), (f, s)| (m + f * s, e + s));
    moment / energy
}
