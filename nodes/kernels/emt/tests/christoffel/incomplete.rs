//! Fewer speeds than moduli.

use super::laboratory::{PACKING, Sample, Wave};
use grainlab_core::WaveSpeed;
use grainlab_emt::Modulus;
use grainlab_emt::christoffel::SpeedFit;
use nalgebra::Rotation3;

fn sample() -> Sample {
    Sample::new(PACKING, Rotation3::from_euler_angles(0.4, -1.1, 2.0))
}

fn fit(waves: &[Wave]) -> SpeedFit {
    let sample = sample();
    let speeds: Vec<_> = waves.iter().enumerate().map(|(i, w)| sample.named(*w, 70.0 * i as f64)).collect();
    sample.fit(&speeds).unwrap()
}

/// Only these moduli are determined, to rounding.
fn knows(waves: &[Wave], moduli: &[Modulus]) {
    let fitted = fit(waves);
    let known: Vec<_> = fitted.observation.moduli.known().map(|(m, _)| m).collect();
    assert_eq!(known, moduli, "{waves:?}");
    for (modulus, value) in fitted.observation.moduli.known() {
        assert!((value / sample().truth(modulus) - 1.0).abs() < 1e-12, "{modulus} of {waves:?}: {value}");
    }
    let open: Vec<_> = Modulus::ALL.into_iter().filter(|m| !moduli.contains(m)).collect();
    assert_eq!(fitted.undetermined, open);
}

#[test]
fn one_quasi_compressional_speed_completes_the_speeds_along_the_axes() {
    let waves = [Wave::P(0.0), Wave::P(90.0), Wave::Sh(90.0), Wave::Sv(0.0), Wave::P(45.0)];
    knows(&waves, &Modulus::ALL);
    assert_eq!(fit(&waves).degrees_of_freedom, 0);
    assert_eq!(fit(&waves).scatter(), None);
}

#[test]
fn two_shear_speeds_are_enough_for_eps_and_not_for_k() {
    let fitted = fit(&[Wave::Sv(0.0), Wave::Sh(90.0)]);
    let model = grainlab_emt::model("ratio").unwrap();
    let estimate = model.infer(&fitted.observation, &grainlab_emt::Calibration::PAPER).unwrap();
    assert!(estimate.structure.eps.is_some() && estimate.structure.k.is_none());
}

/// A transducer one degree off the axis measures C33 to 0.1 %, and does not determine C13.
#[test]
fn a_direction_that_misses_the_axis_by_a_degree_tells_nothing_new() {
    let fitted = fit(&[Wave::P(1.0), Wave::P(90.0), Wave::Sh(90.0), Wave::Sv(0.0)]);
    assert_eq!(fitted.undetermined, [Modulus::Theta, Modulus::C13]);
    let c33 = fitted.observation.moduli.get(Modulus::C33).unwrap();
    assert!((c33 / PACKING.c33 - 1.0).abs() < 1e-3, "{c33}");
}

/// ρ v² of a P wave at 45° is at least (C11 + C33)/4 + C44/2 plus half of their difference.
#[test]
fn a_speed_that_is_too_slow_for_any_c13_leaves_it_open_and_is_a_conflict() {
    let sample = sample();
    let axial = [Wave::P(0.0), Wave::P(90.0), Wave::Sh(90.0), Wave::Sv(0.0)];
    let mut speeds: Vec<_> = axial.iter().map(|w| sample.named(*w, 0.0)).collect();
    let slow = sample.named(Wave::P(45.0), 0.0);
    speeds.push(WaveSpeed { speed: 0.8 * slow.speed, ..slow });
    for speed in &mut speeds {
        speed.stddev = Some(0.003 * speed.speed);
    }
    let fitted = sample.fit(&speeds).unwrap();
    assert_eq!(fitted.undetermined, [Modulus::Theta, Modulus::C13]);
    assert!(fitted.conflict.is_some_and(|c| c.sigma > 8.0), "{fitted:?}");
}
