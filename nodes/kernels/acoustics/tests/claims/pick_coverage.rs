//! Tests of picks on computed records with P, S and a later wave; `examples/pick_coverage.rs` takes more of the same records.

use crate::computed_records::{Computed, Conditions, computed, has_later, usual};
use grainlab_acoustics::record::{Pick, picks};
use grainlab_testkit::nightly;
use rayon::prelude::*;

fn picked(of: &Computed) -> Option<Pick> {
    picks(&of.record, &of.passage, 1).ok().map(|found| found.picks[found.recommended])
}

/// Computes the record of number `seed` with this ratio of S to P, and this noise over the peak of the wave of the mode.
fn computed_with(seed: u64, s_over_p: f64, noise: f64) -> Computed {
    computed(seed, &Conditions { s_over_p, noise, ..usual(seed) })
}

#[test]
fn p_is_the_first_wave_that_stands_out_of_the_noise_however_large_the_waves_after_it_are() {
    let all = [(0, 10.0), (2, 40.0), (4, 100.0), (6, 300.0), (8, 300.0)];
    for (seed, s_over_p) in all.into_iter().step_by(nightly(2, 1)) {
        let of = computed_with(seed, s_over_p, 0.03);
        let p = picked(&of).unwrap();
        let name = format!("{seed}, S/P {s_over_p}: {p:?} of {}", of.speed);
        assert!((p.speed - of.speed).abs() < (3.0 * p.speed_stddev).min(0.05 * of.speed), "{name}");
        assert!(p.bias.abs() < 0.5 * p.time / 5.0, "no bias is a period: {name}");
    }
}

#[test]
fn s_is_not_a_larger_wave_that_follows_it_too_soon_for_its_p() {
    for seed in [1, 5, 9, 13].into_iter().step_by(nightly(2, 1)) {
        // P is 10 times the noise.
        let of = computed_with(seed, 10.0, 0.01);
        assert!(has_later(seed));
        let p = picked(&of).unwrap();
        assert!((p.speed / of.speed - 1.0).abs() < 0.05, "{seed}: {p:?} of {}", of.speed);
    }
}

#[test]
fn waves_of_8_times_the_noise_have_answers_whose_stated_errors_hold() {
    let one = |seed: u64| {
        let usual = usual(seed);
        let of = computed(seed, &usual);
        (seed, usual.noise, of.speed, picked(&of))
    };
    let all: Vec<_> = (0..nightly(16, 24)).into_par_iter().map(one).collect();
    for (seed, noise, speed, found) in &all {
        assert!(found.is_some() || *noise > 0.125, "{seed} has no answer");
        let Some(p) = found else { continue };
        assert!((p.speed - speed).abs() < 3.0 * p.speed_stddev, "{seed}: {p:?} of {speed}");
    }
    let answers: Vec<_> = all.iter().filter_map(|(_, _, speed, found)| found.map(|p| (speed, p))).collect();
    let inside =
        answers.iter().filter(|(speed, p)| (p.speed - **speed).abs() < 1.96 * p.speed_stddev).count();
    assert!(inside as f64 >= 0.93 * answers.len() as f64, "{inside} of {}", answers.len());
    for (is_quiet, most) in [(true, 0.03), (false, 0.1)] {
        let of_noise = all.iter().filter(|(_, noise, ..)| (*noise < 0.03) == is_quiet);
        let mut stated: Vec<f64> =
            of_noise.filter_map(|(.., p)| p.map(|p| p.speed_stddev / p.speed)).collect();
        stated.sort_by(f64::total_cmp);
        assert!(stated[stated.len() / 2] < most, "{is_quiet}: {stated:?}");
    }
}
