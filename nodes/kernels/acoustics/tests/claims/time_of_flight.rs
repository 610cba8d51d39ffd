//! Tests of the time of flight through the particle engine.

use crate::sample;
use grainlab_acoustics::AcousticsError;
use grainlab_acoustics::time_of_flight::Arrivals;
use grainlab_acoustics::time_of_flight::{ArrivalPick, Settings, curve, curves};
use grainlab_acoustics::{Instrument, Ray};
use grainlab_core::Contact;
use grainlab_core::notes::{Code, Note};
use grainlab_core::results::NoStiffness;
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_testkit::nightly;
use std::f64::consts::{PI, TAU};

const DIAMETER: f64 = 2e-4;
const GRAINS: u32 = 8;

/// A chain of equal grains along e3, alone in its cell, with overlaps of a thousandth; `aside` adds a
/// rattler.
fn chain(aside: bool) -> Packing {
    let step = DIAMETER * (1.0 - 1e-3);
    let length = step * f64::from(GRAINS);
    let grains = (GRAINS + u32::from(aside)) as usize;
    let mut positions: Vec<Vec3> = (0..GRAINS).map(|k| Vec3::z() * step * (f64::from(k) + 0.25)).collect();
    if aside {
        positions.push(Vec3::new(2.0 * DIAMETER, 0.0, 0.4 * length));
    }
    let last = GRAINS - 1;
    let pair = |i: u32, j: u32, image: i8, normal: Vec3| {
        Contact::pressed([i, j], [0, 0, image], normal, 1e-3 * DIAMETER, 0.0)
    };
    let mut contacts: Vec<Contact> = (0..last).map(|k| pair(k, k + 1, 0, Vec3::z())).collect();
    contacts.push(pair(0, last, -1, -Vec3::z()));
    contacts.sort_by_key(|c| (c.i, c.j, c.image));
    let cell = Cell::new(Mat3::from_diagonal(&Vec3::new(4.0 * DIAMETER, 4.0 * DIAMETER, length))).unwrap();
    let packing = Packing {
        velocities: vec![Vec3::new(1.0, 2.0, 3.0); grains],
        contacts,
        friction: 0.5,
        ..Packing::at_rest(cell, vec![0.5 * DIAMETER; grains], positions)
    };
    packing.validated().unwrap()
}

/// Distance of neighbours, m, and speed of long waves along the chain, m/s.
fn closed_form() -> (f64, f64) {
    let packing = chain(false);
    let (stiffness, _) = packing.contact_stiffness(&packing.contacts[0]);
    let step = DIAMETER * (1.0 - 1e-3);
    (step, step * (stiffness / packing.material.sphere_mass(0.5 * DIAMETER)).sqrt())
}

fn along(packing: &Packing, indices: [i32; 3], polarization: Vec3) -> Ray {
    let direction = Ray::normal(&packing.cell, indices).unwrap();
    Ray { direction, indices: Some(indices), polarizations: vec![polarization] }
}

fn up(packing: &Packing) -> [Ray; 1] {
    [along(packing, [0, 0, 1], Vec3::z())]
}

fn refused(settings: Settings) -> AcousticsError {
    let packing = chain(false);
    curves(&packing, &up(&packing), &settings, &Instrument::default()).unwrap_err()
}

#[test]
fn a_pulse_along_a_chain_has_the_speed_of_the_closed_form() {
    let packing = chain(false);
    let (step, speed) = closed_form();
    let settings = Settings::default();
    let (_, traces, warnings) = curves(&packing, &up(&packing), &settings, &Instrument::default()).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    for pick in [ArrivalPick::FirstArrival, ArrivalPick::CrossCorrelation, ArrivalPick::Peak] {
        let found = curve(&traces, settings.cycles, pick, DIAMETER, 1).unwrap();
        let off = found.speed / speed - 1.0;
        assert!(off.abs() < 5e-3 && off.abs() < 2.0 * found.stddev / speed, "{pick:?} {off:e} {found:?}");
        for point in &found.points {
            let half = 0.5 * point.wavenumber * step;
            assert!((point.speed / speed - half.sin() / half).abs() < 2e-3, "{pick:?} {point:?}");
        }
    }
    for trace in &traces {
        // ω = (2v/a) sin(qa/2) has the group speed v cos(qa/2).
        let half = (PI * trace.frequency * step / speed).asin();
        let peak = Arrivals::pick(trace, settings.cycles, ArrivalPick::Peak, 1).unwrap();
        let off = 1.0 / (peak.slowness * speed * half.cos()) - 1.0;
        assert!(off.abs() < 2e-3, "{:e} Hz: {off:e}", trace.frequency);
    }
}

#[test]
fn a_grain_without_contacts_does_not_change_the_signal() {
    let signals = |packing: &Packing| {
        curves(packing, &up(packing), &Settings::default(), &Instrument::default()).unwrap()
    };
    let (alone, beside) = (signals(&chain(false)), signals(&chain(true)));
    assert_eq!(alone.1, beside.1);
    assert_eq!(alone.0, beside.0);
}

#[test]
fn the_same_bits_whatever_the_threads() {
    let packing = chain(false);
    let instrument = Instrument { signal_to_noise: 25.0, shots: 2, jitter: 1e-7, ..Instrument::default() };
    let rays = [up(&packing), up(&packing)].concat();
    let measured = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| curves(&packing, &rays, &Settings::default(), &instrument).unwrap())
    };
    let one = measured(1);
    assert_eq!(one, measured(3));
    // Another ray has different noise.
    assert_ne!(one.1[0].channels, one.1[3].channels);
}

#[test]
fn the_error_of_a_short_path_has_the_length_needed() {
    let packing = chain(false);
    let short = |copies| refused(Settings { copies: Some(copies), ..Settings::default() });
    let AcousticsError::PathTooShort { enough, path, needed, .. } = short(3) else {
        panic!("{:?}", short(3))
    };
    assert!(enough > 3 && path < needed);
    let AcousticsError::PathTooShort { .. } = short(enough - 1) else {
        panic!("{enough} are more than enough")
    };
    let settings = Settings { copies: Some(enough), ..Settings::default() };
    curves(&packing, &up(&packing), &settings, &Instrument::default()).unwrap();
}

#[test]
fn a_frequency_above_the_band_is_refused_with_the_cutoff() {
    let (step, speed) = closed_form();
    let edge = speed / (PI * step);
    let send =
        |frequency: f64| refused(Settings { frequencies: Some(vec![frequency]), ..Settings::default() });
    let error = send(1.5 * edge);
    let AcousticsError::CutOff { cutoff, frequency, .. } = error else { panic!("{error:?}") };
    assert!((cutoff / edge - 1.0).abs() < 0.02 && frequency == 1.5 * edge, "{cutoff} {edge}");
    // The edge of the band is 2√(k/m)/2π.
    let packing = chain(false);
    let (stiffness, _) = packing.contact_stiffness(&packing.contacts[0]);
    let omega = 2.0 * (stiffness / packing.material.sphere_mass(0.5 * DIAMETER)).sqrt();
    assert!((omega / TAU / edge - 1.0).abs() < 1e-12);
}

#[test]
fn one_frequency_gives_a_speed_with_a_large_uncertainty() {
    let packing = chain(false);
    let (_, speed) = closed_form();
    let frequency = speed / (25.0 * DIAMETER);
    let settings = Settings { frequencies: Some(vec![frequency]), ..Settings::default() };
    let (found, ..) = curves(&packing, &up(&packing), &settings, &Instrument::default()).unwrap();
    let off = (found[0].speed - speed).abs();
    assert!(off > 1e-3 * speed && off < 2.0 * found[0].stddev && found[0].stddev < 0.02 * speed, "{found:?}");
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let good = Settings::default;
    for (name, settings) in [
        ("cycles", Settings { cycles: 0.0, ..good() }),
        ("cycles", Settings { cycles: f64::NAN, ..good() }),
        ("amplitude", Settings { amplitude: f64::NAN, ..good() }),
        ("amplitude", Settings { amplitude: 0.0, ..good() }),
        ("amplitude", Settings { amplitude: 1.0, ..good() }),
        ("copies", Settings { copies: Some(0), ..good() }),
        ("friction", Settings { friction: Some(f64::NAN), ..good() }),
        ("frequencies", Settings { frequencies: Some(vec![]), ..good() }),
        ("frequencies", Settings { frequencies: Some(vec![1e5, f64::NAN]), ..good() }),
        ("frequencies", Settings { frequencies: Some(vec![1e5, 1e5]), ..good() }),
    ] {
        let found = refused(settings);
        assert!(matches!(found, AcousticsError::Setting { name: n, .. } if n == name), "{name} {found:?}");
    }
    let packing = chain(false);
    let noisy = Instrument { signal_to_noise: f64::NAN, ..Instrument::default() };
    assert!(curves(&packing, &up(&packing), &good(), &noisy).is_err());
}

#[test]
fn grains_that_do_not_touch_carry_no_wave() {
    let mut packing = chain(false);
    packing.contacts.clear();
    let sent =
        |packing: &Packing| curves(packing, &up(packing), &Settings::default(), &Instrument::default());
    let found = sent(&packing);
    assert!(
        matches!(found, Err(AcousticsError::NoStiffness(NoStiffness::NoContacts { grains: 8 }))),
        "{found:?}"
    );
    // A chain with a gap: all its grains become rattlers, one after the other.
    let mut packing = chain(false);
    packing.contacts.truncate(3);
    let found = sent(&packing);
    assert!(matches!(found, Err(AcousticsError::NoStiffness(NoStiffness::OnlyRattlers { .. }))), "{found:?}");
}

#[test]
fn invalid_rays_are_refused() {
    let packing = chain(false);
    let [good] = up(&packing);
    let sent = |ray: Ray| curves(&packing, &[ray], &Settings::default(), &Instrument::default());
    for ray in [Ray { indices: None, ..good.clone() }, Ray { direction: Vec3::x(), ..good.clone() }] {
        let found = sent(ray);
        assert!(matches!(found, Err(AcousticsError::NoLatticePlane { .. })), "{found:?}");
    }
    for polarization in [Vec3::zeros(), Vec3::new(0.0, f64::NAN, 1.0)] {
        let found = sent(Ray { polarizations: vec![polarization], ..good.clone() });
        assert!(matches!(found, Err(AcousticsError::Setting { name: "polarization", .. })), "{found:?}");
    }
}

#[test]
fn a_wave_that_opens_contacts_is_called_nonlinear() {
    let packing = chain(false);
    let sent = |amplitude: f64| {
        let settings = Settings { amplitude, ..Settings::default() };
        curves(&packing, &up(&packing), &settings, &Instrument::default()).unwrap()
    };
    let (small, _, none) = sent(1e-7);
    assert!(none.is_empty(), "{none:?}");
    let (large, _, warnings) = sent(2e-3);
    let nonlinear =
        |n: &Note| n.is(Code::Nonlinear) && n.value("opened") > Some(0.0) && n.value("change") > Some(0.01);
    assert!(warnings.iter().any(nonlinear), "{warnings:?}");
    let off = (large[0].speed - small[0].speed).abs();
    assert!(off < 2.0 * large[0].stddev, "{off} {large:?}");
}

/// pᵀΓp/ρ of the frozen network, m²/s².
fn square_speed(packing: &Packing, ray: &Ray) -> f64 {
    let stiffness = sample::stiffness(packing);
    let present = grainlab_core::non_rattlers(packing);
    let masses = packing.radii.iter().zip(&present).filter(|(_, p)| **p);
    let mass: f64 = masses.map(|(r, _)| packing.material.sphere_mass(*r)).sum();
    let polarization = ray.polarizations[0];
    polarization.dot(&(stiffness.christoffel(&ray.direction) * polarization)) * packing.cell.volume() / mass
}

#[test]
fn speeds_through_packings_are_those_of_the_frozen_network() {
    // Two wavelengths, shorter than the default ones, which leave the peaks of P uncertain, but need half of
    // the time.
    let both = [
        (sample::anisotropic(), [0, 0, 1], 440.0, [26.0, 34.0]),
        (sample::isotropic(), [1, 0, 0], 280.0, [20.0, 28.0]),
    ];
    for (packing, indices, speed, waves) in both.into_iter().skip(nightly(1, 0)) {
        let ray = along(&packing, indices, Vec3::z());
        let frequencies = Some(waves.map(|w| speed / (w * DIAMETER)).to_vec());
        let settings = Settings { frequencies, ..Settings::default() };
        let sent = curves(&packing, std::slice::from_ref(&ray), &settings, &Instrument::default()).unwrap();
        assert!(sent.2.is_empty(), "{:?}", sent.2);
        let truth = square_speed(&packing, &ray);
        for pick in [ArrivalPick::FirstArrival, ArrivalPick::CrossCorrelation, ArrivalPick::Peak] {
            let found = curve(&sent.1, settings.cycles, pick, DIAMETER, 1).unwrap();
            let (off, stddev) = (found.speed.powi(2) / truth - 1.0, 2.0 * found.stddev / found.speed);
            assert!(off.abs() < 0.04 && off.abs() < 2.0 * stddev, "{indices:?} {pick:?}: {off} ± {stddev}");
            assert!(stddev < 0.06, "{indices:?} {pick:?}: {stddev}");
        }
    }
}
