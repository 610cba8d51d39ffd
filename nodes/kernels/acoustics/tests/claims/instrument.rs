//! Tests of the instrument.

use grainlab_acoustics::AcousticsError;
use grainlab_acoustics::Instrument;
use grainlab_acoustics::{ReceiverSignals, SamplingWindow};
use std::f64::consts::TAU;

const FREQUENCY: f64 = 1e5;

/// A sine that starts at the trigger, 200 samples per period, at two receivers.
fn sine() -> ReceiverSignals {
    let interval = 1.0 / (200.0 * FREQUENCY);
    let tone = |phase: f64| {
        (0..8000).map(|k| (TAU * FREQUENCY * k as f64 * interval + phase).sin()).collect::<Vec<_>>()
    };
    ReceiverSignals { start: 0.0, interval, channels: vec![tone(0.0), tone(1.0)] }
}

fn window() -> SamplingWindow {
    SamplingWindow { start: -10.0 / (33.0 * FREQUENCY), rate: 33.0 * FREQUENCY, samples: 1000 }
}

fn rms(of: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = of.fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
    f64::sqrt(sum / n)
}

#[test]
fn without_noise_the_record_is_the_signal() {
    let samples = Instrument::default().record(&sine(), &window(), 1.0, &[0]);
    for (channel, phase) in samples.iter().zip([0.0, 1.0]) {
        for (k, sample) in channel.iter().enumerate() {
            let time = window().start + k as f64 / window().rate;
            let truth = if time < 0.0 { 0.0 } else { (TAU * FREQUENCY * time + phase).sin() };
            assert!(
                (sample - truth).abs() < 1e-5 || time.abs() < 1.0 / (100.0 * FREQUENCY),
                "{k} {sample} {truth}"
            );
        }
    }
}

#[test]
fn noise_has_the_stated_level_and_shots_average_it() {
    let quiet = Instrument::default().record(&sine(), &window(), 0.5, &[3]);
    for (decibel, shots) in [(0.0, 1), (20.0, 1), (20.0, 16), (-20.0, 4)] {
        let instrument = Instrument { signal_to_noise: decibel, shots, ..Instrument::default() };
        let noisy = instrument.record(&sine(), &window(), 0.5, &[3]);
        let off = rms(noisy.iter().flatten().zip(quiet.iter().flatten()).map(|(a, b)| a - b));
        let stated = 0.5 * 10f64.powf(-decibel / 20.0) / f64::from(shots).sqrt();
        // 2,000 samples determine the level to 1.6 %.
        assert!((off / stated - 1.0).abs() < 0.06, "{decibel} dB, {shots} shots: {off} for {stated}");
    }
}

#[test]
fn jitter_attenuates_an_average_like_a_gaussian() {
    let jitter = 0.15 / FREQUENCY;
    let instrument = Instrument { jitter, shots: 2000, ..Instrument::default() };
    let samples = instrument.record(&sine(), &window(), 1.0, &[0]);
    // Away from the trigger, where the jitter also truncates the signal.
    let level = |s: &[f64]| rms(s[200..860].iter().copied());
    let quiet = Instrument::default().record(&sine(), &window(), 1.0, &[0]);
    let expected = (-0.5 * (TAU * FREQUENCY * jitter).powi(2)).exp();
    let found = level(&samples[0]) / level(&quiet[0]);
    assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
}

#[test]
fn noise_is_that_of_seed_and_place() {
    let record = |seed, place: &[u64]| {
        let instrument =
            Instrument { signal_to_noise: 10.0, jitter: 1e-7, shots: 3, seed, ..Instrument::default() };
        instrument.record(&sine(), &window(), 1.0, place)
    };
    let first = record(1, &[0, 1, 2]);
    let others = [record(2, &[0, 1, 2]), record(1, &[0, 2, 1]), record(1, &[1, 1, 2])];
    assert_eq!(first, record(1, &[0, 1, 2]));
    for other in &others {
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        // Before the trigger there is only noise, and it differs between receivers.
        let (a, b) = (&first[0][..8], &other[0][..8]);
        assert!(product(a, b).abs() < 0.95 * (product(a, a) * product(b, b)).sqrt());
        assert_ne!(&first, other);
    }
}

#[test]
fn an_instrument_out_of_range_is_refused_by_name() {
    let good = Instrument::default();
    for (name, instrument) in [
        ("sample_rate", Instrument { sample_rate: Some(f64::NAN), ..good }),
        ("sample_rate", Instrument { sample_rate: Some(0.0), ..good }),
        ("sample_rate", Instrument { sample_rate: Some(f64::INFINITY), ..good }),
        ("signal_to_noise", Instrument { signal_to_noise: f64::NAN, ..good }),
        ("signal_to_noise", Instrument { signal_to_noise: f64::NEG_INFINITY, ..good }),
        ("jitter", Instrument { jitter: -1e-9, ..good }),
        ("jitter", Instrument { jitter: f64::NAN, ..good }),
        ("shots", Instrument { shots: 0, ..good }),
        ("speed_noise", Instrument { speed_noise: f64::NAN, ..good }),
        ("speed_noise", Instrument { speed_noise: -0.1, ..good }),
    ] {
        let found = instrument.validated();
        assert!(
            matches!(found, Err(AcousticsError::Setting { name: n, .. }) if n == name),
            "{name} {found:?}"
        );
    }
    assert!(good.validated().is_ok());
}

#[test]
fn waves_too_fast_for_the_sampling_are_refused() {
    let slow = Instrument { sample_rate: Some(5.0 * FREQUENCY), ..Instrument::default() };
    assert!(matches!(slow.rate(FREQUENCY), Err(AcousticsError::Setting { name: "sample_rate", .. })));
    assert_eq!(slow.rate(0.5 * FREQUENCY), Ok(5.0 * FREQUENCY));
}
