//! Exact speeds give exact moduli.

use super::laboratory::{DENSITY, PACKING, Sample, Wave, medium};
use grainlab_core::{TransverseIsotropy, WaveSpeed};
use grainlab_emt::{Conditions, Measured, Modulus, christoffel};
use grainlab_testkit::Random;
use grainlab_testkit::packings::mode_nearest;
use nalgebra::{DMatrix, Dyn, Rotation3, SVD};

const WAVES: [Wave; 10] = [
    Wave::P(0.0),
    Wave::Sv(0.0),
    Wave::P(90.0),
    Wave::Sh(90.0),
    Wave::Sv(90.0),
    Wave::P(45.0),
    Wave::Sv(45.0),
    Wave::Sh(45.0),
    Wave::P(25.0),
    Wave::Sv(70.0),
];

fn subsets() -> impl Iterator<Item = Vec<Wave>> {
    (1..1usize << WAVES.len())
        .map(|mask| (0..WAVES.len()).filter(|i| mask >> i & 1 == 1).map(|i| WAVES[i]).collect())
}

/// The medium with its C11, C33, C13, C44 and C66 changed, Pa.
fn changed(m: TransverseIsotropy, by: [f64; 5]) -> TransverseIsotropy {
    let (c11, g12) = (m.c11 + by[0], m.g12 + by[4]);
    let (c33, c13, g13) = (m.c33 + by[1], m.c13 + by[2], m.g13 + by[3]);
    TransverseIsotropy { c11, c12: c11 - 2.0 * g12, c13, c33, g13, g12, residual: 0.0 }
}

fn ln_speeds(sample: &Sample, waves: &[Wave]) -> Vec<f64> {
    waves.iter().map(|w| sample.exact(*w, 0.0).speed.ln()).collect()
}

/// Change of ln v of each wave with each modulus over its scale, by central differences of the dense solve.
fn slopes(sample: &Sample, waves: &[Wave], scale: &[f64; 5]) -> Vec<[f64; 5]> {
    let mut slopes = vec![[0.0; 5]; waves.len()];
    for j in 0..5 {
        let at = |relative: f64| {
            let mut by = [0.0; 5];
            by[j] = relative * scale[j];
            ln_speeds(&Sample::new(changed(sample.moduli, by), sample.frame), waves)
        };
        let (up, down) = (at(1e-4), at(-1e-4));
        for (row, (up, down)) in slopes.iter_mut().zip(up.iter().zip(down)) {
            row[j] = (up - down) / 2e-4;
        }
    }
    slopes
}

/// The part of each modulus, in the order of `Modulus::ALL`, that the speeds leave undetermined near this
/// medium; `None` if it is not clear, because some combination has a small but finite influence on the
/// speeds.
fn open_parts(sample: &Sample, waves: &[Wave]) -> Option<[f64; 6]> {
    let m = sample.moduli;
    let scale = [m.c11, m.c33, m.c13 + m.g13, m.g13, m.g12];
    let slopes = slopes(sample, waves, &scale);
    // At least square, so that the decomposition has all five directions.
    let jacobian = DMatrix::from_fn(waves.len().max(5), 5, |i, j| slopes.get(i).map_or(0.0, |row| row[j]));
    let svd: SVD<f64, Dyn, Dyn> = SVD::new(jacobian, false, true);
    let directions = svd.v_t.expect("asked for");
    let mut parts = [0.0f64; 6];
    for (k, value) in svd.singular_values.iter().enumerate() {
        match *value {
            5e-3.. => continue,
            1e-6.. => return None,
            _ => {}
        }
        let v: [f64; 5] = std::array::from_fn(|j| directions[(k, j)] * scale[j]);
        let theta = (4.0 * v[0] - 4.0 * v[4] + 4.0 * v[2] + v[1]) / 9.0;
        for (part, change) in parts.iter_mut().zip([v[4], v[3], theta, v[0], v[1], v[2]]) {
            *part = part.max(change.abs() / m.c33);
        }
    }
    Some(parts)
}

/// The moduli that a subset of the waves determines are recovered from its speeds, with exact motions and with those named by the
/// direction alone; the others are undetermined. At most 1 % of all subsets may leave more undetermined, because another medium
/// has the same speeds.
#[test]
fn every_subset_gives_back_what_it_determines_and_leaves_the_rest_open() {
    let mut random = Random::new(1);
    let (mut tried, mut complete, mut rivals) = (0, 0, 0);
    for n in 0..6 {
        let sample = Sample::new(medium(&mut random, 0.3), random.rotation());
        let speed = if n % 2 == 0 { Sample::exact } else { Sample::named };
        for waves in subsets() {
            let Some(open) = open_parts(&sample, &waves) else { continue };
            let speeds: Vec<_> =
                waves.iter().map(|w| speed(&sample, *w, random.between(0.0, 360.0))).collect();
            let fitted =
                sample.fit(&speeds).unwrap_or_else(|e| panic!("{e}: {waves:?} of {:?}", sample.moduli));
            let all_known = open.iter().all(|o| *o == 0.0);
            // Up to 0.3 % of a modulus may be undetermined where a combination is.
            let allowed = if all_known { 1e-10 } else { 3e-3 };
            let mut rivalled = false;
            for (modulus, open) in Modulus::ALL.into_iter().zip(open) {
                let case = || format!("{modulus} (open {open:.1e}) from {waves:?} of {:?}", sample.moduli);
                match fitted.observation.moduli.get(modulus) {
                    Some(value) => {
                        assert!(open < 1e-2, "not open: {}", case());
                        let error = (value - sample.truth(modulus)).abs() / sample.moduli.c33;
                        assert!(error < allowed, "off by {error:.1e}: {}", case());
                    }
                    None => rivalled |= open < 1e-3,
                }
            }
            // With both P speeds along the axes, only one medium fits.
            let unique = waves.contains(&Wave::P(0.0)) && waves.contains(&Wave::P(90.0)) && all_known;
            assert!(!(rivalled && unique), "open without need: {waves:?} of {:?}", sample.moduli);
            tried += 1;
            complete += usize::from(fitted.undetermined.is_empty());
            rivals += usize::from(rivalled);
        }
    }
    assert!(tried > 5000 && complete > 2000, "{tried} subsets tried, {complete} complete");
    assert!(100 * rivals < tried, "{rivals} of {tried} leave open what they determine");
}

#[test]
fn signs_of_directions_motions_and_axis_do_not_matter() {
    let mut random = Random::new(4);
    let sample = Sample::new(PACKING, random.rotation());
    let mut speeds: Vec<_> = WAVES.iter().map(|w| sample.exact(*w, random.between(0.0, 360.0))).collect();
    let before = sample.fit(&speeds).unwrap().observation.moduli;
    for (i, speed) in speeds.iter_mut().enumerate() {
        if i % 2 == 0 {
            speed.direction = -speed.direction;
        }
        if i % 3 == 0 {
            speed.polarization = -speed.polarization;
        }
    }
    let (density, conditions) = (Measured::exact(DENSITY), Conditions::at(50e3));
    let after = christoffel::moduli_from_speeds(&speeds, density, Some(-sample.axis()), conditions).unwrap();
    for (modulus, value) in after.observation.moduli.known() {
        assert!((value / before.get(modulus).unwrap() - 1.0).abs() < 1e-12, "{modulus}");
    }
}

#[test]
fn an_isotropic_medium_gives_isotropic_moduli() {
    let glass = TransverseIsotropy::of_constants(250e6, 250e6, 106e6, 72e6, 72e6);
    let mut random = Random::new(5);
    let sample = Sample::new(glass, random.rotation());
    // The dense solve gives arbitrary S polarizations in an isotropic medium, so they are given.
    let speeds: Vec<_> = WAVES
        .iter()
        .map(|wave| {
            let (direction, polarization) = sample.nominal(*wave, random.between(0.0, 360.0));
            let modulus = if matches!(wave, Wave::P(_)) { 250e6 } else { 72e6f64 };
            WaveSpeed { direction, polarization, speed: (modulus / DENSITY).sqrt(), stddev: None }
        })
        .collect();
    let fitted = sample.fit(&speeds).unwrap();
    assert!(fitted.undetermined.is_empty());
    for (modulus, value) in fitted.observation.moduli.known() {
        assert!((value / sample.truth(modulus) - 1.0).abs() < 1e-12, "{modulus}");
    }
}

/// Four azimuths determine the projection of a slightly orthotropic stiffness: its departure from isotropy
/// about the axis enters only squared.
#[test]
fn equivalent_directions_average_to_the_projection_on_an_isotropic_plane() {
    for asymmetry in [0.04, 0.02, 0.01] {
        let mut stiffness = PACKING.stiffness();
        for (i, sign) in [(0, 1.0), (1, -1.0), (3, 1.0), (4, -1.0), (5, -1.0)] {
            stiffness.0[(i, i)] *= 1.0 + sign * asymmetry;
        }
        let projected = grainlab_emt::Moduli::of_medium(&stiffness.transverse_isotropy());
        let sample = Sample { moduli: PACKING, stiffness, frame: Rotation3::identity() };
        let waves =
            [Wave::P(0.0), Wave::Sv(0.0), Wave::P(90.0), Wave::Sh(90.0), Wave::Sv(90.0), Wave::P(45.0)];
        let speeds: Vec<_> = waves
            .iter()
            .flat_map(|wave| [0.0, 45.0, 90.0, 135.0].map(|azimuth| sample.nominal(*wave, azimuth)))
            .map(|(direction, polarization)| {
                let (modulus, _) = mode_nearest(&stiffness, &direction, &polarization);
                WaveSpeed { direction, polarization, speed: (modulus / DENSITY).sqrt(), stddev: None }
            })
            .collect();
        let fitted = sample.fit(&speeds).unwrap();
        for (modulus, value) in fitted.observation.moduli.known() {
            let error = value / projected.get(modulus).unwrap() - 1.0;
            assert!(error.abs() < 3.0 * asymmetry * asymmetry, "{modulus} at {asymmetry}: {error:.1e}");
        }
        let scatter = fitted.scatter().unwrap();
        assert!(scatter > 0.2 * asymmetry && scatter < asymmetry, "what is averaged shows: {scatter}");
    }
}

#[test]
fn a_fit_is_an_observation_that_every_model_takes() {
    let sample = Sample::new(PACKING, Rotation3::identity());
    let speeds: Vec<_> = WAVES
        .iter()
        .map(|w| sample.exact(*w, 0.0))
        .map(|s| WaveSpeed { stddev: Some(0.003 * s.speed), ..s })
        .collect();
    let fitted = sample.fit(&speeds).unwrap();
    let checked = fitted.observation.checked().unwrap();
    assert!(checked.moduli.imbalance().unwrap().abs() < 1e-12);
    let estimate = grainlab_emt::model("ratio")
        .unwrap()
        .infer(&fitted.observation, &grainlab_emt::Calibration::PAPER)
        .unwrap();
    let direct = grainlab_emt::Observation::of_stiffness(&sample.stiffness, Conditions::at(50e3));
    let direct =
        grainlab_emt::model("ratio").unwrap().infer(&direct, &grainlab_emt::Calibration::PAPER).unwrap();
    let [found, expected] = [&estimate, &direct].map(|e| e.structure.k.unwrap());
    assert!(
        (found - expected).abs() < 1e-9
            && estimate.stddev(grainlab_core::results::InferredQuantity::K).unwrap() > 0.0
    );
}

/// P and SV at 45° fix (C11 + C33)/2 + C44 and ((C11 − C33)/2)² + (C13 + C44)². With P along the axis one
/// number remains for an SV at 70°, and its speed is not a monotone function of that number.
#[test]
fn what_two_media_with_the_same_speeds_differ_in_is_left_open() {
    let m = TransverseIsotropy::of_constants(220e6, 287e6, 133e6, 87e6, 60e6);
    let waves = [Wave::P(0.0), Wave::Sh(90.0), Wave::P(45.0), Wave::Sv(45.0), Wave::Sv(70.0)];
    let sample = Sample::new(m, Rotation3::identity());
    let with_shear = |g13: f64| {
        let c11 = m.c11 + 2.0 * (m.g13 - g13);
        let fixed = 0.25 * (m.c11 - m.c33).powi(2) + (m.c13 + m.g13).powi(2);
        let c13 = (fixed - 0.25 * (c11 - m.c33).powi(2)).sqrt() - g13;
        Sample::new(changed(m, [c11 - m.c11, 0.0, c13 - m.c13, g13 - m.g13, 0.0]), sample.frame)
    };
    let too_fast = |g13: f64| with_shear(g13).exact(waves[4], 0.0).speed - sample.exact(waves[4], 0.0).speed;
    let (mut low, mut high) = (100e6, 135e6);
    assert!(too_fast(low) * too_fast(high) < 0.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if too_fast(middle) * too_fast(low) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let other = with_shear(low);
    for wave in waves {
        let [a, b] = [&sample, &other].map(|s| s.exact(wave, 0.0).speed);
        assert!((a / b - 1.0).abs() < 1e-12, "{wave:?} has one speed in both: {a} {b}");
    }
    for speeds in [waves.map(|w| sample.exact(w, 0.0)), waves.map(|w| other.named(w, 0.0))] {
        let fitted = sample.fit(&speeds).unwrap();
        assert_eq!(fitted.undetermined, [Modulus::G13, Modulus::Theta, Modulus::C11, Modulus::C13]);
        let value = fitted.observation.moduli.get(Modulus::G12).unwrap();
        assert!((value / m.g12 - 1.0).abs() < 1e-10);
    }
    // An S speed along the axis selects one.
    let more: Vec<_> = waves.iter().chain(&[Wave::Sv(0.0)]).map(|w| sample.exact(*w, 0.0)).collect();
    assert!(sample.fit(&more).unwrap().undetermined.is_empty());
}
