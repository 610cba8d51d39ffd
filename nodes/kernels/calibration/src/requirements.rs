//! Properties of packings that a calibration needs.

use crate::sample::CalibrationSample;
use grainlab_emt::{CalibrationError, HALF_WIDTH};
use std::collections::{BTreeMap, BTreeSet};

/// Largest |ε| of an isotropic packing, in standard deviations of chance: 1 in 80 packings of independent contacts is beyond. Of the
/// isotropic recipes of `tests/golden/ensembles`, the largest is 2.42 in `wide.csv` and 1.45 in `isotropic.csv`.
const ISOTROPIC: f64 = 2.5;

/// Largest mean of ε of isotropic packings, in standard errors of chance.
const ISOTROPIC_MEAN: f64 = 3.0;

/// Refuses packings that are given twice, isotropic ones whose ε is not due to chance, and anisotropic ones whose ε does not vary
/// more than by chance, because the laws would be slopes over noise.
pub fn check(
    isotropic: &[CalibrationSample],
    anisotropic: &[CalibrationSample],
    others: &[CalibrationSample],
) -> Result<(), CalibrationError> {
    let mut known = BTreeMap::new();
    for s in isotropic.iter().chain(anisotropic).chain(others) {
        let state = [s.pressure, s.solid_fraction, s.k, s.z, s.eps].map(f64::to_bits);
        if let Some(first) = known.insert(state, &s.place) {
            return Err(s.fault(format!("it is the same as that of {first}: give each packing once")));
        }
    }
    for s in isotropic {
        let limit = ISOTROPIC * chance(s);
        if s.eps.abs() > limit {
            let fault =
                format!("it is not isotropic: eps is {:.3}, and chance makes at most {limit:.3}", s.eps);
            return Err(s.fault(fault + " of it; is its file that of --anisotropic?"));
        }
    }
    let ((mean, variance), count) = (moments(isotropic), packings(isotropic));
    let limit = ISOTROPIC_MEAN / (count as f64).sqrt();
    if mean.abs() > limit {
        return Err(CalibrationError::Undetermined(format!(
            "the packings of --isotropic are not isotropic: the mean of their eps is {mean:.2} standard deviations of one packing by \
             chance, and that of {count} is within {limit:.2}: give them as anisotropic ones"
        )));
    }
    let varied: Vec<_> = anisotropic.iter().chain(others).cloned().collect();
    // The logarithm of a variance of n values has the variance 2/(n - 1).
    let of_log = |n: usize| 2.0 / (n.max(2) - 1) as f64;
    let needed = (HALF_WIDTH * (of_log(packings(&varied)) + of_log(count)).sqrt()).exp();
    let found = moments(&varied).1 / variance;
    if varied.is_empty() || found > needed {
        return Ok(());
    }
    Err(CalibrationError::Undetermined(format!(
        "no slope by eps is determined: the variance of eps of the anisotropic packings is {found:.2} of that of the isotropic ones, \
         which is chance, and must exceed {needed:.2}: prepare packings of other frictions, or pressed in other ways"
    )))
}

/// Standard deviation of ε of an isotropic packing with independent contacts: (5/4/N_c)^½.
fn chance(s: &CalibrationSample) -> f64 {
    (1.25 / (0.5 * f64::from(s.grains) * s.k)).sqrt()
}

/// Mean and variance of ε in standard deviations of chance.
fn moments(samples: &[CalibrationSample]) -> (f64, f64) {
    let mean = |f: &dyn Fn(f64) -> f64| {
        samples.iter().map(|s| f(s.eps / chance(s))).sum::<f64>() / samples.len() as f64
    };
    let first = mean(&|x| x);
    (first, mean(&|x| (x - first).powi(2)))
}

/// Number of packings: states of one at several pressures are not independent.
pub fn packings<'a>(samples: impl IntoIterator<Item = &'a CalibrationSample>) -> usize {
    samples.into_iter().map(|s| (&s.preparation, &s.packing)).collect::<BTreeSet<_>>().len()
}
