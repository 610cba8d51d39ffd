//! Packings that are not exactly isotropic about any axis.

use super::laboratory::{DENSITY, every_mode, thirteen};
use grainlab_core::notes::Status;
use grainlab_core::{Stiffness, Vec3, WaveSpeed};
use grainlab_emt::christoffel::{self, SpeedFit};
use grainlab_emt::{Conditions, Measured, Modulus};
use grainlab_testkit::Random;
use nalgebra::Matrix6;

/// Stiffness in MPa of `anisotropic_2000` and `isotropic_2000` of the golden packings, measured by `grainlab
/// analyze`.
#[rustfmt::skip]
const ANISOTROPIC: [f64; 36] = [
    267.923, 62.331, 65.989, -2.193, -0.769, 2.731,
    62.331, 272.813, 63.711, -1.013, -1.647, 0.792,
    65.989, 63.711, 285.615, 2.828, 0.824, -3.589,
    -2.193, -1.013, 2.828, 108.234, -2.219, -1.946,
    -0.769, -1.647, 0.824, -2.219, 109.547, -1.424,
    2.731, 0.792, -3.589, -1.946, -1.424, 106.131,
];
#[rustfmt::skip]
const ISOTROPIC: [f64; 36] = [
    297.571, 60.278, 58.784, 0.316, -3.669, 2.293,
    60.278, 294.613, 60.044, 3.769, 1.119, 0.598,
    58.784, 60.044, 299.169, -0.524, 1.424, -0.264,
    0.316, 3.769, -0.524, 117.958, 0.613, 1.185,
    -3.669, 1.119, 1.424, 0.613, 119.167, 0.279,
    2.293, 0.598, -0.264, 1.185, 0.279, 116.652,
];

fn packing(megapascals: &[f64; 36]) -> Stiffness {
    Stiffness(Matrix6::from_row_slice(megapascals) * 1e6)
}

fn fit(speeds: &[WaveSpeed]) -> SpeedFit {
    let density = Measured::exact(DENSITY);
    christoffel::moduli_from_speeds(speeds, density, Some(Vec3::z()), Conditions::at(50e3)).unwrap()
}

/// Speeds with errors of 0.05 %.
fn sharp(packing: &Stiffness, directions: &[Vec3]) -> Vec<WaveSpeed> {
    every_mode(packing, directions, 0.0005, &mut Random::new(1))
}

fn deviations(fitted: &SpeedFit, packing: &Stiffness) -> Vec<(Modulus, f64)> {
    let truth = grainlab_emt::Moduli::of_medium(&packing.transverse_isotropy());
    let covariance = fitted.observation.covariance.unwrap();
    let sigma = |m: Modulus| covariance[(m as usize, m as usize)].sqrt();
    let known = fitted.observation.moduli.known();
    known.map(|(m, value)| (m, (value - truth.get(m).unwrap()) / sigma(m))).collect()
}

#[test]
fn the_scatter_of_a_packing_is_a_departure_and_no_conflict_and_the_moduli_are_within_their_larger_errors() {
    for (stiffness, scatter) in [(ANISOTROPIC, 0.020), (ISOTROPIC, 0.0114)] {
        let packing = packing(&stiffness);
        let fitted = fit(&sharp(&packing, &thirteen()));
        assert_eq!((fitted.conflict, fitted.undetermined.len()), (None, 0));
        let departure = fitted.anisotropy_scatter.expect("a packing is no medium");
        assert!((departure / scatter - 1.0).abs() < 0.05, "{departure:?}");
        // All speeds have the same error, 0.05 %.
        let whole = (0.5 * departure).hypot(0.0005);
        assert!((whole / fitted.scatter().unwrap() - 1.0).abs() < 1e-3, "{departure:?}");
        for (modulus, sigma) in deviations(&fitted, &packing) {
            assert!(sigma.abs() < 3.0, "{modulus} is off by {sigma} sigma");
        }
    }
}

#[test]
fn a_departure_is_an_error_of_every_speed_but_not_of_the_density() {
    let packing = packing(&ANISOTROPIC);
    let mut speeds = sharp(&packing, &thirteen());
    let variances = |speeds: &[WaveSpeed], density| {
        let axis = Some(Vec3::z());
        let fitted = christoffel::moduli_from_speeds(speeds, density, axis, Conditions::at(50e3)).unwrap();
        (fitted.observation.covariance.unwrap(), fitted.observation.moduli)
    };
    let exact = Measured::exact(DENSITY);
    let (departed, moduli) = variances(&speeds, exact);
    let stated = fit(&speeds).chi_square.unwrap() / fit(&speeds).degrees_of_freedom as f64;
    // With errors as large as the scatter there is no departure, and the covariance is the same.
    speeds.iter_mut().for_each(|s| s.stddev = s.stddev.map(|e| e * stated.sqrt()));
    assert_eq!(fit(&speeds).anisotropy_scatter, None);
    let (agreed, _) = variances(&speeds, exact);
    assert!((departed - agreed).amax() < 1e-3 * agreed.amax());
    let blurred = Measured { value: DENSITY, stddev: 0.01 * DENSITY };
    let c33 = Modulus::C33 as usize;
    let (with_density, _) = variances(&sharp(&packing, &thirteen()), blurred);
    let expected = (0.01 * moduli.get(Modulus::C33).unwrap()).powi(2);
    assert!(((with_density - departed)[(c33, c33)] / expected - 1.0).abs() < 1e-9);
}

#[test]
fn what_a_packing_is_inferred_to_be_holds_although_it_departs() {
    let packing = packing(&ANISOTROPIC);
    let fitted = fit(&sharp(&packing, &thirteen()));
    let relaxed = grainlab_emt::model("relaxed").unwrap();
    let estimate = relaxed.infer(&fitted.observation, relaxed.default_calibration()).unwrap();
    // Counted: z 5.266, eps 0.0464.
    let covariance = estimate.covariance().unwrap();
    let (z, eps) = (estimate.structure.z.unwrap(), estimate.structure.eps.unwrap());
    assert!((z - 5.266).abs() < 3.0 * covariance[(2, 2)].sqrt(), "{z} {}", covariance[(2, 2)].sqrt());
    assert!((eps - 0.0464).abs() < 3.0 * covariance[(3, 3)].sqrt(), "{eps} {}", covariance[(3, 3)].sqrt());
    assert!(estimate.notes.iter().all(|w| w.severity() == Status::Ok), "{:?}", estimate.notes);
}

#[test]
fn speeds_that_scatter_more_than_those_of_a_packing_are_a_conflict() {
    let mut speeds = sharp(&packing(&ANISOTROPIC), &thirteen());
    let mut random = Random::new(2);
    speeds.iter_mut().for_each(|s| s.speed *= 1.0 + 0.04 * random.normal());
    let fitted = fit(&speeds);
    assert!(fitted.anisotropy_scatter.is_none() && fitted.conflict.is_some(), "{fitted:?}");
}

#[test]
fn one_speed_that_is_off_where_all_others_agree_is_no_departure() {
    let medium = packing(&ANISOTROPIC).transverse_isotropy().stiffness();
    let mut speeds = every_mode(&medium, &thirteen(), 0.0005, &mut Random::new(3));
    assert_eq!((fit(&speeds).conflict, fit(&speeds).anisotropy_scatter), (None, None));
    // 1 % is 20 standard deviations, and less than the scatter of a packing.
    speeds[9].speed *= 1.01;
    let conflict = fit(&speeds).conflict.expect("38 speeds say otherwise");
    assert!(conflict.worst == 9 && conflict.sigma > 15.0, "{conflict:?}");
}

/// The scatter of a packing turns its S modes. A single one of them could belong to either S mode of the
/// medium.
#[test]
fn two_s_waves_of_one_direction_may_be_turned_from_those_of_the_medium_and_one_alone_may_not() {
    let mut random = Random::new(4);
    let medium = packing(&ANISOTROPIC).transverse_isotropy();
    let stiffness = medium.stiffness();
    let mut speeds = every_mode(&stiffness, &thirteen(), 0.0005, &mut random);
    let exact = fit(&speeds);
    let turned = |speeds: &mut Vec<WaveSpeed>, at: [usize; 2], angle: f64| {
        let [a, b] = at.map(|i| speeds[i].polarization);
        let (sin, cos) = angle.sin_cos();
        let of = |p: &Vec3, n: &Vec3| (p.dot(&(stiffness.christoffel(n) * p)) / DENSITY).sqrt();
        for (i, p) in at.into_iter().zip([cos * a + sin * b, cos * b - sin * a]) {
            speeds[i].speed = of(&p, &speeds[i].direction);
            speeds[i].polarization = p;
        }
    };
    // Two S waves across the axis, at 45° to its modes.
    let across: Vec<usize> = (0..speeds.len())
        .filter(|i| {
            let s = &speeds[*i];
            s.direction.z.abs() < 1e-9 && s.direction.dot(&s.polarization).abs() < 0.1
        })
        .collect();
    turned(&mut speeds, [across[0], across[1]], std::f64::consts::FRAC_PI_4);
    let mixed = fit(&speeds);
    assert_eq!((mixed.conflict, mixed.anisotropy_scatter), (None, None));
    for (modulus, value) in mixed.observation.moduli.known() {
        let off = value / exact.observation.moduli.get(modulus).unwrap() - 1.0;
        assert!(off.abs() < 2e-3, "{modulus} {off}");
    }
    speeds.remove(across[1]);
    let alone = christoffel::moduli_from_speeds(
        &speeds,
        Measured::exact(DENSITY),
        Some(Vec3::z()),
        Conditions::at(50e3),
    );
    assert!(alone.unwrap_err().to_string().contains("45 degrees from the nearest mode"));
}

#[test]
fn a_speed_that_is_known_far_better_than_the_sample_scatters_does_not_outweigh_the_others() {
    let packing = packing(&ANISOTROPIC);
    let speeds = sharp(&packing, &thirteen());
    let moduli = |speeds: &[WaveSpeed]| fit(speeds).observation.moduli;
    let alike = moduli(&speeds);
    for sharper in 0..speeds.len() {
        let mut speeds = speeds.clone();
        speeds[sharper].stddev = speeds[sharper].stddev.map(|e| 1e-3 * e);
        for (modulus, value) in moduli(&speeds).known() {
            let moved = value / alike.get(modulus).unwrap() - 1.0;
            assert!(moved.abs() < 1e-3, "{modulus} moves by {moved} for speeds[{sharper}]");
        }
    }
}

/// Exact speeds along `n`, polarized in the plane of `n` and e3 as its modes are, and across it.
fn aligned(packing: &Stiffness, n: &Vec3) -> [WaveSpeed; 3] {
    let across = Vec3::z().cross(n).try_normalize(1e-9).unwrap_or_else(Vec3::y);
    let other = across.cross(n);
    let gamma = packing.christoffel(n);
    let of = |a: &Vec3, b: &Vec3| a.dot(&(gamma * b));
    let plane = nalgebra::Matrix2::new(of(n, n), of(n, &other), of(n, &other), of(&other, &other));
    let turn = plane.symmetric_eigen().eigenvectors;
    [n * turn[(0, 0)] + other * turn[(1, 0)], n * turn[(0, 1)] + other * turn[(1, 1)], across].map(|p| {
        let speed = (of(&p, &p) / DENSITY).sqrt();
        WaveSpeed { direction: *n, polarization: p, speed, stddev: Some(1e-5 * speed) }
    })
}

/// Deviations of the moduli of two packings of 2,000 grains in 36 orientations about e3, and the errors stated for C13.
fn turned(directions: &[Vec3]) -> (Vec<f64>, Vec<f64>) {
    let (mut all, mut stated) = (Vec::new(), Vec::new());
    for stiffness in [ANISOTROPIC, ISOTROPIC] {
        for turn in 0..18 {
            let turn = nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), f64::from(turn) * 0.35);
            let packing = packing(&stiffness).rotated(turn.matrix());
            let speeds: Vec<WaveSpeed> = directions.iter().flat_map(|n| aligned(&packing, n)).collect();
            let (density, axis) = (Measured::exact(DENSITY), Some(Vec3::z()));
            let conditions = Conditions::at(50e3);
            let fitted =
                christoffel::moduli_of_sample(&speeds, density, axis, conditions, Some(2000.0)).unwrap();
            assert_eq!((fitted.conflict, fitted.undetermined.len()), (None, 0));
            all.extend(deviations(&fitted, &packing).into_iter().map(|(_, sigma)| sigma));
            let c13 = Modulus::C13 as usize;
            stated.push(fitted.observation.covariance.unwrap()[(c13, c13)].sqrt());
        }
    }
    (all, stated)
}

#[test]
fn three_rays_have_errors_that_hold_and_rays_that_average_over_azimuths_have_far_smaller_ones() {
    let at = |theta: f64, azimuth: f64| {
        Vec3::new(theta.sin() * azimuth.cos(), theta.sin() * azimuth.sin(), theta.cos())
    };
    let (right, half) = (std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_4);
    let (few, few_stated) = turned(&[at(0.0, 0.0), at(right, 0.0), at(half, 0.0)]);
    let across = (0..3).map(|k| at(right, f64::from(k) * std::f64::consts::PI / 3.0));
    let between = (0..5).map(|k| at(half, f64::from(k) * std::f64::consts::TAU / 5.0));
    let complete: Vec<Vec3> = std::iter::once(Vec3::z()).chain(across).chain(between).collect();
    let (many, many_stated) = turned(&complete);
    for sigmas in [few, many] {
        let rms = (sigmas.iter().map(|s| s * s).sum::<f64>() / sigmas.len() as f64).sqrt();
        let worst = sigmas.iter().fold(0.0f64, |most, s| most.max(s.abs()));
        assert!((0.2..1.5).contains(&rms) && worst < 4.0, "{rms} {worst}");
    }
    let sum = |stated: Vec<f64>| stated.iter().sum::<f64>();
    assert!(sum(many_stated) < 0.3 * sum(few_stated));
}
