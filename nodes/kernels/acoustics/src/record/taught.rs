//! What teaches the constants of `travel_time`: computed records of known speed, other than those of the tests of stated errors.

use super::computed_records::{Computed, Conditions, computed, computed_under};
use super::travel_time::{ALIKE, OF_INTERVAL, Pick, TAUGHT, picks};
use grainlab_testkit::nightly;
use rand_distr::{Distribution, Uniform};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rayon::prelude::*;

/// First number of a record that teaches. Those of `pick_coverage`, which judges, are smaller.
const FIRST: u64 = 100_000;

/// Computes records with these numbers under the conditions that `change` makes of a usual record's, by two numbers from 0 to 1.
fn taught(numbers: impl Iterator<Item = u64>, change: fn(&mut Conditions, [f64; 2])) -> Vec<Computed> {
    let one = |number: u64| {
        let mut random = Pcg64Mcg::seed_from_u64(!number);
        let uniform = Uniform::new(0.0, 1.0).unwrap();
        let Computed { s_over_p, noise, .. } = computed(number);
        let mut conditions =
            Conditions { s_over_p, noise, periods: 5.0..9.0, resonance: None, after: None, repetition: 0 };
        change(&mut conditions, std::array::from_fn(|_| uniform.sample(&mut random)));
        computed_under(number, &conditions)
    };
    numbers.map(one).collect()
}

/// Checks that a constant is the least with which 95 % of the intervals hold the truth, among picks whose stated error is mostly of this
/// cause.
///
/// Picks of two waves that one cannot tell apart, and picks that contradict each other, have a larger error by other rules.
fn assert_fitted(records: &[Computed], cause: usize) {
    let picks = records.par_iter().filter_map(|of| {
        let found = picks(&of.record, &of.passage, 1).ok()?;
        let is_usual = found.other_speed.is_none() && !found.contradictory;
        is_usual.then_some((found.picks, of.passage.distance / of.speed))
    });
    let picks: Vec<(Vec<Pick>, f64)> = picks.collect();
    let each = picks.iter().flat_map(|(picks, truth)| picks.iter().map(move |pick| (pick, truth)));
    let needed = each.filter_map(|(pick, truth)| {
        let stated = (TAUGHT[cause] * pick.causes[cause]).powi(2);
        let rest = pick.time_stddev.powi(2) - stated;
        let lacks = ((pick.time - truth) / OF_INTERVAL).powi(2) - rest;
        (stated > rest).then(|| lacks.max(0.0).sqrt() / pick.causes[cause])
    });
    let mut needed: Vec<f64> = needed.collect();
    needed.sort_by(f64::total_cmp);
    let used = needed.len();
    assert!(used >= 10, "{used} picks");
    let fitted = needed[used * 19 / 20];
    println!("FIT {cause} {fitted} {used}");
    let ratio = fitted / TAUGHT[cause];
    // Few records determine the fit to a factor of two.
    let most = nightly(2.0, 1.25);
    assert!((1.0 / most..most).contains(&ratio), "{fitted} by {used} picks");
}

#[test]
fn records_that_end_inside_the_arrival_teach_the_error_of_an_unlike_shape() {
    let ends = |of: &mut Conditions, [after, _]: [f64; 2]| of.after = Some(0.2 + 1.4 * after);
    assert_fitted(&taught(FIRST..FIRST + nightly(40, 240), ends), 0);
}

#[test]
fn records_that_end_early_in_the_arrival_teach_the_error_of_what_is_missing() {
    let ends = |of: &mut Conditions, [after, _]: [f64; 2]| of.after = Some(0.1 + 0.5 * after);
    assert_fitted(&taught(FIRST..FIRST + nightly(40, 240), ends), 3);
}

#[test]
fn transducers_that_ring_teach_the_error_of_an_onset() {
    let rings = |of: &mut Conditions, [over, quality]: [f64; 2]| {
        of.resonance = Some([0.7 + 0.8 * over, 0.5 * 12f64.powf(quality)]);
    };
    assert_fitted(&taught(FIRST..FIRST + nightly(40, 240), rings), 1);
}

#[test]
fn short_paths_teach_the_error_of_s_after_p() {
    let short = |of: &mut Conditions, [s_over_p, _]: [f64; 2]| {
        (of.s_over_p, of.periods) = (20f64.powf(s_over_p), 1.5..4.0);
    };
    // Odd numbers are of S.
    assert_fitted(&taught((FIRST + 1..).step_by(2).take(nightly(50, 240)), short), 2);
}

#[test]
fn repeated_records_have_less_than_the_stated_share_of_the_variance_in_common() {
    const REPETITIONS: u64 = 4;
    let off = |number: u64| -> Vec<f64> {
        let one = |repetition: u64| {
            let Computed { s_over_p, noise, .. } = computed(number);
            let of =
                Conditions { s_over_p, noise, periods: 5.0..9.0, resonance: None, after: None, repetition };
            let of = computed_under(number, &of);
            let found = picks(&of.record, &of.passage, 1).ok().filter(|found| found.other_speed.is_none())?;
            let pick = found.picks[found.recommended];
            Some((pick.time - of.passage.distance / of.speed) / pick.time_stddev)
        };
        (0..REPETITIONS).filter_map(one).collect()
    };
    let all: Vec<Vec<f64>> = (FIRST..FIRST + nightly(12, 60)).into_par_iter().map(off).collect();
    let all = all.iter().filter(|of_path| of_path.len() > 1);
    let (common, variance) = all.fold((0.0, 0.0), |(common, variance), of_path| {
        let (n, sum) = (of_path.len() as f64, of_path.iter().sum::<f64>());
        let squares = of_path.iter().map(|z| z * z).sum::<f64>();
        (common + (sum * sum - squares) / (n - 1.0), variance + squares)
    });
    // Few records determine it to 0.1.
    let share = common / variance;
    assert!((0.1..=ALIKE).contains(&share), "{share}");
}
