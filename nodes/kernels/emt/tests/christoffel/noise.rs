//! Speeds with errors.

use super::laboratory::{DENSITY, PACKING, Sample, Wave};
use grainlab_core::WaveSpeed;
use grainlab_emt::christoffel::{self, SpeedFit};
use grainlab_emt::{Conditions, MODULI, Measured, ModuliCovariance, Modulus};
use grainlab_testkit::Random;
use nalgebra::{Rotation3, SMatrix, SVector};

/// The smallest set with redundancy for every modulus: speeds along the axes, and a pair between them.
const SIX: [Wave; 6] =
    [Wave::P(0.0), Wave::P(90.0), Wave::Sh(90.0), Wave::Sv(0.0), Wave::P(45.0), Wave::Sv(45.0)];

/// C11, C33, C13, G13 and G12, from which Θ follows.
const FIVE: [Modulus; 5] = [Modulus::C11, Modulus::C33, Modulus::C13, Modulus::G13, Modulus::G12];

fn sample() -> Sample {
    Sample::new(PACKING, Rotation3::from_euler_angles(0.4, -1.1, 2.0))
}

fn exact(waves: &[Wave]) -> Vec<WaveSpeed> {
    let sample = sample();
    waves.iter().enumerate().map(|(i, w)| sample.named(*w, 50.0 * i as f64)).collect()
}

/// Speeds with relative errors of these standard deviations, stated as uncertainties.
fn with_errors(speeds: &[WaveSpeed], relative: &[f64], random: &mut Random) -> Vec<WaveSpeed> {
    let measure = |(speed, relative): (&WaveSpeed, &f64)| {
        let stddev = relative * speed.speed;
        WaveSpeed { speed: speed.speed + stddev * random.normal(), stddev: Some(stddev), ..*speed }
    };
    speeds.iter().zip(relative.iter().cycle()).map(measure).collect()
}

fn errors(fitted: &SpeedFit) -> SVector<f64, MODULI> {
    let sample = sample();
    SVector::from(Modulus::ALL.map(|m| fitted.observation.moduli.get(m).unwrap() - sample.truth(m)))
}

fn covariance(fitted: &SpeedFit) -> ModuliCovariance {
    fitted.observation.covariance.unwrap()
}

fn five<const C: usize>(m: &SMatrix<f64, MODULI, C>) -> SMatrix<f64, 5, C> {
    SMatrix::from_fn(|i, j| m[(FIVE[i] as usize, j)])
}

/// Means over many draws of χ² and of the squared distance of the moduli from the truth weighted by their
/// inverse covariance, and the fraction of conflicts.
fn scatter(waves: &[Wave], relative: &[f64]) -> [f64; 3] {
    const DRAWS: usize = 3000;
    let (mut random, speeds) = (Random::new(7), exact(waves));
    let mut sums = [0.0; 3];
    for _ in 0..DRAWS {
        let fitted = sample().fit(&with_errors(&speeds, relative, &mut random)).unwrap();
        let stated = five(&five(&covariance(&fitted)).transpose());
        let error = five(&errors(&fitted));
        sums[0] += fitted.chi_square.unwrap();
        sums[1] += error.dot(&stated.cholesky().unwrap().solve(&error));
        sums[2] += f64::from(u8::from(fitted.conflict.is_some()));
    }
    sums.map(|s| s / DRAWS as f64)
}

/// Four standard deviations of the mean of 3,000 χ².
fn allowed(freedom: f64) -> f64 {
    4.0 * (2.0 * freedom / 3000.0).sqrt()
}

#[test]
fn redundant_speeds_have_the_chi_square_of_their_degrees_of_freedom() {
    let more =
        [&SIX[..], &[Wave::Sv(90.0), Wave::Sh(45.0), Wave::P(25.0), Wave::P(70.0), Wave::Sv(20.0)]].concat();
    for relative in [&[0.003][..], &[0.001, 0.01, 0.003]] {
        let [chi_square, distance, conflicts] = scatter(&more, relative);
        assert!((chi_square - 6.0).abs() < allowed(6.0), "{chi_square}");
        assert!((distance - 5.0).abs() < allowed(5.0), "{distance}");
        assert!(conflicts < 0.004, "{conflicts}");
    }
}

#[test]
fn both_modes_between_the_axes_give_the_bulk_modulus_half_again_as_well_as_one() {
    let relative = |waves: &[Wave]| {
        let speeds = with_errors(&exact(waves), &[0.003], &mut Random::new(1));
        let fitted = sample().fit(&speeds).unwrap();
        let i = Modulus::Theta as usize;
        covariance(&fitted)[(i, i)].sqrt() / sample().truth(Modulus::Theta)
    };
    let (pair, alone) = (relative(&SIX), relative(&SIX[..5]));
    // An error of 0.3 % of every speed is one of 0.66 % of the bulk modulus.
    assert!((pair - 0.0066).abs() < 0.0003, "{pair}");
    assert!((alone / pair - 1.45).abs() < 0.05, "{alone} {pair}");
}

#[test]
fn an_error_of_the_density_moves_all_moduli_together() {
    let speeds = with_errors(&exact(&SIX), &[0.001], &mut Random::new(2));
    let at = |density| {
        christoffel::moduli_from_speeds(&speeds, density, Some(sample().axis()), Conditions::at(50e3))
            .unwrap()
    };
    let sharp = at(Measured::exact(DENSITY));
    let blurred = at(Measured { value: DENSITY, stddev: 0.02 * DENSITY });
    assert_eq!(sharp.observation.moduli, blurred.observation.moduli);
    let moduli = SVector::from(Modulus::ALL.map(|m| sharp.observation.moduli.get(m).unwrap()));
    let expected = covariance(&sharp) + moduli * moduli.transpose() * 0.02f64.powi(2);
    assert!((covariance(&blurred) - expected).amax() < 1e-12 * expected.amax());
    // An error of 2 % of the density is one of 2 % of each modulus, and none of a ratio.
    let correlation = |a: Modulus, b: Modulus| {
        let c = covariance(&blurred);
        let (i, j) = (a as usize, b as usize);
        c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt()
    };
    assert!(correlation(Modulus::G12, Modulus::G13) > 0.98 && correlation(Modulus::C11, Modulus::C33) > 0.98);
}

#[test]
fn repeated_speeds_count_by_their_errors() {
    let one = exact(&[Wave::P(0.0)])[0];
    let [near, far] =
        [(401.0, 1.0), (407.0, 2.0)].map(|(speed, stddev)| WaveSpeed { speed, stddev: Some(stddev), ..one });
    let fitted = sample().fit(&[near, far]).unwrap();
    let mean: f64 = (401.0 / 1.0 + 407.0 / 4.0) / (1.0 + 0.25);
    let i = Modulus::C33 as usize;
    let c33 = fitted.observation.moduli.get(Modulus::C33).unwrap();
    assert!((c33 / (DENSITY * mean * mean) - 1.0).abs() < 1e-12);
    let variance: f64 = 1.0 / 1.25;
    let stddev = 2.0 * DENSITY * mean * variance.sqrt();
    assert!((covariance(&fitted)[(i, i)].sqrt() / stddev - 1.0).abs() < 1e-12);
    assert!((fitted.chi_square.unwrap() - 36.0 / 5.0).abs() < 1e-9);
    assert_eq!((fitted.degrees_of_freedom, fitted.assumed), (1, 0));
}

#[test]
fn without_errors_speeds_count_alike_and_moduli_have_no_covariance() {
    let mut random = Random::new(3);
    let more = [SIX, SIX.map(|w| w), SIX].concat();
    let mut speeds = with_errors(&exact(&more), &[0.003], &mut random);
    for speed in &mut speeds {
        speed.stddev = None;
    }
    let fitted = sample().fit(&speeds).unwrap();
    assert_eq!((fitted.observation.covariance, fitted.chi_square, fitted.conflict), (None, None, None));
    assert_eq!((fitted.degrees_of_freedom, fitted.assumed), (13, 0));
    let scatter = fitted.scatter().unwrap();
    assert!(scatter > 0.0015 && scatter < 0.0045, "{scatter}");
    let mut stated = speeds.clone();
    stated.iter_mut().for_each(|s| s.stddev = Some(0.02 * s.speed));
    let with = sample().fit(&stated).unwrap();
    for (modulus, value) in with.observation.moduli.known() {
        let without = fitted.observation.moduli.get(modulus).unwrap();
        assert!((value / without - 1.0).abs() < 1e-9, "{modulus}");
    }
}

#[test]
fn a_speed_without_an_error_is_taken_as_no_better_than_the_worst() {
    let mut speeds = with_errors(&exact(&SIX), &[0.001, 0.004], &mut Random::new(4));
    speeds[2].stddev = Some(0.004 * speeds[2].speed);
    let stated = sample().fit(&speeds).unwrap();
    speeds[2].stddev = None;
    let assumed = sample().fit(&speeds).unwrap();
    assert_eq!((stated.assumed, assumed.assumed), (0, 1));
    let (a, b) = (covariance(&stated), covariance(&assumed));
    assert!((a - b).amax() < 1e-2 * a.amax(), "0.4 % of a speed drawn is 0.4 % of it, not of the exact one");
}

/// At 30 % no claim holds; the result must still be an estimate, or an error with its reason.
#[test]
fn useless_speeds_do_no_harm() {
    let mut random = Random::new(6);
    let (mut answers, mut refusals) = (0, 0);
    for relative in [0.05, 0.3, 1.0, 3.0] {
        for _ in 0..500 {
            let mut speeds = with_errors(&exact(&SIX), &[relative], &mut random);
            speeds.iter_mut().for_each(|s| s.speed = s.speed.abs());
            match sample().fit(&speeds) {
                Ok(fitted) => {
                    answers += 1;
                    assert!(fitted.observation.moduli.known().all(|(_, value)| value.is_finite()));
                    assert!(covariance(&fitted).iter().all(|c| c.is_finite()));
                    assert!(fitted.observation.checked().is_ok(), "{fitted:?}");
                }
                Err(_) => refusals += 1,
            }
        }
    }
    assert!(answers > 500 && refusals > 100, "{answers} {refusals}");
}
