//! Fits of the constants of `travel_time` by computed records of known speed. No test of stated errors has these records.

use super::computed_records::{Computed, Conditions, computed, usual};
use super::pick::{COMMON_VARIANCE_SHARE, Pick};
use super::travel_time::{SIGMAS_OF_INTERVAL, TAUGHT, picks};
use grainlab_testkit::nightly;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rayon::prelude::*;

/// First number of a record that teaches. The records of `pick_coverage`, which judge, have smaller numbers.
const FIRST: u64 = 100_000;

/// Share of the intervals that hold the truth.
const INSIDE: f64 = 0.95;

/// Changes conditions by two random numbers from 0 to 1.
type Change = fn(&mut Conditions, [f64; 2]);

fn changed(number: u64, change: Change) -> Conditions {
    let mut random = Pcg64Mcg::seed_from_u64(!number);
    let uniform = Uniform::new(0.0, 1.0).unwrap();
    let mut conditions = usual(number);
    change(&mut conditions, std::array::from_fn(|_| uniform.sample(&mut random)));
    conditions
}

/// Checks that 95 % of the intervals hold the truth, among picks whose stated error is mostly of this cause.
///
/// Picks of two waves that one cannot tell apart, and picks that contradict each other, have a larger error by other rules.
fn assert_fitted(numbers: impl Iterator<Item = u64>, change: Change, cause: usize) {
    let numbers: Vec<u64> = numbers.collect();
    let one = |number: u64| {
        let Computed { record, passage, speed } = computed(number, &changed(number, change));
        let found = picks(&record, &passage, 1).ok()?;
        let is_usual = found.other_speed.is_none() && !found.contradictory;
        is_usual.then_some((found.picks, passage.distance / speed))
    };
    let picks: Vec<(Vec<Pick>, f64)> = numbers.into_par_iter().filter_map(one).collect();
    let each = picks.iter().flat_map(|(picks, truth)| picks.iter().map(move |pick| (pick, truth)));
    // The least constant with which the interval of each pick holds the truth.
    let needed = each.filter_map(|(pick, truth)| {
        let stated = (TAUGHT[cause] * pick.causes[cause]).powi(2);
        let rest = pick.time_stddev.powi(2) - stated;
        let lacks = ((pick.time - truth) / SIGMAS_OF_INTERVAL).powi(2) - rest;
        (stated > rest).then(|| lacks.max(0.0).sqrt() / pick.causes[cause])
    });
    let mut needed: Vec<f64> = needed.collect();
    needed.sort_by(f64::total_cmp);
    let count = needed.len() as f64;
    assert!(count >= 10.0, "{count} picks");
    let fitted = needed[(INSIDE * count) as usize];
    let inside = needed.iter().filter(|least| **least <= TAUGHT[cause]).count() as f64 / count;
    // Few records determine the share to two standard errors, and do not determine the constant.
    let least = INSIDE - 2.0 * (INSIDE * (1.0 - INSIDE) / count).sqrt();
    let is_fitted = nightly(inside >= least, (0.8..1.25).contains(&(fitted / TAUGHT[cause])));
    assert!(is_fitted, "{count} picks give {fitted}; {inside} of them are inside with {}", TAUGHT[cause]);
}

#[test]
fn records_that_end_inside_the_arrival_teach_the_error_of_an_unlike_shape() {
    let ends = |of: &mut Conditions, [after, _]: [f64; 2]| of.after = Some(0.2 + 1.4 * after);
    assert_fitted(FIRST..FIRST + nightly(40, 240), ends, 0);
}

#[test]
fn records_that_end_early_in_the_arrival_teach_the_error_of_what_is_missing() {
    let ends = |of: &mut Conditions, [after, _]: [f64; 2]| of.after = Some(0.1 + 0.5 * after);
    assert_fitted(FIRST..FIRST + nightly(40, 240), ends, 3);
}

/// Makes the receiver ring near the frequency of the source.
fn rings(of: &mut Conditions, [over, quality]: [f64; 2]) {
    of.resonance = Some([0.7 + 0.8 * over, 0.5 * 12f64.powf(quality)]);
}

#[test]
fn transducers_that_ring_teach_the_error_of_an_onset() {
    assert_fitted(FIRST..FIRST + nightly(40, 240), rings, 1);
}

#[test]
fn short_paths_teach_the_error_of_s_after_p() {
    let short = |of: &mut Conditions, [s_over_p, _]: [f64; 2]| {
        (of.s_over_p, of.periods) = (20f64.powf(s_over_p), 1.5..4.0);
    };
    // Odd numbers are of S.
    assert_fitted((FIRST + 1..).step_by(2).take(nightly(50, 240)), short, 2);
}

/// Returns the share of the variance of the time that records of one path have in common after `change`.
fn in_common(change: Change) -> f64 {
    const REPETITIONS: u64 = 3;
    let off = |number: u64| -> Vec<f64> {
        let one = |repetition: u64| {
            let conditions = Conditions { repetition, ..changed(number, change) };
            let Computed { record, passage, speed } = computed(number, &conditions);
            let found = picks(&record, &passage, 1).ok().filter(|found| found.other_speed.is_none())?;
            let pick = found.picks[found.recommended];
            Some((pick.time - passage.distance / speed) / pick.time_stddev)
        };
        (0..REPETITIONS).filter_map(one).collect()
    };
    let all: Vec<Vec<f64>> = (FIRST..FIRST + nightly(8, 60)).into_par_iter().map(off).collect();
    let all = all.iter().filter(|of_path| of_path.len() > 1);
    let (common, variance) = all.fold((0.0, 0.0), |(common, variance), of_path| {
        let (n, sum) = (of_path.len() as f64, of_path.iter().sum::<f64>());
        let squares = of_path.iter().map(|z| z * z).sum::<f64>();
        (common + (sum * sum - squares) / (n - 1.0), variance + squares)
    });
    common / variance
}

#[test]
fn records_of_one_path_have_less_in_common_than_is_stated_and_more_if_the_transducers_ring() {
    let [usual, ringing] = [in_common(|_, _| ()), in_common(rings)];
    assert!(usual < COMMON_VARIANCE_SHARE && COMMON_VARIANCE_SHARE < ringing, "{usual}, {ringing}");
}
