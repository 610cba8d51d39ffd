//! Stated errors are neither too small nor too large.

use crate::sample;
use grainlab_acoustics::{MethodSettings, Settings, Survey, dispersion, measure};
use grainlab_core::Packing;

/// Each speed less that of the frozen network, over the standard deviation stated; and the latter over the speed.
fn sigmas(packing: &Packing, method: MethodSettings) -> Vec<[f64; 2]> {
    let network =
        grainlab_micromechanics::analyze(packing, &grainlab_micromechanics::Settings::default()).unwrap();
    let stiffness = network.report.stiffness().unwrap().tensor;
    let settings = Settings { method, survey: Survey::Minimal, ..Settings::default() };
    let found = measure(packing, &settings).unwrap();
    let one = |wave: &grainlab_core::MeasuredWave| {
        let wave = wave.wave;
        let expected = found.effective_density.speed(&stiffness, &wave.direction, &wave.polarization);
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
    let usual = dispersion::Settings::default();
    let short = dispersion::Settings { wavelengths: vec![100.0, 150.0, 200.0], ..usual.clone() };
    let mut all = Vec::new();
    for packing in [sample::isotropic(), sample::anisotropic()] {
        let far = sigmas(&packing, MethodSettings::Dispersion(usual.clone()));
        assert!(far.iter().all(|[s, stated]| s.abs() < 3.0 && *stated < 1e-5), "{far:?}");
        // Some motions of the second packing are slower than all of these waves.
        let near = sigmas(&packing, MethodSettings::Dispersion(short.clone()));
        assert!(near.iter().all(|[s, stated]| s.abs() < 4.0 && *stated < 1e-3), "{near:?}");
        all.extend(near);
    }
    assert!((0.1..1.5).contains(&rms(&all)), "{} {all:?}", rms(&all));
}
