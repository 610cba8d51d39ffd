//! Differences between settings, averaged over seeds, with their standard errors.
//!
//! Packings diverge after any perturbation, however small. The difference between two single runs is
//! therefore the sum of the effect of the setting and of chance. The mean of the differences over seeds is
//! the effect, within its standard error.

use crate::numbers::rms;
use grainlab_page::Mean;

/// Measured on the packing at the end of a path: coordination k of all grains, anisotropy ε of the contacts about e3 (Eq. 20),
/// solid fraction φ, shear modulus G12 and bulk modulus Θ of the frozen network.
pub(super) type Observables = [f64; 5];

/// True if zero lies outside the 95 % interval. A mean without scatter is resolved, even if it is zero: then every sample is
/// exactly zero.
pub(super) fn is_resolved(mean: &Mean) -> bool {
    mean.half_width().is_some_and(|half| mean.value.abs() >= half)
}

/// Mean of at least two samples; of a single one the error is unknown.
pub(super) fn estimate(samples: impl IntoIterator<Item = f64>) -> Option<Mean> {
    Mean::of(samples).filter(|mean| mean.error.is_some())
}

/// The difference of two settings at the same seeds, over the seeds at which both succeeded; `None` with
/// fewer than two of them.
pub(super) fn paired(of: &[Option<Observables>], from: &[Option<Observables>]) -> Option<[Mean; 5]> {
    let both: Vec<_> = of.iter().zip(from).filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?))).collect();
    let of = |q: usize| estimate(both.iter().map(|(a, b)| a[q] - b[q]));
    Some([of(0)?, of(1)?, of(2)?, of(3)?, of(4)?])
}

/// One number for five errors: the root mean square of their bounds (the magnitude of the mean if it is resolved, else the half
/// width of its interval), each over the seed scatter of its
/// quantity, so that 1 is the random error of one packing. `None` without scatter.
pub(super) fn combined(errors: &[Mean; 5], scatter: &Observables) -> Option<f64> {
    let bound = |e: &Mean| e.value.abs().max(e.half_width().unwrap_or(0.0));
    let shares: Vec<f64> =
        errors.iter().zip(scatter).filter(|(_, s)| **s > 0.0).map(|(e, s)| bound(e) / s).collect();
    (!shares.is_empty()).then(|| rms(&shares))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(value: f64) -> Observables {
        [value; 5]
    }

    #[test]
    fn a_mean_within_its_interval_is_unresolved_and_counts_with_its_bound() {
        let noise = Mean { value: -0.19, error: Some(0.1), count: 1000 };
        let bound = |mean: Mean| combined(&[mean; 5], &all(1.0)).unwrap();
        assert!(!is_resolved(&noise) && (bound(noise) - 0.2).abs() < 1e-12);
        let effect = Mean { value: -0.21, ..noise };
        assert!(is_resolved(&effect) && (bound(effect) - 0.21).abs() < 1e-12);
        // The scatter of three samples is often too small by chance.
        assert!(!is_resolved(&Mean { count: 3, ..effect }));
        assert_eq!(estimate([1.0]), None);
    }

    #[test]
    fn equal_results_have_an_error_of_exactly_zero_that_counts_as_known() {
        let runs = [Some(all(5.1)), Some(all(4.9)), Some(all(5.3))];
        let none = paired(&runs, &runs).unwrap();
        assert!(none.iter().all(|e| is_resolved(e) && e.value == 0.0 && e.error == Some(0.0)));
        assert_eq!(combined(&none, &all(0.1)), Some(0.0));
    }

    #[test]
    fn pairing_takes_the_scatter_of_the_seeds_out_of_a_difference() {
        let from: Vec<_> = [4.0, 5.0, 6.0].map(|v| Some(all(v))).into();
        let of: Vec<_> = [4.1, 5.2, 6.3].map(|v| Some(all(v))).into();
        let k = paired(&of, &from).unwrap()[0];
        assert!((k.value - 0.2).abs() < 1e-12 && (k.error.unwrap() - 0.1 / 3f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn only_seeds_at_which_both_settings_ended_count() {
        let from = [Some(all(1.0)), None, Some(all(1.0)), Some(all(1.0))];
        let of = [Some(all(2.0)), Some(all(9.0)), None, Some(all(4.0))];
        assert_eq!(paired(&of, &from).unwrap()[2].value, 2.0);
        assert_eq!(paired(&of[..3], &from[..3]), None);
    }

    #[test]
    fn the_combined_error_is_in_units_of_the_scatter_and_quantities_without_scatter_stay_out() {
        let error = Mean { value: 0.3, error: Some(0.0), count: 8 };
        let errors = [error; 5];
        assert!((combined(&errors, &all(0.1)).unwrap() - 3.0).abs() < 1e-12);
        let one = [0.1, 0.0, 0.0, 0.0, 0.0];
        assert!((combined(&errors, &one).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(combined(&errors, &all(0.0)), None);
    }
}
