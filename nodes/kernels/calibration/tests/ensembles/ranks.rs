//! Ranks of the counted structure among draws from the posterior, for packings of recipes that taught nothing.

use crate::left_out::{QUANTITIES, by_file, truth};
use grainlab_calibration::CalibrationSample;
use grainlab_core::notes::Code;
use grainlab_emt::{
    CREDIBLE_LEVEL, Calibration, EmtError, Posterior, PosteriorSettings, Prior, Relaxed, StrainRatioSource,
};
use grainlab_testkit::nightly;
use std::collections::{BTreeMap, BTreeSet};

/// With the true value, a multiple of the number of bins.
const DRAWS: usize = 199;
const BINS: usize = 10;

/// Number of shares in each bin, and χ² of equal numbers.
fn histogram(shares: impl Iterator<Item = f64>) -> ([f64; BINS], f64) {
    let mut counts = [0.0; BINS];
    shares.for_each(|share| counts[((share * BINS as f64) as usize).min(BINS - 1)] += 1.0);
    let expected = counts.iter().sum::<f64>() / BINS as f64;
    (counts, counts.iter().map(|c| (c - expected).powi(2) / expected).sum())
}

/// The share of draws below the true value of each quantity.
fn shares(s: &CalibrationSample, calibration: &Calibration, seed: u64) -> Result<[f64; 4], EmtError> {
    let observation = s.observation(StrainRatioSource::Zero);
    let settings = PosteriorSettings { points: 2048, seed };
    let posterior = Posterior::new(&Relaxed, &observation, calibration, &Prior::default(), settings)?;
    let draws = posterior.draws(DRAWS)?.draws;
    Ok(QUANTITIES.map(|q| {
        let below = draws.iter().filter(|d| d.structure.get(q).unwrap() < truth(s, q)).count();
        below as f64 / (DRAWS + 1) as f64
    }))
}

/// States of one packing are not independent: the first state of each packing is counted. `--nocapture` prints the histograms.
#[test]
fn ranks_of_packings_of_recipes_that_taught_nothing_are_not_more_often_at_the_ends_than_stated() {
    let mut of_states: Vec<(&str, [f64; 4])> = Vec::new();
    let (mut unknown, mut seen) = (0, BTreeSet::new());
    // All states, or the first one of each packing.
    let (least, [low, high]) = nightly((150, [0.89, 1.0]), (500, [0.92, 0.98]));
    for (packings, calibration) in by_file() {
        for s in packings {
            if !seen.insert(&s.packing) && nightly(true, false) {
                continue;
            }
            match shares(s, calibration, of_states.len() as u64) {
                Ok(found) => of_states.push((&s.packing, found)),
                Err(EmtError::NotSampled { .. }) => unknown += 1,
                Err(e) if e.is(Code::TooFar) || e.is(Code::NoCoordination) => unknown += 1,
                Err(e) => panic!("{}: {e}", s.preparation),
            }
        }
    }
    eprintln!("{} states, {unknown} unknown; {BINS} bins of ranks, chi-square", of_states.len());
    let mut first: BTreeMap<&str, &[f64; 4]> = BTreeMap::new();
    for (packing, found) in &of_states {
        first.entry(packing).or_insert(found);
    }
    assert!(of_states.len() >= least, "{unknown}");
    for (i, quantity) in QUANTITIES.into_iter().enumerate() {
        let all = histogram(of_states.iter().map(|(_, s)| s[i]));
        let one = histogram(first.values().map(|s| s[i]));
        let within = |s: &&(&str, [f64; 4])| (2.0 * s.1[i] - 1.0).abs() < CREDIBLE_LEVEL;
        let covered = of_states.iter().filter(within).count() as f64 / of_states.len() as f64;
        for (name, (counts, chi_square)) in [("all states", &all), ("one state a packing", &one)] {
            eprintln!("{quantity:13} {name:20} {counts:?} chi-square {chi_square:.1}");
        }
        let mean = of_states.iter().map(|(_, s)| s[i]).sum::<f64>() / of_states.len() as f64;
        eprintln!("{quantity:13} within 95 %: {covered:.3}; mean rank {mean:.3}");
        assert!((low..=high).contains(&covered), "{quantity}: {covered}");
        let ends = (one.0[0] + one.0[BINS - 1]) / one.0.iter().sum::<f64>();
        // Three standard errors of a share of 0.2 above it.
        let most = 0.2 + 3.0 * (0.16 / one.0.iter().sum::<f64>()).sqrt();
        assert!(ends < most && (mean - 0.5).abs() < nightly(0.12, 0.08), "{quantity}: {one:?} {mean}");
    }
}
