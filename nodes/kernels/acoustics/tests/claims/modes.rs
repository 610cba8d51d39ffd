//! The modes of a ray are those of Christoffel's equation with all 21 constants of the network's stiffness.

use crate::sample::{self, minimal, stiffness, surveys};
use grainlab_acoustics::{Measurement, Modes, Settings, Survey, measure};
use grainlab_core::{MeasuredWave, Packing, Stiffness};
use grainlab_testkit::packings::mode_nearest;

/// Grains of radii that differ by up to 30 %, with the contacts of another packing.
fn unequal() -> Packing {
    let mut packing = sample::anisotropic();
    for (g, r) in packing.radii.iter_mut().enumerate() {
        *r *= 0.85 + 0.3 * ((g * 7919 % 101) as f64 / 101.0);
    }
    packing
}

/// Relative difference of ρv² from the eigenvalue, and the stated relative error of ρv².
fn off(m: &Measurement, c: &Stiffness, wave: &MeasuredWave) -> [f64; 2] {
    let w = wave.wave;
    let (expected, _) = mode_nearest(c, &w.direction, &w.polarization);
    let stated = (2.0 * w.stddev.unwrap() / w.speed).hypot(m.density_stddev / m.density);
    [m.density * w.speed * w.speed / expected - 1.0, stated]
}

#[test]
fn modes_have_the_eigenvalues_of_the_full_stiffness() {
    let unequal = unequal();
    let of_unequal = (measure(&unequal, &Settings::default()).unwrap(), stiffness(&unequal));
    for (m, c) in [&surveys()[1], &of_unequal] {
        assert_eq!((m.modes.len(), m.waves.len()), (27, 27));
        for mode in &m.modes {
            let [off, stated] = off(m, c, mode);
            assert!(off.abs() < (2.0 * stated).max(1e-4) && off.abs() < 5e-4, "{off:e} {stated:e} {mode:?}");
        }
        // Along the given polarizations the speeds are others.
        let apart =
            m.waves.iter().zip(&m.modes).map(|(w, mode)| (w.wave.speed / mode.wave.speed - 1.0).abs());
        assert!(apart.fold(0.0, f64::max) > 1e-4);
    }
}

#[test]
fn what_was_asked_for_is_measured_as_the_modes_nearest_to_it_and_nothing_else() {
    let packing = sample::anisotropic();
    let of = |modes| {
        measure(&packing, &Settings { modes, survey: Survey::Minimal, ..Settings::default() }).unwrap()
    };
    let (all, p, s) = (minimal(), of(Modes::Compression), of(Modes::Shear));
    assert_eq!((p.modes.len(), p.waves.len(), s.waves.len()), (3, 3, 6));
    assert!(p.waves.iter().all(|w| w.wave.direction.dot(&w.wave.polarization) > 0.99));
    assert!(s.waves.iter().all(|w| w.wave.direction.dot(&w.wave.polarization).abs() < 1e-9));
    for (one, three) in p.modes.iter().zip(all.modes.chunks(3)) {
        assert!((one.wave.speed / three[0].wave.speed - 1.0).abs() < 1e-6, "{one:?} {three:?}");
        assert!(one.wave.direction.dot(&one.wave.polarization) > 0.99);
    }
}

#[test]
fn noise_of_speeds_is_in_those_of_modes_too() {
    let packing = sample::anisotropic();
    let mut settings = Settings { survey: Survey::Minimal, ..Settings::default() };
    let clean = minimal();
    settings.instrument.speed_noise = 0.01;
    let noisy = measure(&packing, &settings).unwrap();
    let relative = |k: usize| noisy.modes[k].wave.speed / clean.modes[k].wave.speed - 1.0;
    let square = (0..9).map(|k| relative(k).powi(2)).sum::<f64>() / 9.0;
    assert!((0.003..0.02).contains(&square.sqrt()), "{square:e}");
    assert!(noisy.modes.iter().all(|m| m.wave.stddev.unwrap() > 0.009 * m.wave.speed));
}
