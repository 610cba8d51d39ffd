//! The axis inferred from the speeds.

use super::laboratory::{DENSITY, PACKING, Sample, every_mode, medium, thirteen};
use grainlab_core::{TransverseIsotropy, Vec3, WaveSpeed};
use grainlab_emt::christoffel::{self, AxisError, AxisEstimate, ChristoffelError};
use grainlab_emt::{Conditions, Measured, Modulus};
use grainlab_testkit::{Random, nightly};
use nalgebra::{Rotation3, SMatrix, SVector, SymmetricEigen};

const ISOTROPIC: TransverseIsotropy = TransverseIsotropy::of_constants(300e6, 300e6, 60e6, 120e6, 120e6);

fn is_compressional(speed: &WaveSpeed) -> bool {
    speed.direction.dot(&speed.polarization).abs() > 0.7
}

/// The difference between the axis found and the true one, and its square weighted by its inverse covariance.
fn error(found: &AxisEstimate, truth: &Vec3) -> (Vec3, f64) {
    assert!((found.axis.norm() - 1.0).abs() < 1e-12 && found.axis.z >= 0.0, "{found:?}");
    let error = found.axis * found.axis.dot(truth).signum() - truth;
    let eigen = SymmetricEigen::new(found.covariance);
    let parts = eigen.eigenvectors.column_iter().zip(eigen.eigenvalues.iter());
    // The smallest eigenvalue is that along the axis.
    let known = parts.filter(|(_, variance)| **variance > 1e-9 * eigen.eigenvalues.max());
    (error, known.map(|(towards, variance)| error.dot(&towards).powi(2) / variance).sum())
}

#[test]
fn axes_of_packings_are_found_within_their_stated_error_and_moduli_about_them_within_theirs() {
    let draws = nightly(24, 60);
    let mut random = Random::new(1);
    // Root mean square in degrees: the relative error of the axis is that of the speeds.
    for (relative, degrees) in [(0.0005, 0.18), (0.003, 1.2), (0.01, 3.5)] {
        let (mut square, mut scaled, mut of_moduli) = (0.0, 0.0, 0.0);
        for _ in 0..draws {
            let sample = Sample::new(PACKING, random.rotation());
            let speeds = every_mode(&sample.stiffness, &thirteen(), relative, &mut random);
            let found = christoffel::find_axis(&speeds).unwrap_or_else(|e| panic!("{relative}: {e}"));
            let (error, by_covariance) = error(&found, &sample.axis());
            square += error.norm_squared();
            scaled += by_covariance;
            let density = Measured::exact(DENSITY);
            let fitted =
                christoffel::moduli_from_speeds(&speeds, density, Some(found.axis), Conditions::at(50e3))
                    .unwrap();
            of_moduli += distance(&sample, &fitted);
            assert_eq!((fitted.conflict, fitted.anisotropy_scatter), (None, None));
        }
        let mean = |sum: f64| sum / draws as f64;
        let rms = mean(square).sqrt().to_degrees();
        assert!((rms / degrees - 1.0).abs() < 0.25, "{relative}: {rms}");
        // Four standard deviations of the mean of the draws.
        assert!(
            (mean(scaled) - 2.0).abs() < 4.0 * (4.0 / draws as f64).sqrt(),
            "{relative}: {}",
            mean(scaled)
        );
        assert!((mean(of_moduli) - 5.0).abs() < 4.0 * (10.0 / draws as f64).sqrt(), "{}", mean(of_moduli));
    }
}

/// Squared distance of the moduli from the truth, weighted by their inverse covariance; its expectation is 5.
fn distance(sample: &Sample, fitted: &christoffel::SpeedFit) -> f64 {
    const FIVE: [Modulus; 5] = [Modulus::C11, Modulus::C33, Modulus::C13, Modulus::G13, Modulus::G12];
    let error =
        SVector::<f64, 5>::from(FIVE.map(|m| fitted.observation.moduli.get(m).unwrap() - sample.truth(m)));
    let covariance = fitted.observation.covariance.unwrap();
    let five = SMatrix::<f64, 5, 5>::from_fn(|i, j| covariance[(FIVE[i] as usize, FIVE[j] as usize)]);
    error.dot(&five.cholesky().unwrap().solve(&error))
}

#[test]
fn exact_speeds_give_the_exact_axis_whether_or_not_their_errors_are_known() {
    let mut random = Random::new(2);
    for draw in 0..12 {
        let sample = Sample::new(medium(&mut random, 0.3), random.rotation());
        let mut speeds = every_mode(&sample.stiffness, &thirteen(), 0.0, &mut random);
        let stddev = (draw % 2 == 0).then_some(0.5);
        speeds.iter_mut().for_each(|s| s.stddev = stddev);
        let found = christoffel::find_axis(&speeds).unwrap_or_else(|e| panic!("{e}: {:?}", sample.moduli));
        assert!(error(&found, &sample.axis()).0.norm() < 1e-5, "{found:?} of {:?}", sample.moduli);
    }
}

#[test]
fn p_speeds_alone_determine_the_axis_of_a_strongly_anisotropic_medium() {
    let mut random = Random::new(3);
    for _ in 0..10 {
        let sample = Sample::new(PACKING, random.rotation());
        let mut speeds = every_mode(&sample.stiffness, &thirteen(), 0.0005, &mut random);
        speeds.retain(is_compressional);
        assert_eq!(speeds.len(), 13);
        let found = christoffel::find_axis(&speeds).unwrap();
        let off = error(&found, &sample.axis()).0.norm();
        assert!(off < 4.0 * found.stddev() && found.stddev() < 0.03, "{off} {found:?}");
    }
}

#[test]
fn a_medium_that_is_isotropic_within_the_noise_gives_an_error_instead_of_an_axis() {
    let mut random = Random::new(4);
    for relative in [0.0005, 0.003, 0.01] {
        for _ in 0..nightly(6, 20) {
            let speeds = every_mode(&ISOTROPIC.stiffness(), &thirteen(), relative, &mut random);
            let fault = christoffel::find_axis(&speeds).unwrap_err();
            assert!(matches!(fault, AxisError::Isotropic { sigma, .. } if sigma < 4.0), "{fault}");
            assert!(fault.to_string().contains("any axis would serve"), "{fault}");
        }
    }
}

#[test]
fn the_error_of_too_few_speeds_has_their_number_and_a_direction() {
    let mut random = Random::new(5);
    let sample = Sample::new(PACKING, Rotation3::identity());
    let axes = [Vec3::x(), Vec3::z()];
    let mut speeds = every_mode(&sample.stiffness, &axes, 0.003, &mut random);
    let fault = christoffel::find_axis(&speeds).unwrap_err();
    let AxisError::TooFew { speeds: 6, unknowns, scatter: false, direction } = fault.clone() else {
        panic!("{fault}")
    };
    assert!(unknowns == 7 && direction.y.abs() > 0.95, "{fault}");
    // Without errors, their scatter is one more unknown.
    speeds.iter_mut().for_each(|s| s.stddev = None);
    let fault = christoffel::find_axis(&speeds).unwrap_err();
    assert!(matches!(fault, AxisError::TooFew { scatter: true, unknowns: more, .. } if more == unknowns + 1));
    assert!(fault.to_string().contains("6 wave speeds cannot determine"), "{fault}");
}

/// P speeds in one plane give as many numbers as there are harmonics up to the fourth, five: media about
/// several axes fit them, and each has a mirror image.
#[test]
fn rays_in_one_plane_leave_several_axes_and_the_directions_advised_lead_to_the_true_one() {
    let mut random = Random::new(6);
    let sample = Sample::new(PACKING, Rotation3::from_axis_angle(&Vec3::x_axis(), 0.6));
    let compression = |directions: &[Vec3], random: &mut Random| {
        let mut speeds = every_mode(&sample.stiffness, directions, 0.0005, random);
        speeds.retain(is_compressional);
        speeds
    };
    let around = |k: i32| (f64::from(k) * std::f64::consts::PI / 8.0).sin_cos();
    let fan: Vec<Vec3> = (0..8).map(around).map(|(sin, cos)| Vec3::new(sin, 0.0, cos)).collect();
    let mut speeds = compression(&fan, &mut random);
    for added in 0..6 {
        let (axes, direction, difference) = match christoffel::find_axis(&speeds) {
            Ok(found) => {
                let off = error(&found, &sample.axis()).0.norm();
                assert!(added > 0 && off < 4.0 * found.stddev() && off < 0.1, "{added}: {off} {found:?}");
                return;
            }
            Err(AxisError::NotUnique { axes, direction, difference: Some(d) }) => (axes, direction, d),
            Err(fault) => panic!("{added}: {fault}"),
        };
        if added == 0 {
            assert!((axes[0].y + axes[1].y).abs() < 0.05 && direction.y.abs() > 0.3, "{axes:?} {direction}");
        }
        assert!(difference > 0.002, "{axes:?} differ by {difference}");
        speeds.extend(compression(&[direction], &mut random));
    }
    panic!("six directions more, and no axis");
}

#[test]
fn invalid_speeds_are_refused_before_the_search() {
    assert_eq!(christoffel::find_axis(&[]), Err(ChristoffelError::NoSpeeds.into()));
    let sample = Sample::new(PACKING, Rotation3::identity());
    let speeds = every_mode(&sample.stiffness, &thirteen(), 0.003, &mut Random::new(7));
    let fault = |spoil: &dyn Fn(&mut WaveSpeed)| {
        let mut speeds = speeds.clone();
        spoil(&mut speeds[20]);
        christoffel::find_axis(&speeds).unwrap_err().to_string()
    };
    assert!(fault(&|s| s.speed = f64::NAN).starts_with("speeds[20].speed = NaN"));
    assert!(fault(&|s| s.stddev = Some(0.0)).starts_with("speeds[20].stddev = 0"));
    assert!(fault(&|s| s.direction = Vec3::zeros()).starts_with("speeds[20].direction has the length 0"));
    assert!(fault(&|s| s.polarization.x = f64::NAN).starts_with("speeds[20].polarization"));
}

#[test]
fn numbers_of_absurd_scale_are_answered_or_refused() {
    let mut random = Random::new(8);
    let sample = Sample::new(PACKING, Rotation3::identity());
    for _ in 0..100 {
        let mut speeds = every_mode(&sample.stiffness, &thirteen()[..6], 0.003, &mut random);
        for speed in &mut speeds {
            speed.speed =
                speed.speed.abs() * 10f64.powf(random.between(-300.0, 300.0) * random.unit().powi(4));
            speed.stddev = Some(10f64.powf(random.between(-300.0, 300.0)));
        }
        if let Ok(found) = christoffel::find_axis(&speeds) {
            assert!(found.axis.iter().chain(found.covariance.iter()).all(|v| v.is_finite()), "{found:?}");
        }
    }
}
