//! Invalid speeds are refused.

use super::laboratory::{DENSITY, PACKING, Sample, Wave};
use grainlab_core::{Vec3, WaveSpeed};
use grainlab_emt::christoffel::{self, ChristoffelError, SpeedFit};
use grainlab_emt::{Conditions, Measured, Modulus};
use grainlab_testkit::Random;
use nalgebra::{Rotation3, Unit};

const WAVES: [Wave; 6] =
    [Wave::P(0.0), Wave::P(90.0), Wave::Sh(90.0), Wave::Sv(0.0), Wave::P(45.0), Wave::Sv(45.0)];

fn sample() -> Sample {
    Sample::new(PACKING, Rotation3::identity())
}

fn speeds() -> Vec<WaveSpeed> {
    let sample = sample();
    WAVES.iter().map(|w| sample.named(*w, 0.0)).collect()
}

/// The error after valid speeds are changed.
fn fault(spoil: impl Fn(&mut Vec<WaveSpeed>)) -> ChristoffelError {
    let mut speeds = speeds();
    assert!(sample().fit(&speeds).is_ok());
    spoil(&mut speeds);
    sample().fit(&speeds).unwrap_err()
}

fn about(axis: Option<Vec3>, density: Measured) -> Result<SpeedFit, ChristoffelError> {
    christoffel::moduli_from_speeds(&speeds(), density, axis, Conditions::at(50e3))
}

#[test]
fn an_empty_list_of_speeds_is_refused() {
    assert_eq!(fault(Vec::clear), ChristoffelError::NoSpeeds);
}

#[test]
fn without_its_axis_a_medium_is_not_guessed_at() {
    let density = Measured::exact(DENSITY);
    assert_eq!(about(None, density).unwrap_err(), ChristoffelError::AxisUnknown);
    let message = about(Some(2.0 * Vec3::z()), density).unwrap_err().to_string();
    assert_eq!(message, "the axis has the length 2, and must be a unit vector");
    assert!(matches!(about(Some(Vec3::zeros()), density), Err(ChristoffelError::NotUnit { .. })));
}

#[test]
fn a_speed_is_positive_and_finite() {
    for value in [0.0, -300.0, f64::NAN, f64::INFINITY] {
        let error = fault(|s| s[3].speed = value);
        assert!(error.to_string().starts_with(&format!("speeds[3].speed = {value} m/s")), "{error}");
        let error = fault(|s| s[2].stddev = Some(value));
        assert!(error.to_string().starts_with(&format!("speeds[2].stddev = {value} m/s")), "{error}");
    }
}

#[test]
fn directions_and_motions_have_unit_length() {
    let error = fault(|s| s[1].direction *= 1.1).to_string();
    assert!(error.starts_with("speeds[1].direction has the length 1.1"), "{error}");
    let error = fault(|s| s[5].polarization = Vec3::zeros()).to_string();
    assert!(error.starts_with("speeds[5].polarization has the length 0"), "{error}");
    assert!(matches!(fault(|s| s[0].direction.x = f64::NAN), ChristoffelError::NotUnit { .. }));
    // The rounding of a file is accepted.
    let mut speeds = speeds();
    speeds[4].polarization = Vec3::new(0.6, 0.0, 0.8);
    speeds[4].direction = Vec3::new(0.6, 0.0, 0.7999998);
    assert!(sample().fit(&speeds).is_ok());
}

#[test]
fn the_density_is_positive_and_finite() {
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = about(Some(Vec3::z()), Measured::exact(value)).unwrap_err();
        assert!(matches!(error, ChristoffelError::Number { .. }), "{error}");
    }
    for stddev in [-1.0, f64::NAN, f64::INFINITY] {
        let error = about(Some(Vec3::z()), Measured { value: DENSITY, stddev }).unwrap_err();
        assert!(matches!(error, ChristoffelError::Number { .. }), "{error}");
    }
}

fn is_ambiguous(error: &ChristoffelError, at: usize) -> bool {
    matches!(error, ChristoffelError::Ambiguous { index, degrees } if *index == at && *degrees > 30.0)
}

/// Across the axis the S modes differ by G13/G12. A polarization at 45° between them is that of a mode only
/// if the moduli are equal, which is not known beforehand.
#[test]
fn a_shear_motion_between_the_modes_is_refused_though_the_medium_may_be_isotropic() {
    let error = fault(|s| s[2].polarization = Vec3::new(0.0, 1.0, 1.0).normalize());
    assert!(is_ambiguous(&error, 2) && error.is_input_error(), "{error}");
    assert!(error.to_string().contains("45 degrees from the nearest mode"), "{error}");
}

#[test]
fn along_the_axis_every_shear_motion_is_a_modes() {
    let mut speeds = speeds();
    for (angle, tilt) in [(0.0f64, 0.0f64), (0.8, 0.0), (2.5, 0.01), (-1.2, 0.02)] {
        speeds[3].polarization = Vec3::new(angle.cos(), angle.sin(), 0.0);
        speeds[3].direction = Vec3::new(tilt.sin(), 0.0, tilt.cos());
        let g13 = sample().fit(&speeds).unwrap().observation.moduli.get(Modulus::G13).unwrap();
        assert!((g13 / PACKING.g13 - 1.0).abs() < 1e-3, "{g13}");
    }
}

#[test]
fn a_motion_between_compression_and_shear_is_refused() {
    // Along the axis, at 45° (where the modes are those of the medium), and out of every plane.
    let error = fault(|s| s[0].polarization = Vec3::new(1.0, 0.0, 1.0).normalize());
    assert!(is_ambiguous(&error, 0), "{error}");
    let error = fault(|s| s[4].polarization = Vec3::x());
    assert!(is_ambiguous(&error, 4), "{error}");
    let error = fault(|s| s[4].polarization = Vec3::new(1.0, 2f64.sqrt(), 1.0).normalize());
    assert!(is_ambiguous(&error, 4), "{error}");
}

#[test]
fn a_motion_within_thirty_degrees_of_its_mode_will_do() {
    let exact = sample().fit(&speeds()).unwrap();
    let mut speeds = speeds();
    for (i, speed) in speeds.iter_mut().enumerate() {
        let axis = Unit::new_normalize(Vec3::new(1.0, i as f64 - 2.0, 0.5));
        speed.polarization = Rotation3::from_axis_angle(&axis, 0.35) * speed.polarization;
    }
    let rough = sample().fit(&speeds).unwrap();
    for (modulus, value) in rough.observation.moduli.known() {
        assert!((value / exact.observation.moduli.get(modulus).unwrap() - 1.0).abs() < 1e-10, "{modulus}");
    }
}

#[test]
fn speeds_that_no_stable_medium_has_are_refused() {
    // P across the axis is slower than S in that plane.
    let error = fault(|s| {
        s.truncate(4);
        (s[1].speed, s[2].speed) = (s[2].speed, s[1].speed);
    });
    assert!(matches!(error, ChristoffelError::Unstable { .. }) && !error.is_input_error(), "{error}");
    assert!(error.to_string().contains("C11 = 67.000 MPa"), "{error}");
    // SH at 45° is slower than half of G13 allows.
    let slow = |s: &mut Vec<WaveSpeed>| {
        s[2] = sample().named(Wave::Sh(45.0), 0.0);
        s[2].speed *= 0.6;
    };
    assert!(matches!(fault(slow), ChristoffelError::Unstable { .. }));
}

#[test]
fn numbers_of_absurd_scale_are_answered_or_refused() {
    let mut random = Random::new(1);
    for _ in 0..2000 {
        let mut speeds = speeds();
        for speed in &mut speeds {
            speed.speed *= 10f64.powf(random.between(-320.0, 320.0) * random.unit().powi(4));
            if random.unit() < 0.5 {
                speed.stddev = Some(10f64.powf(random.between(-300.0, 300.0)));
            }
        }
        let density = Measured { value: 10f64.powf(random.between(-300.0, 300.0)), stddev: 0.0 };
        let result = christoffel::moduli_from_speeds(&speeds, density, Some(Vec3::z()), Conditions::at(50e3));
        if let Ok(fitted) = result {
            assert!(fitted.observation.moduli.known().all(|(_, value)| value.is_finite()), "{fitted:?}");
        }
    }
}

/// A transducer one degree off the axis measures C33 to 0.1 %, and does not determine C13.
#[test]
fn a_direction_that_misses_the_axis_by_a_degree_tells_nothing_new() {
    let sample = sample();
    let waves = [Wave::P(1.0), Wave::P(90.0), Wave::Sh(90.0), Wave::Sv(0.0)];
    let fitted = sample.fit(&waves.map(|w| sample.named(w, 70.0))).unwrap();
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
