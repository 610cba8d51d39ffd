//! Stated errors are neither too small nor too large.

use crate::sample::{self, surveys};
use grainlab_acoustics::{Measurement, MethodSettings, Settings, Survey, dispersion, measure};
use grainlab_core::Stiffness;

/// Each speed less that of the frozen network, over the standard deviation stated; and the latter over the speed.
fn sigmas(found: &Measurement, stiffness: &Stiffness) -> Vec<[f64; 2]> {
    let one = |wave: &grainlab_core::MeasuredWave| {
        let wave = wave.wave;
        let expected = found.effective_density.speed(stiffness, &wave.direction, &wave.polarization);
        let stddev = wave.stddev.unwrap();
        [(wave.speed - expected) / stddev, stddev / wave.speed]
    };
    found.waves.iter().map(one).collect()
}

fn rms(sigmas: &[[f64; 2]]) -> f64 {
    (sigmas.iter().map(|[s, _]| s * s).sum::<f64>() / sigmas.len() as f64).sqrt()
}

#[test]
fn dispersion_states_errors_as_small_as_they_are_and_short_waves_state_larger_ones() {
    let wavelengths = vec![100.0, 150.0, 200.0];
    let short = dispersion::Settings { wavelengths, ..dispersion::Settings::default() };
    let short = Settings {
        method: MethodSettings::Dispersion(short),
        survey: Survey::Minimal,
        ..Settings::default()
    };
    let mut all = Vec::new();
    for ((usual, stiffness), packing) in surveys().iter().zip([sample::isotropic(), sample::anisotropic()]) {
        let far = sigmas(usual, stiffness);
        assert!(far.iter().all(|[s, stated]| s.abs() < 3.0 && *stated < 1e-5), "{far:?}");
        // Some motions of the second packing are slower than all of these waves.
        let near = sigmas(&measure(&packing, &short).unwrap(), stiffness);
        assert!(near.iter().all(|[s, stated]| s.abs() < 4.0 && *stated < 1e-3), "{near:?}");
        all.extend(near);
    }
    assert!((0.1..1.5).contains(&rms(&all)), "{} {all:?}", rms(&all));
}
