//! Posterior predictive probabilities of observed moduli: packings of recipes that taught nothing, and the rows of the paper.

use crate::left_out::by_file;
use crate::{csv, ours};
use grainlab_emt::{
    Calibration, Check, EmtError, ModulusCheck, Observation, Posterior, PosteriorSettings, Prior, Relaxed,
    StrainRatioSource,
};
use grainlab_testkit::nightly;
use std::collections::BTreeSet;

fn check(observation: &Observation, calibration: &Calibration) -> Result<Check, EmtError> {
    let settings = PosteriorSettings { points: 4096, seed: 0 };
    Ok(Posterior::new(&Relaxed, observation, calibration, &Prior::default(), settings)?.check())
}

/// The least probability of a modulus given the others, times their number.
fn least(check: &Check) -> f64 {
    let least = check.least().and_then(|m| m.left_out).unwrap_or(1.0);
    (least * check.moduli.len() as f64).min(1.0)
}

#[test]
fn few_packings_of_recipes_that_taught_nothing_are_improbable() {
    let (mut all, mut unlikely, mut known) = (Vec::new(), 0, BTreeSet::new());
    for (packings, calibration) in by_file() {
        for s in packings {
            // States of one packing are not independent.
            if !known.insert(&s.packing) || !known.len().is_multiple_of(nightly(3, 1)) {
                continue;
            }
            let Ok(found) = check(&s.observation(StrainRatioSource::Zero), calibration) else { continue };
            unlikely += usize::from(found.is_unlikely());
            all.push(found);
        }
    }
    let share = |f: &dyn Fn(&Check) -> bool| all.iter().filter(|c| f(c)).count() as f64 / all.len() as f64;
    let [chi_square, one] = [share(&|c| c.chi_square < 0.05), share(&|c| least(c) < 0.05)];
    eprintln!(
        "{} packings: {unlikely} unlikely; p < .05: chi-square {chi_square:.3}, least modulus {one:.3}",
        all.len()
    );
    // Of a third of the packings, two may be.
    assert!(all.len() >= nightly(50, 160) && unlikely <= nightly(2, all.len() / 50), "{unlikely}");
}

/// Although the k of the paper is outside the interval of every row. `--nocapture` prints the probabilities.
#[test]
fn no_row_of_the_paper_is_unlike_the_packings_of_the_calibration() {
    let mut below = 0;
    for (observation, _) in csv::paper_rows() {
        let found = check(&observation, ours()).unwrap();
        let of = |m: &ModulusCheck| format!("{} {:.3} {:.3}", m.modulus, m.predictive, m.left_out.unwrap());
        let moduli: Vec<_> = found.moduli.iter().map(of).collect();
        let kpa = observation.pressure() / 1e3;
        eprintln!(
            "{kpa} kPa: p of chi-square {:.3}; of moduli, predicted and left out: {}",
            found.chi_square,
            moduli.join(", ")
        );
        assert!(!found.is_unlikely(), "{found:?}");
        below += usize::from(found.moduli.iter().any(|m| m.left_out.unwrap() < 0.05));
    }
    eprintln!("{below} of 16 with a modulus left out below .05");
}
