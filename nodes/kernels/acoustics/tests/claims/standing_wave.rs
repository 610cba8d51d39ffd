//! Standing waves give the stiffness.

use crate::sample;
use grainlab_acoustics::standing_wave::{Settings, curves};
use grainlab_acoustics::{AcousticsError, DispersionCurve, Instrument, Ray, Warning};
use grainlab_core::{Packing, Vec3, WaveMethod};
use std::f64::consts::TAU;

/// `motions` (0: P, 1 and 2: S) along the normal of lattice planes.
fn ray(packing: &Packing, indices: [i32; 3], polarizations: &[usize]) -> Ray {
    let direction = Ray::normal(&packing.cell, indices).unwrap();
    let all = Ray::polarizations_about(&direction, &Vec3::z());
    Ray { direction, indices: Some(indices), polarizations: polarizations.iter().map(|m| all[*m]).collect() }
}

/// Settings for a short run.
const QUICK: Settings = Settings {
    copies: 6,
    periods: 2.0,
    amplitude: 1e-9,
    friction: None,
    tangential: grainlab_core::contact::TangentialLaw::Incremental,
};

fn quick(packing: &Packing, polarization: usize, settings: &Settings) -> (DispersionCurve, Vec<Warning>) {
    let rays = [ray(packing, [0, 0, 1], &[polarization])];
    let (curves, _, warnings) = curves(packing, &rays, settings, &Instrument::default()).unwrap();
    (curves[0].clone(), warnings)
}

/// ρ v² over that of the frozen network, less 1, and its standard deviation.
fn compared(packing: &Packing, curves: &[DispersionCurve]) -> Vec<[f64; 2]> {
    let settings = grainlab_micromechanics::Settings::default();
    let stiffness =
        grainlab_micromechanics::analyze(packing, &settings).unwrap().report.stiffness().unwrap().tensor;
    let carried = packing.radii.iter().zip(grainlab_core::non_rattlers(packing));
    let mass: f64 = carried.filter(|(_, p)| *p).map(|(r, _)| packing.material.sphere_mass(*r)).sum();
    let density = mass / packing.cell.volume();
    let one = |c: &DispersionCurve| {
        let network = c.polarization.dot(&(stiffness.christoffel(&c.direction) * c.polarization));
        [density * c.speed.powi(2) / network - 1.0, 2.0 * c.stddev / c.speed]
    };
    curves.iter().map(one).collect()
}

#[test]
fn standing_waves_have_the_stiffness_of_the_frozen_network() {
    for packing in [sample::isotropic(), sample::anisotropic()] {
        let rays = [
            ray(&packing, [0, 0, 1], &[0, 1]),
            ray(&packing, [1, 0, 0], &[2]),
            ray(&packing, [1, 0, 1], &[0, 2]),
        ];
        let (curves, traces, warnings) =
            curves(&packing, &rays, &Settings::default(), &Instrument::default()).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!((curves.len(), traces.len()), (5, 5));
        let polarizations = rays.iter().flat_map(|r| &r.polarizations);
        for ((curve, polarization), [off, stddev]) in
            curves.iter().zip(polarizations).zip(compared(&packing, &curves))
        {
            assert_eq!(curve.polarization, *polarization);
            // At most 0.25 %; the largest found is 0.16 %.
            assert!(off.abs() < 2.5e-3, "{off:e} {curve:?}");
            assert!(off.abs() < 2.5 * stddev && stddev < 2e-3, "{off:e} {stddev:e} {curve:?}");
            // Longer waves are faster.
            assert!(
                curve.points.len() == 3 && (0.2..0.9).contains(&(curve.dispersion_coefficient / 4e-8)),
                "{curve:?}"
            );
        }
    }
}

#[test]
fn waves_excited_at_once_are_independent() {
    let packing = sample::isotropic();
    let (few, _) = quick(&packing, 1, &QUICK);
    let (many, _) = quick(&packing, 1, &Settings { copies: 12, ..QUICK });
    assert_eq!((few.points.len(), many.points.len()), (2, 4));
    for (one, other) in few.points.iter().zip(many.points.iter().skip(1).step_by(2)) {
        assert!((one.wavenumber / other.wavenumber - 1.0).abs() < 1e-12);
        // Sampled at other times.
        assert!((one.speed / other.speed - 1.0).abs() < 3e-5, "{one:?} {other:?}");
    }
}

#[test]
fn the_amplitude_does_not_matter_while_it_is_small() {
    let packing = sample::anisotropic();
    let (reference, _) = quick(&packing, 1, &QUICK);
    for amplitude in [1e-11, 1e-8] {
        let (curve, warnings) = quick(&packing, 1, &Settings { amplitude, ..QUICK });
        assert!(warnings.is_empty(), "{warnings:?}");
        assert!((curve.speed / reference.speed - 1.0).abs() < 2e-4, "{curve:?} {reference:?}");
    }
}

#[test]
fn an_amplitude_that_opens_contacts_gives_a_warning_and_a_larger_uncertainty() {
    let packing = sample::anisotropic();
    let (small, _) = quick(&packing, 1, &QUICK);
    for amplitude in [1e-6, 1e-4] {
        let (curve, warnings) = quick(&packing, 1, &Settings { amplitude, ..QUICK });
        let Some(Warning::Nonlinear { opened, closed, change, .. }) = warnings.first() else {
            panic!("{warnings:?}");
        };
        assert!(opened + closed > 0 && *change > 1e-3);
        assert!((small.speed - curve.speed).abs() < 2.0 * curve.stddev, "{small:?} {curve:?}");
    }
}

#[test]
fn noise_widens_the_uncertainty_by_its_effect() {
    let packing = sample::isotropic();
    let rays = [ray(&packing, [0, 0, 1], &[0])];
    let measured = |instrument: &Instrument| curves(&packing, &rays, &QUICK, instrument).unwrap();
    let (clean, ..) = measured(&Instrument::default());
    let noisy = |seed| Instrument { signal_to_noise: 20.0, seed, ..Instrument::default() };
    let mut squares = 0.0;
    for seed in 0..4 {
        let (curve, ..) = measured(&noisy(seed));
        assert!(curve[0].stddev > 2.0 * clean[0].stddev);
        squares += ((curve[0].speed - clean[0].speed) / curve[0].stddev).powi(2);
    }
    assert!(squares < 4.0 * 2.0, "{squares}");
    let (once, again, other) = (measured(&noisy(7)), measured(&noisy(7)), measured(&noisy(8)));
    assert!(once == again && once.1 != other.1);
    // Noise that hides the signal.
    let loud = Instrument { signal_to_noise: -60.0, ..Instrument::default() };
    let found = curves(&packing, &rays, &QUICK, &loud);
    assert!(matches!(found, Err(AcousticsError::NoSignal { .. })), "{found:?}");
}

#[test]
fn the_trace_is_what_the_instrument_samples() {
    let packing = sample::isotropic();
    let rays = [ray(&packing, [0, 0, 1], &[0])];
    let (curves_found, traces, _) = curves(&packing, &rays, &QUICK, &Instrument::default()).unwrap();
    let (curve, trace) = (&curves_found[0], &traces[0]);
    assert_eq!((trace.method, trace.channels.len()), (WaveMethod::StandingWave, 2));
    for (point, channel) in curve.points.iter().zip(&trace.channels) {
        assert!((TAU / point.wavenumber / channel.distance - 1.0).abs() < 1e-12);
    }
    assert!((trace.frequency / (curve.points[0].speed / trace.channels[0].distance) - 1.0).abs() < 1e-2);
    // Each of the two waves has half of the strain.
    let expected = 0.5 * QUICK.amplitude * curve.speed;
    assert!((trace.channels[0].samples[0] / expected - 1.0).abs() < 0.15, "{expected:e}");

    let slow = Instrument { sample_rate: Some(20.0 * trace.frequency), ..Instrument::default() };
    let (sparse, sampled, _) = curves(&packing, &rays, &QUICK, &slow).unwrap();
    assert_eq!(Some(sampled[0].sample_rate), slow.sample_rate);
    assert!((sampled[0].channels[0].samples.len() as f64 - 40.0).abs() < 3.0);
    assert!((sparse[0].speed / curve.speed - 1.0).abs() < 1e-3);
    let too_slow = Instrument { sample_rate: Some(8.0 * trace.frequency), ..slow };
    let refused = curves(&packing, &rays, &QUICK, &too_slow).unwrap_err();
    assert!(matches!(refused, AcousticsError::Setting { name: "sample_rate", .. }), "{refused}");
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let packing = sample::isotropic();
    let rays = [ray(&packing, [0, 0, 1], &[0])];
    for (settings, expected) in [
        (Settings { copies: 4, ..QUICK }, "copies"),
        (Settings { copies: u32::MAX, ..QUICK }, "copies"),
        (Settings { periods: 1.0, ..QUICK }, "periods"),
        (Settings { periods: f64::NAN, ..QUICK }, "periods"),
        (Settings { amplitude: 0.0, ..QUICK }, "amplitude"),
        (Settings { amplitude: f64::NAN, ..QUICK }, "amplitude"),
        (Settings { friction: Some(f64::NAN), ..QUICK }, "friction"),
    ] {
        let error = curves(&packing, &rays, &settings, &Instrument::default()).unwrap_err();
        assert!(matches!(&error, AcousticsError::Setting { name, .. } if *name == expected), "{error}");
    }
}

#[test]
fn rays_not_normal_to_planes_and_packings_without_network_are_refused() {
    let packing = sample::isotropic();
    let good = ray(&packing, [0, 0, 1], &[0]);
    let none = Ray { indices: None, ..good.clone() };
    let other = Ray { indices: Some([1, 0, 0]), ..good.clone() };
    let nothing = Ray { indices: Some([0; 3]), ..good.clone() };
    for bad in [none, other, nothing] {
        let error = curves(&packing, &[bad], &QUICK, &Instrument::default()).unwrap_err();
        assert!(matches!(error, AcousticsError::NoLatticePlane { .. }), "{error}");
    }
    let long = Ray { polarizations: vec![Vec3::z() * 2.0], ..good.clone() };
    let error = curves(&packing, &[long], &QUICK, &Instrument::default()).unwrap_err();
    assert!(matches!(error, AcousticsError::Setting { name: "polarization", .. }), "{error}");

    let gas = Packing { contacts: Vec::new(), ..packing };
    let error = curves(&gas, &[good], &QUICK, &Instrument::default()).unwrap_err();
    assert!(matches!(error, AcousticsError::NotJammed(_)), "{error}");
}
