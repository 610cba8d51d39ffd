//! Differences between settings, averaged over seeds, with their standard errors.
//!
//! Packings diverge after any perturbation, however small. The difference between two single runs is
//! therefore the sum of the effect of the setting and of chance. The mean of the differences over seeds is
//! the effect, within its standard error.

use crate::numbers::{mean, rms};
use grainlab_page::student;

/// Measured on the packing at the end of a path: coordination k of all grains, anisotropy ε of the contacts about e3 (Eq. 20),
/// solid fraction φ, shear modulus G12 and bulk modulus Θ of the frozen network.
pub(super) type Observables = [f64; 5];

/// A mean over seeds with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Estimate {
    /// Mean of the samples.
    pub(super) mean: f64,
    /// Standard error of the mean: standard deviation over √n.
    pub(super) standard_error: f64,
    /// Number of samples n, at least two.
    pub(super) samples: usize,
}

impl Estimate {
    /// From at least two samples; a single sample has no standard error.
    pub(super) fn of(samples: &[f64]) -> Option<Self> {
        let n = samples.len();
        let standard_error = deviation(samples)? / (n as f64).sqrt();
        Some(Self { mean: mean(samples), standard_error, samples: n })
    }

    /// Half width of the 95 % interval of the mean: two standard errors with many samples, more with few.
    pub(super) fn half_width(&self) -> f64 {
        student(self.samples - 1) * self.standard_error
    }

    /// True if zero lies outside the 95 % interval. A mean without scatter is resolved, even if it is zero:
    /// then every sample is exactly zero.
    pub(super) fn resolved(&self) -> bool {
        self.mean.abs() >= self.half_width()
    }

    /// The magnitude for further use: that of the mean if it is resolved, else the half width, its upper
    /// bound.
    pub(super) fn bound(&self) -> f64 {
        self.mean.abs().max(self.half_width())
    }
}

/// Standard deviation of at least two samples, with n − 1.
pub(super) fn deviation(samples: &[f64]) -> Option<f64> {
    if samples.len() < 2 {
        return None;
    }
    let mean = mean(samples);
    let squares = samples.iter().map(|s| (s - mean).powi(2)).sum::<f64>();
    Some((squares / (samples.len() as f64 - 1.0)).sqrt())
}

/// The difference of two settings at the same seeds, over the seeds at which both succeeded; `None` with
/// fewer than two of them.
pub(super) fn paired(of: &[Option<Observables>], from: &[Option<Observables>]) -> Option<[Estimate; 5]> {
    let both: Vec<_> = of.iter().zip(from).filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?))).collect();
    let of = |q: usize| Estimate::of(&both.iter().map(|(a, b)| a[q] - b[q]).collect::<Vec<_>>());
    Some([of(0)?, of(1)?, of(2)?, of(3)?, of(4)?])
}

/// One number for five errors: the root mean square of their bounds, each over the seed scatter of its
/// quantity, so that 1 is the random error of one packing. `None` without scatter.
pub(super) fn combined(errors: &[Estimate; 5], scatter: &Observables) -> Option<f64> {
    let shares: Vec<f64> =
        errors.iter().zip(scatter).filter(|(_, s)| **s > 0.0).map(|(e, s)| e.bound() / s).collect();
    (!shares.is_empty()).then(|| rms(&shares))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(value: f64) -> Observables {
        [value; 5]
    }

    #[test]
    fn mean_and_standard_error_are_those_of_the_textbook() {
        // 1, 2, 3, 4: deviation √(5/3), standard error √(5/12).
        let e = Estimate::of(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert!((e.mean - 2.5).abs() < 1e-15 && (e.standard_error - (5.0f64 / 12.0).sqrt()).abs() < 1e-15);
        assert_eq!(Estimate::of(&[1.0]), None);
    }

    #[test]
    fn a_mean_within_its_interval_is_unresolved_and_counts_with_its_bound() {
        let noise = Estimate { mean: -0.19, standard_error: 0.1, samples: 1000 };
        assert!(!noise.resolved() && noise.bound() == 0.2);
        let effect = Estimate { mean: -0.21, ..noise };
        assert!(effect.resolved() && effect.bound() == 0.21);
        // The scatter of three samples is often too small by chance.
        assert!(!Estimate { samples: 3, ..effect }.resolved());
    }

    #[test]
    fn equal_results_have_an_error_of_exactly_zero_that_counts_as_known() {
        let runs = [Some(all(5.1)), Some(all(4.9)), Some(all(5.3))];
        let none = paired(&runs, &runs).unwrap();
        assert!(none.iter().all(|e| e.resolved() && e.mean == 0.0 && e.standard_error == 0.0));
        assert_eq!(combined(&none, &all(0.1)), Some(0.0));
    }

    #[test]
    fn pairing_takes_the_scatter_of_the_seeds_out_of_a_difference() {
        let from: Vec<_> = [4.0, 5.0, 6.0].map(|v| Some(all(v))).into();
        let of: Vec<_> = [4.1, 5.2, 6.3].map(|v| Some(all(v))).into();
        let k = paired(&of, &from).unwrap()[0];
        assert!((k.mean - 0.2).abs() < 1e-12 && (k.standard_error - 0.1 / 3f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn only_seeds_at_which_both_settings_ended_count() {
        let from = [Some(all(1.0)), None, Some(all(1.0)), Some(all(1.0))];
        let of = [Some(all(2.0)), Some(all(9.0)), None, Some(all(4.0))];
        assert_eq!(paired(&of, &from).unwrap()[2].mean, 2.0);
        assert_eq!(paired(&of[..3], &from[..3]), None);
    }

    #[test]
    fn the_combined_error_is_in_units_of_the_scatter_and_quantities_without_scatter_stay_out() {
        let error = Estimate { mean: 0.3, standard_error: 0.0, samples: 8 };
        let errors = [error; 5];
        assert!((combined(&errors, &all(0.1)).unwrap() - 3.0).abs() < 1e-12);
        let one = [0.1, 0.0, 0.0, 0.0, 0.0];
        assert!((combined(&errors, &one).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(combined(&errors, &all(0.0)), None);
    }
}
