//! Tests of picked arrivals, on synthetic traces.

use grainlab_acoustics::AcousticsError;
use grainlab_acoustics::Channel;
use grainlab_acoustics::time_of_flight::Arrivals;
use grainlab_acoustics::time_of_flight::{ArrivalPick, curve};
use grainlab_acoustics::{Instrument, Trace};
use grainlab_acoustics::{ReceiverSignals, SamplingWindow};
use grainlab_core::{Vec3, WaveMethod};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

const SPEED: f64 = 300.0;
const DIAMETER: f64 = 2e-4;
const CYCLES: f64 = 2.0;
const PICKS: [ArrivalPick; 3] = [ArrivalPick::FirstArrival, ArrivalPick::CrossCorrelation, ArrivalPick::Peak];

/// Wave number at the angular frequency `w` along a chain of grains, or along a path without dispersion.
type Law = fn(f64) -> f64;

fn chain(w: f64) -> f64 {
    2.0 / DIAMETER * (0.5 * w * DIAMETER / SPEED).min(1.0).asin()
}

fn even(w: f64) -> f64 {
    w / SPEED
}

/// A burst with a wavelength of so many diameters, 1 to 3 wavelengths from its source, as a sum of harmonics.
fn signals(law: Law, wavelength: f64) -> (f64, Vec<f64>, ReceiverSignals) {
    let frequency = SPEED / (wavelength * DIAMETER);
    let duration = CYCLES / frequency;
    let span = 16.0 / frequency;
    let burst = |t: f64| {
        let u = t / duration - 0.5;
        if u.abs() < 0.5 { (PI * u).cos().powi(2) * (TAU * CYCLES * u).sin() } else { 0.0 }
    };
    let distances: Vec<f64> = (0..5).map(|k| (1.0 + 0.5 * f64::from(k)) * SPEED / frequency).collect();
    let moments = 160 * 6;
    let interval = 1.0 / (160.0 * frequency);
    // The spectrum vanishes above four times the centre frequency.
    let lines: Vec<(f64, f64, f64)> = (1..64)
        .map(|n| {
            let w = TAU * f64::from(n) / span;
            let part = |trig: fn(f64) -> f64| {
                (0..400)
                    .map(|k| (f64::from(k) + 0.5) * duration / 400.0)
                    .map(|t| burst(t) * trig(w * t))
                    .sum::<f64>()
                    * duration
                    / 400.0
                    * 2.0
                    / span
            };
            (w, part(f64::cos), part(f64::sin))
        })
        .collect();
    let at = |d: f64, t: f64| {
        lines
            .iter()
            .map(|(w, c, s)| {
                let phase = w * t - law(*w) * d;
                c * phase.cos() + s * phase.sin()
            })
            .sum::<f64>()
    };
    let channels =
        distances.iter().map(|d| (0..moments).map(|k| at(*d, f64::from(k) * interval)).collect()).collect();
    (frequency, distances, ReceiverSignals { start: 0.0, interval, channels })
}

/// The trace that an instrument records.
fn trace(of: &(f64, Vec<f64>, ReceiverSignals), instrument: &Instrument, place: &[u64]) -> Trace {
    let (frequency, distances, signals) = of;
    let rate = instrument.rate(*frequency).unwrap();
    let before = (CYCLES * rate / frequency).ceil();
    let window =
        SamplingWindow { start: -before / rate, rate, samples: (before + 5.6 * rate / frequency) as usize };
    // A Hann window reduces the mean square of a sine, 1/2, by 3/8.
    let samples = instrument.record(signals, &window, (3.0f64 / 16.0).sqrt(), place);
    let channels = distances.iter().zip(samples).map(|(d, samples)| Channel { distance: *d, samples });
    Trace {
        direction: Vec3::z(),
        polarization: Vec3::z(),
        method: WaveMethod::Peak,
        frequency: *frequency,
        sample_rate: rate,
        start: window.start,
        channels: channels.collect(),
    }
}

#[test]
fn without_dispersion_every_pick_has_the_speed() {
    let burst = signals(even, 28.0);
    for rate in [None, Some(200.0 * burst.0), Some(9.7 * burst.0)] {
        let trace = trace(&burst, &Instrument { sample_rate: rate, ..Instrument::default() }, &[0]);
        for pick in PICKS {
            let found = Arrivals::pick(&trace, CYCLES, pick, 1).unwrap();
            let off = found.slowness * SPEED - 1.0;
            assert!(off.abs() < 1e-3, "{pick:?} at {rate:?}: {off:e}");
        }
    }
}

#[test]
fn crests_go_at_phase_speed_and_peaks_at_group_speed() {
    for wavelength in [12.0, 20.0, 40.0] {
        let burst = signals(chain, wavelength);
        let trace = trace(&burst, &Instrument::default(), &[0]);
        let w = TAU * burst.0;
        let (phase, group) = (chain(w) / w, 1.0 / (SPEED * (0.5 * chain(w) * DIAMETER).cos()));
        let found = |pick| Arrivals::pick(&trace, CYCLES, pick, 1).unwrap().slowness;
        // A short burst has a broad spectrum: its mean is more dispersed than its centre, by a quarter for
        // crests.
        let long = 1.0 / SPEED;
        for (pick, truth, slack) in
            [(ArrivalPick::CrossCorrelation, phase, 0.35), (ArrivalPick::Peak, group, 0.15)]
        {
            let off = (found(pick) - truth) / (truth - long);
            assert!(off.abs() < slack, "{pick:?} at {wavelength} D: {off}");
        }
    }
}

#[test]
fn every_pick_extrapolates_to_the_speed_of_long_waves() {
    let bursts = [20.0, 28.0, 40.0].map(|w| signals(chain, w));
    let traces: Vec<Trace> = bursts.iter().map(|b| trace(b, &Instrument::default(), &[0])).collect();
    for pick in PICKS {
        let found = curve(&traces, CYCLES, pick, DIAMETER, 1).unwrap();
        let off = found.speed / SPEED - 1.0;
        assert!(off.abs() < 1e-3 && off.abs() < 2.0 * found.stddev / SPEED, "{pick:?}: {off:e} {found:?}");
        for point in &found.points {
            let truth = 2.0 / point.wavenumber / DIAMETER * (0.5 * point.wavenumber * DIAMETER).sin();
            assert!((point.speed / SPEED - truth).abs() < 2e-3, "{pick:?} {point:?} {truth}");
        }
    }
}

#[test]
fn the_speed_is_within_two_standard_deviations_whatever_the_noise() {
    const SEEDS: u64 = 20;
    let bursts = [20.0, 28.0, 40.0].map(|w| signals(chain, w));
    for pick in PICKS {
        let mut before = f64::INFINITY;
        for decibel in [0.0, 6.0, 20.0] {
            let one = |seed: u64| {
                let instrument = Instrument { signal_to_noise: decibel, seed, ..Instrument::default() };
                let record = |(k, b): (usize, &_)| trace(b, &instrument, &[k as u64]);
                let traces: Vec<Trace> = bursts.iter().enumerate().map(record).collect();
                match curve(&traces, CYCLES, pick, DIAMETER, seed) {
                    Ok(c) => Some(((c.speed - SPEED) / c.stddev, c.stddev / SPEED)),
                    Err(AcousticsError::NoSignal { .. }) => None,
                    Err(other) => panic!("{other}"),
                }
            };
            let all: Vec<_> = (1..=SEEDS).into_par_iter().map(one).collect();
            let mut found: Vec<_> = all.into_iter().flatten().collect();
            let inside = found.iter().filter(|(off, _)| off.abs() <= 2.0).count();
            found.sort_by(|a, b| a.1.total_cmp(&b.1));
            assert!(inside * 10 >= found.len() * 9, "{pick:?} at {decibel} dB: {inside} of {}", found.len());
            if let Some((_, median)) = found.get(found.len() / 2) {
                assert!(*median < 0.7 * before, "{pick:?} at {decibel} dB: {median} after {before}");
                before = *median;
            }
        }
        let most = match pick {
            ArrivalPick::CrossCorrelation => 0.003,
            ArrivalPick::Peak => 0.01,
            ArrivalPick::FirstArrival => 0.03,
        };
        assert!(before < most, "{pick:?} at 20 dB: {before}");
    }
}

#[test]
fn noise_alone_is_no_arrival() {
    let burst = signals(even, 28.0);
    for seed in 0..20 {
        let instrument = Instrument { signal_to_noise: -40.0, seed, ..Instrument::default() };
        let trace = trace(&burst, &instrument, &[0]);
        for pick in PICKS {
            let found = Arrivals::pick(&trace, CYCLES, pick, 1);
            assert!(matches!(found, Err(AcousticsError::NoSignal { .. })), "{pick:?} {seed} {found:?}");
        }
    }
}

#[test]
fn traces_that_cannot_be_picked_are_refused_by_name() {
    let good = trace(&signals(even, 28.0), &Instrument::default(), &[0]);
    let refused = |name: &str, trace: &Trace, cycles: f64| {
        let found = Arrivals::pick(trace, cycles, ArrivalPick::Peak, 1);
        assert!(
            matches!(found, Err(AcousticsError::Setting { name: n, .. }) if n == name),
            "{name} {found:?}"
        );
    };
    refused("cycles", &good, f64::NAN);
    refused("frequency", &Trace { frequency: 0.0, ..good.clone() }, CYCLES);
    refused("sample_rate", &Trace { sample_rate: f64::NAN, ..good.clone() }, CYCLES);
    refused("receivers", &Trace { channels: good.channels[..1].to_vec(), ..good.clone() }, CYCLES);
    let mut bad = good.clone();
    bad.channels[1].samples[7] = f64::NAN;
    refused("samples", &bad, CYCLES);
    let mut bad = good.clone();
    bad.channels[1].samples.pop();
    refused("samples", &bad, CYCLES);
}
