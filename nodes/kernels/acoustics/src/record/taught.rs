//! What teaches the constants of `travel_time`: computed records of known speed, other than those of the tests of stated errors.

use super::computed_records::{Computed, Conditions, computed, computed_under};
use super::travel_time::{OF_INTERVAL, Pick, TAUGHT, picks};
use grainlab_testkit::nightly;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rayon::prelude::*;

/// First number of a record that teaches. Those of `pick_coverage`, which judges, are smaller.
const FIRST: u64 = 100_000;

/// Computes records under the conditions that `change` makes of a usual record's. The numbers between 0 and 1 it gets are random.
fn taught(count: u64, change: fn(&mut Conditions, [f64; 2])) -> Vec<Computed> {
    let one = |seed: u64| {
        let mut random = Pcg64Mcg::seed_from_u64(!seed);
        let uniform = Uniform::new(0.0, 1.0).unwrap();
        let usual = computed(seed);
        let (s_over_p, noise) = (usual.s_over_p, usual.noise);
        let mut conditions = Conditions { s_over_p, noise, periods: 5.0..9.0, resonance: None, after: None };
        change(&mut conditions, std::array::from_fn(|_| uniform.sample(&mut random)));
        computed_under(seed, &conditions)
    };
    (FIRST..FIRST + count).into_par_iter().map(one).collect()
}

/// Returns the least constant with which 95 % of the intervals hold the truth, among picks whose error is mostly of this cause.
///
/// Picks of two waves that one cannot tell apart, and picks that contradict each other, have a larger error by other rules.
fn fitted(records: &[Computed], cause: usize) -> f64 {
    let picks = records.par_iter().filter_map(|of| {
        let found = picks(&of.record, &of.passage, 1).ok()?;
        let is_usual = found.other_speed.is_none() && !found.contradictory;
        is_usual.then_some((found.picks, of.passage.distance / of.speed))
    });
    let picks: Vec<(Vec<Pick>, f64)> = picks.collect();
    let each = picks.iter().flat_map(|(picks, truth)| picks.iter().map(move |pick| (pick, truth)));
    let needed = each.filter_map(|(pick, truth)| {
        let of_cause = (TAUGHT[cause] * pick.causes[cause]).powi(2);
        let rest = pick.time_stddev.powi(2) - of_cause;
        let lacks = ((pick.time - truth) / OF_INTERVAL).powi(2) - rest;
        (of_cause > rest).then(|| lacks.max(0.0).sqrt() / pick.causes[cause])
    });
    let mut needed: Vec<f64> = needed.collect();
    needed.sort_by(f64::total_cmp);
    assert!(needed.len() >= 20, "{}", needed.len());
    needed[needed.len() * 19 / 20]
}

#[test]
fn records_that_end_inside_the_arrival_teach_the_error_of_an_unlike_shape() {
    let records = taught(nightly(40, 240), |of, [after, _]| of.after = Some(0.2 + 1.4 * after));
    let fitted = fitted(&records, 0);
    assert!((fitted / TAUGHT[0]).ln().abs() < 1.3f64.ln(), "{fitted}");
}

#[test]
fn transducers_that_ring_teach_the_error_of_an_onset() {
    let rings = |of: &mut Conditions, [over, quality]: [f64; 2]| {
        of.resonance = Some([0.7 + 0.8 * over, 0.5 * 12f64.powf(quality)]);
    };
    let fitted = fitted(&taught(nightly(60, 240), rings), 1);
    assert!((fitted / TAUGHT[1]).ln().abs() < 1.3f64.ln(), "{fitted}");
}

#[test]
fn short_paths_teach_the_error_of_s_after_p() {
    let short = |of: &mut Conditions, [s_over_p, _]: [f64; 2]| {
        (of.s_over_p, of.periods) = (20f64.powf(s_over_p), 1.5..4.0);
    };
    let fitted = fitted(&taught(nightly(60, 240), short), 2);
    assert!((fitted / TAUGHT[2]).ln().abs() < 1.3f64.ln(), "{fitted}");
}
