//! Tests of travel times from the records of a source and a receiver, on synthetic records.

use grainlab_acoustics::AcousticsError;
use grainlab_acoustics::record::{Passage, Picks, Record, picks};
use grainlab_testkit::nightly;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::SeedableRng;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

const SPEED: f64 = 300.0;
const DISTANCE: f64 = 0.1;
const FREQUENCY: f64 = 10e3;
const RATE: f64 = 1e6;
const QUIET: usize = 200;
const SAMPLES: usize = 1200;

/// A sine of two periods under a Hann window, `late` seconds after the source starts.
fn burst(sample: usize, late: f64) -> f64 {
    let u = ((sample as f64 - QUIET as f64) / RATE - late) * FREQUENCY / 2.0 - 0.5;
    if u.abs() < 0.5 { (PI * u).cos().powi(2) * (2.0 * TAU * u).sin() } else { 0.0 }
}

fn passage() -> Passage {
    Passage {
        distance: DISTANCE,
        distance_stddev: 0.0,
        delay: 2e-6,
        delay_stddev: 0.0,
        lowpass: None,
        highpass: None,
        filter_order: 1,
        reversed: None,
        // 300 grains per wavelength: no dispersion.
        diameter: 1e-4,
        longitudinal: Some(true),
    }
}

/// The records of a path without dispersion and near field, with noise and what `change` makes of a sample of the receiver and the source.
fn recorded(noise: f64, seed: u64, change: impl Fn(f64, f64) -> f64) -> Record {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let source: Vec<f64> = (0..SAMPLES).map(|k| 5.0 * burst(k, 0.0)).collect();
    let mut one = |k: usize| {
        let random: f64 = StandardNormal.sample(&mut random);
        change(burst(k, DISTANCE / SPEED + 2e-6) + noise * random, source[k])
    };
    let receiver = (0..SAMPLES).map(&mut one).collect();
    Record { sample_rate: RATE, quiet: 0..QUIET, source, receiver }
}

fn best(found: &Picks) -> (f64, f64) {
    let pick = found.picks[found.recommended];
    (pick.speed, pick.speed_stddev)
}

#[test]
fn the_speed_is_found_within_its_error_whatever_the_amplifier_does() {
    type Change = fn(f64, f64) -> f64;
    let changes: [(&str, Change); 5] = [
        ("plain", |r, _| 1e-3 * r),
        ("offset", |r, _| r + 3.0),
        ("reversed", |r, _| -r),
        ("crosstalk", |r, s| r + 0.1 * s),
        ("cut", |r, _| r.clamp(-0.5, 0.5)),
    ];
    for (name, change) in changes {
        for noise in [0.003, 0.05, 0.2] {
            let found = picks(&recorded(noise, 7, change), &passage(), 1).unwrap();
            let (speed, stddev) = best(&found);
            assert!((speed - SPEED).abs() < 3.0 * stddev, "{name}, {noise}: {speed} +- {stddev}");
            assert!(stddev < if name == "cut" { 0.1 } else { 0.05 } * SPEED, "{name}, {noise}: {stddev}");
            let flags = (found.reversed, found.is_cut);
            assert_eq!(flags, (name == "reversed", name == "cut"), "{name}, {noise}");
            assert!(name != "crosstalk" || (found.crosstalk - 0.5).abs() < 0.1, "{}", found.crosstalk);
        }
    }
}

#[test]
fn noise_does_not_make_the_error_of_a_speed_smaller() {
    // A path that takes high frequencies.
    let lost = |noise| {
        let mut record = recorded(noise, 3, |r, _| r);
        let mut state = 0.0;
        record.receiver.iter_mut().for_each(|r| {
            state += 0.2 * (*r - state);
            *r = state;
        });
        picks(&record, &passage(), 1).map(|found| best(&found).1).unwrap()
    };
    let [clean, noisy] = [0.002, 0.05].map(lost);
    assert!(noisy > 0.8 * clean, "{clean} {noisy}");
}

#[test]
fn a_record_that_ends_inside_the_arrival_has_an_error_that_covers_what_is_missing() {
    let arrival = QUIET + ((DISTANCE / SPEED + 2e-6) * RATE) as usize;
    for after in [60, 80, 100, 130, 160] {
        let mut record = recorded(0.02, after as u64, |r, _| r);
        record.source.truncate(arrival + after);
        record.receiver.truncate(arrival + after);
        let Ok(found) = picks(&record, &passage(), 1) else { continue };
        let (speed, stddev) = best(&found);
        assert!((speed - SPEED).abs() < 2.0 * stddev, "{after}: {speed} +- {stddev}");
        assert!(found.slowest > speed, "the wave is not whole");
    }
}

#[test]
fn a_larger_wave_after_the_first_strong_one_is_taken_as_s_and_the_error_covers_both() {
    let [first, distance] = [500.0, 0.2];
    for lobe in nightly(&[0.4, 0.5, 0.8][..], &[0.4, 0.45, 0.5, 0.6, 0.7, 0.8]).iter().copied() {
        for (reversed, longitudinal) in [(None, Some(false)), (Some(false), Some(false)), (None, None)] {
            let mut record = recorded(0.003, 7, |r, _| r);
            for (k, r) in record.receiver.iter_mut().enumerate() {
                let wave = |speed: f64| burst(k, distance / speed + 2e-6);
                *r += lobe * wave(first) + wave(SPEED) - burst(k, DISTANCE / SPEED + 2e-6);
            }
            let found =
                picks(&record, &Passage { distance, reversed, longitudinal, ..passage() }, 1).unwrap();
            let (speed, stddev) = best(&found);
            let name = format!(
                "{lobe}, {reversed:?}, {longitudinal:?}: {speed} +- {stddev}, {:?}",
                found.other_speed
            );
            assert!((speed - SPEED).abs() < 1.97 * stddev, "{name}");
            // A lobe at the threshold may be taken as near field, whose error is smaller.
            let Some(other) = found.other_speed else {
                assert!(lobe <= 0.4, "{name}");
                continue;
            };
            let [taken, left] = if longitudinal.is_some() { [SPEED, first] } else { [first, SPEED] };
            assert!((speed / taken - 1.0).abs() < 0.05 && (other / left - 1.0).abs() < 0.05, "{name}");
            assert!((speed - first).abs() < 2.1 * stddev, "{name}");
            assert!((found.slowest / (distance / 0.8e-3) - 1.0).abs() < 0.1, "{}", found.slowest);
        }
    }
}

/// A record of two waves that ring, the first of the height `ratio`, 8 periods after the source, and one of height 1 `delay` periods later.
fn overlapping(ratio: f64, delay: f64, seed: u64) -> Record {
    const PERIOD: f64 = 40.0;
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let phase = |k: usize, late: f64| (k as f64 - QUIET as f64) / PERIOD - late;
    let sent = |k: usize| if (0.0..1.0).contains(&phase(k, 0.0)) { (TAU * phase(k, 0.0)).sin() } else { 0.0 };
    let rings = |x: f64| if x > 0.0 { (TAU * x).sin() * (-x / 1.5).exp() } else { 0.0 };
    let receiver = |k: usize| {
        let noise: f64 = StandardNormal.sample(&mut random);
        ratio * rings(phase(k, 8.0)) + rings(phase(k, 8.0 + delay)) + 0.005 * noise
    };
    Record {
        sample_rate: RATE,
        quiet: 0..QUIET,
        source: (0..SAMPLES).map(sent).collect(),
        receiver: (0..SAMPLES).map(receiver).collect(),
    }
}

#[test]
fn p_is_the_first_of_two_waves_however_soon_a_larger_one_follows_it() {
    // 8 periods of 40 samples.
    let distance = SPEED * 320.0 / RATE;
    let all = [0.2, 0.5, 1.0].into_iter().flat_map(|ratio| [1.0, 1.5, 3.0].map(|delay| (ratio, delay)));
    for (ratio, delay) in all.step_by(nightly(4, 1)) {
        let record = overlapping(ratio, delay, 1);
        let found = picks(&record, &Passage { distance, delay: 0.0, ..passage() }, 1).unwrap();
        let (speed, stddev) = best(&found);
        let name = format!("{ratio}, {delay}: {speed} +- {stddev}");
        assert!((speed - SPEED).abs() < (3.0 * stddev).min(0.06 * SPEED), "{name}");
        assert!(stddev < 0.05 * SPEED && found.other_speed.is_none(), "{name}");
    }
}

#[test]
fn the_error_of_a_wave_without_losses_contains_those_of_sampling_and_rounding() {
    for per_period in nightly(&[4.6, 8.2][..], &[4.6, 5.1, 6.3, 8.2, 12.4]).iter().copied() {
        for bits in [6, 8, 12] {
            for start in [0.0, 0.4, 0.7] {
                let late = 8.0 * per_period + start;
                let ricker = |k: usize, late: f64| {
                    let a = (PI * ((k as f64 - 4.0 * per_period - start - late) / per_period - 1.1)).powi(2);
                    ((1.0 - 2.0 * a) * (-a).exp() * f64::from(1 << (bits - 1))).round()
                };
                let samples = (18.0 * per_period) as usize;
                let rate = 1e5 * per_period;
                let record = Record {
                    sample_rate: rate,
                    quiet: 0..(3.5 * per_period) as usize,
                    source: (0..samples).map(|k| ricker(k, 0.0)).collect(),
                    receiver: (0..samples).map(|k| ricker(k, late)).collect(),
                };
                let distance = SPEED * late / rate;
                let path = Passage { distance, delay: 0.0, diameter: distance / 1600.0, ..passage() };
                let (speed, stddev) = best(&picks(&record, &path, 1).unwrap());
                let name = format!("{per_period} samples, {bits} bits, {start}: {speed} +- {stddev}");
                assert!((speed - SPEED).abs() < 3.0 * stddev && stddev < 0.03 * SPEED, "{name}");
            }
        }
    }
}

#[test]
fn a_tone_that_is_added_does_not_make_the_error_smaller() {
    for over in nightly(&[0.2, 4.0][..], &[0.2, 1.0, 4.0, 20.0]).iter().copied() {
        let tone = |height: f64| {
            let mut record = recorded(0.01, 3, |r, _| r);
            for (k, r) in record.receiver.iter_mut().enumerate() {
                *r += height * (TAU * over * FREQUENCY * k as f64 / RATE + 1.0).sin();
            }
            picks(&record, &passage(), 1).map(|found| best(&found)).unwrap()
        };
        let [clean, low, high] = [0.0, 0.05, 0.2].map(tone);
        for (speed, stddev) in [low, high] {
            assert!(stddev > 0.95 * clean.1, "{over}: {stddev} of {clean:?}");
            assert!((speed - SPEED).abs() < 3.0 * stddev, "{over}: {speed} +- {stddev}");
        }
    }
}

#[test]
fn a_record_without_an_arrival_is_refused() {
    for seed in 0..20 {
        for change in [|_: f64, _: f64| 0.0, |_: f64, s: f64| 0.1 * s] {
            let mut noise = Pcg64Mcg::seed_from_u64(seed);
            let mut record = recorded(0.0, seed, change);
            record.receiver.iter_mut().for_each(|r| {
                let random: f64 = StandardNormal.sample(&mut noise);
                *r += 0.01 * random;
            });
            let found = picks(&record, &passage(), 1);
            assert!(
                matches!(found, Err(AcousticsError::NoArrival(_))),
                "{seed}: {:?}",
                found.map(|f| f.picks)
            );
        }
    }
}

#[test]
fn a_longer_distance_error_or_delay_error_is_in_the_error_of_the_speed() {
    let record = recorded(0.01, 3, |r, _| r);
    let of = |change: fn(&mut Passage)| {
        let mut passage = passage();
        change(&mut passage);
        best(&picks(&record, &passage, 1).unwrap()).1 / SPEED
    };
    let plain = of(|_| ());
    assert!((of(|p| p.distance_stddev = 0.02 * DISTANCE) - 0.02f64.hypot(plain)).abs() < 1e-3);
    assert!((of(|p| p.delay_stddev = 10e-6) - (10e-6 * SPEED / DISTANCE).hypot(plain)).abs() < 1e-3);
}

#[test]
fn errors_of_distance_and_delay_are_common_to_the_records_of_a_path() {
    let record = recorded(0.05, 3, |r, _| r);
    let passage = Passage { distance_stddev: 0.02 * DISTANCE, delay_stddev: 5e-6, ..passage() };
    let found = picks(&record, &passage, 1).unwrap();
    let pick = found.picks[found.recommended];
    let (own, common) = (pick.speed_own_stddev(), pick.speed_common_stddev);
    assert!(common > 0.02f64.hypot(5e-6 / pick.time) * pick.speed, "{pick:?}");
    assert!(own < pick.time_stddev / pick.time * pick.speed && own > 0.0, "{pick:?}");
    assert!((own.hypot(common) / pick.speed_stddev - 1.0).abs() < 1e-9, "{pick:?}");
}

#[test]
fn a_delay_beyond_the_record_and_too_few_samples_are_named_in_plain_words() {
    let fault = |record: &Record, passage: &Passage| picks(record, passage, 1).unwrap_err().to_string();
    let record = recorded(0.01, 3, |r, _| r);
    let late = fault(&record, &Passage { delay: 4.3, ..passage() });
    assert!(late.contains("the delay, 4.3 s, is longer than the record, 1.200e-3 s"), "{late}");
    let each = |of: &[f64]| of.iter().copied().step_by(30).collect();
    let few = Record {
        sample_rate: RATE / 30.0,
        quiet: 0..QUIET / 30 + 2,
        source: each(&[&[0.0; 300][..], &record.source].concat()),
        receiver: each(&[&[0.0; 300][..], &record.receiver].concat()),
    };
    let few = fault(&few, &passage());
    assert!(few.contains("a period of the source has") && few.contains("sample faster"), "{few}");
}

#[test]
fn filters_of_the_receiver_that_are_given_do_not_delay_the_wave() {
    let mut record = recorded(0.003, 5, |r, _| r);
    // One pole each at 8 kHz, by the differential equations.
    let (rate, mut low, mut slow) = (TAU * 8e3 / RATE, 0.0, 0.0);
    for r in &mut record.receiver {
        low += rate * (*r - low);
        slow += rate * (low - slow);
        *r = low - slow;
    }
    let with = |edge: Option<f64>| {
        picks(&record, &Passage { lowpass: edge, highpass: edge, ..passage() }, 1).unwrap()
    };
    let error = |found: &Picks| best(found).0 / SPEED - 1.0;
    assert!(error(&with(Some(8e3))).abs() < 0.01, "{}", error(&with(Some(8e3))));
    let high = Passage { highpass: Some(8e3), ..passage() };
    let late = error(&picks(&record, &high, 1).unwrap());
    assert!(late.abs() > 0.01, "{late}");
}

/// One record of `tests/golden/waves`, with the true speed.
struct Golden {
    speed: f64,
    record: Record,
    passage: Passage,
}

/// The records of waves in 20 packings, with the burst that the source sent.
fn golden() -> Vec<Golden> {
    let text = grainlab_testkit::golden::text("waves/traces.csv.gz");
    let one = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [speed, diameter, frequency, rate, start, distance] =
            std::array::from_fn(|k| cells[k + 2].parse::<f64>().unwrap());
        let receiver: Vec<f64> = cells[8].split(' ').map(|s| s.parse::<f64>().unwrap() / 1e4).collect();
        let burst = |k: usize| {
            let u = (start + k as f64 / rate) * frequency / 2.0 - 0.5;
            if u.abs() < 0.5 { (PI * u).cos().powi(2) * (2.0 * TAU * u).sin() } else { 0.0 }
        };
        let source = (0..receiver.len()).map(burst).collect();
        let longitudinal = Some(cells[1] == "p");
        let passage =
            Passage { distance, delay: 0.0, diameter, longitudinal, reversed: Some(false), ..passage() };
        let quiet = 0..(-start * rate) as usize;
        Golden { speed, record: Record { sample_rate: rate, quiet, source, receiver }, passage }
    };
    text.lines().skip(1).map(one).collect()
}

/// The wave between the arrivals of P and S that a point source adds to S (Aki and Richards, eq. 4.23).
fn near_field(of: &Golden, k: usize) -> f64 {
    let time = of.passage.distance / of.speed * of.record.sample_rate;
    let (from, width) = (time / 1.6, time * (1.0 - 1.0 / 1.6) / 60.0);
    let part = |i: usize| {
        let tau = from + (i as f64 + 0.5) * width;
        k.checked_sub(tau as usize).map_or(0.0, |k| tau * width * of.record.source[k])
    };
    (0..60).map(part).sum::<f64>() / time.powi(2)
}

#[test]
fn stated_errors_hold_for_waves_in_packings_with_noise_near_field_crosstalk_and_an_amplifier() {
    let pick = |n: usize, case: usize, of: &Golden| {
        let Golden { speed, record, passage } = of;
        let (mut record, mut passage) = (record.clone(), *passage);
        let mut random = Pcg64Mcg::seed_from_u64((8 * n + case) as u64);
        let (noise, source) = ([0.002, 0.05, 0.2, 0.02, 0.02, 0.02, 0.02][case], record.source.clone());
        for (k, r) in record.receiver.iter_mut().enumerate() {
            let gauss: f64 = StandardNormal.sample(&mut random);
            *r += noise * gauss;
            match case {
                3 => *r += 0.5 * source[k],
                4 => *r = 0.3 - *r,
                5 => *r = r.clamp(-0.5, 0.5),
                6 if passage.longitudinal == Some(false) => *r -= near_field(of, k),
                _ => {}
            }
        }
        passage.reversed = passage.reversed.filter(|_| case != 4);
        let found = picks(&record, &passage, 1).unwrap();
        let (picked, stddev) = best(&found);
        (((picked - speed) / stddev).abs() < 1.96, found.contradictory)
    };
    let golden = golden();
    // 800 records determine the share to .008, a sixth of them to .02.
    let (every, [low, high]) = nightly((6, [0.89, 1.0]), (1, [0.925, 0.975]));
    let all: Vec<(usize, &Golden)> = golden.iter().enumerate().step_by(every).collect();
    let all: Vec<(bool, bool)> = all.par_iter().map(|(n, of)| pick(*n, n % 7, of)).collect();
    let inside = all.iter().filter(|(inside, _)| *inside).count() as f64 / all.len() as f64;
    assert!((low..=high).contains(&inside), "{inside} of {}", all.len());
    // Nothing is wrong with these records.
    let contradictory = all.iter().filter(|(_, is_contradictory)| *is_contradictory).count();
    assert!(contradictory * 100 <= all.len(), "{contradictory} of {}", all.len());
}
