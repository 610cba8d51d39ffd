//! Sets of speeds: without an axis, of one kind of wave, and of a sample that is not exactly a medium.

use crate::moduli::s1_medium;
use crate::of_data;
use crate::speeds::{DENSITY, answer, upright, wire};
use grainlab_core::{Stiffness, TransverseIsotropy, Vec3};
use grainlab_emt_inversion::{Axis, Settings, microstructure_of_speeds};
use grainlab_msgs::geometry_msgs::Vector3;
use grainlab_msgs::msg::{Estimate, WaveSpeed, WaveSpeeds};
use nalgebra::Rotation3;

const FOUND: Axis = Axis::Found;

/// P and both S of `stiffness` in thirteen directions, with an error of 0.1 %; no axis is stated.
fn everywhere(stiffness: &Stiffness) -> WaveSpeeds {
    let steps = || (-1..=1).map(f64::from);
    let all = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])));
    let mut speeds = Vec::new();
    for direction in all.filter(|v| *v > [0.0; 3]).map(|v| Vec3::from(v).normalize()) {
        let waves = stiffness.plane_waves(&direction);
        for (modulus, motion) in waves.moduli.into_iter().zip(waves.polarizations) {
            let speed = (modulus / DENSITY).sqrt();
            let (direction, polarization) = (wire(&direction), wire(&motion));
            let speed_stddev = 0.001 * speed;
            speeds.push(WaveSpeed { direction, polarization, speed, speed_stddev, ..WaveSpeed::default() });
        }
    }
    WaveSpeeds { axis: Vector3::default(), speeds, ..upright() }
}

fn says(estimate: &Estimate, words: &str) -> bool {
    estimate.warnings.iter().any(|w| w.contains(words))
}

/// The estimate of every model, with its name.
fn all(speeds: &WaveSpeeds) -> impl Fn(&str) -> Estimate + use<> {
    let message = microstructure_of_speeds(speeds, &Settings::default()).message;
    move |model| message.estimates.iter().find(|e| e.model == model).unwrap().clone()
}

#[test]
fn an_unknown_axis_is_inferred_from_the_speeds_if_set() {
    let turn = Rotation3::from_euler_angles(0.7, -0.4, 0.2);
    let lying = everywhere(&s1_medium().rotated(turn.matrix()));
    let expected = answer(&upright(), &Settings::default());
    let e = answer(&lying, &Settings { axis: FOUND, ..Settings::default() });
    assert!((e.k[0] - expected.k[0]).abs() < 1e-5 && (e.eps[0] - expected.eps[0]).abs() < 1e-6, "{e:?}");
    assert_eq!(e.status, Estimate::STATUS_OK);
    let axis = turn * Vec3::z();
    let named = format!("no axis was named: ({:.4}, {:.4}, {:.4}) was found", axis.x, axis.y, axis.z);
    assert!(says(&e, &named) && says(&e, "degrees (one sigma)"), "{:?}", e.warnings);
    // By default e3 is used; a note states that another axis fits better.
    let e = answer(&lying, &Settings::default());
    assert!(!says(&e, "was found") && (e.eps[0] - expected.eps[0]).abs() > 1e-3, "{e:?}");
    assert!(says(&e, "fit another axis better") && e.status == Estimate::STATUS_CONTRADICTORY, "{e:?}");
    // A stated axis is used.
    let named = WaveSpeeds { axis: wire(&axis), ..lying };
    assert!(!says(&answer(&named, &Settings { axis: FOUND, ..Settings::default() }), "no axis was named"));
}

#[test]
fn a_medium_that_looks_isotropic_gets_e3_and_a_note() {
    let (p, s) = (300e6, 120e6);
    let isotropic = TransverseIsotropy::of_constants(p, p, p - 2.0 * s, s, s);
    let e = answer(&everywhere(&isotropic.stiffness()), &Settings { axis: FOUND, ..Settings::default() });
    assert!(!e.eps.is_empty() && e.eps[0].abs() < 1e-6 && e.status == Estimate::STATUS_OK, "{e:?}");
    assert!(says(&e, "e3 was taken") && says(&e, "any axis would serve"), "{:?}", e.warnings);
}

#[test]
fn a_sample_that_is_not_quite_a_medium_is_noted_and_no_conflict() {
    // 1.5 % of one shear modulus, the variation with azimuth in a packing of some thousand grains.
    let mut stiffness = s1_medium();
    stiffness.0[(3, 3)] *= 1.015;
    stiffness.0[(4, 4)] /= 1.015;
    let e = answer(&everywhere(&stiffness), &Settings::default());
    assert!(says(&e, "the sample is not quite one") && !says(&e, "contradict"), "{:?}", e.warnings);
    assert!(!says(&e, "fit another axis better"), "{:?}", e.warnings);
    assert_eq!(e.status, Estimate::STATUS_OK);
    let exact = answer(&everywhere(&s1_medium()), &Settings::default());
    assert!(of_data(&e, 18) > 4.0 * of_data(&exact, 18), "{} {}", of_data(&e, 18), of_data(&exact, 18));
    assert!((e.eps[0] - exact.eps[0]).abs() < 3.0 * e.covariance[18].sqrt());
}

#[test]
fn one_wave_tells_the_relaxed_network_z_and_that_eps_is_open() {
    for at in [0, 1, 2, 4] {
        let mut one = upright();
        one.speeds = vec![one.speeds.swap_remove(at)];
        let of = all(&one);
        let relaxed = of("relaxed");
        assert!(
            !relaxed.z.is_empty() && relaxed.eps.is_empty() && relaxed.eps_stiffness.is_empty(),
            "{at} {relaxed:?}"
        );
        assert!(says(&relaxed, "the data do not determine eps"), "{at} {:?}", relaxed.warnings);
        for model in ["ratio", "directional", "emt"] {
            let e = of(model);
            assert!(e.status == Estimate::STATUS_UNKNOWN && says(&e, "needs"), "{at} {e:?}");
        }
    }
}

#[test]
fn what_the_instrument_warns_of_reaches_every_estimate() {
    let warned = WaveSpeeds { warnings: vec!["speeds[3] was picked by hand".into()], ..upright() };
    let message = microstructure_of_speeds(&warned, &Settings::default()).message;
    for e in &message.estimates {
        assert!(says(e, "the instrument reports: speeds[3] was picked by hand"), "{e:?}");
    }
}
