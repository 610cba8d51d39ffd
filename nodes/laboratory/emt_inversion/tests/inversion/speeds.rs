//! S1 as measured by an acoustic instrument.

use crate::moduli::{s1_medium, s1_stiffness};
use crate::{of_data, of_packing, of_ratio, s1};
use grainlab_core::{Stiffness, Vec3};
use grainlab_emt_inversion::{Axis, Settings, microstructure_of_speeds};
use grainlab_msgs::geometry_msgs::Vector3;
use grainlab_msgs::msg::{Estimate, WaveSpeed, WaveSpeeds};
use nalgebra::Rotation3;

pub(crate) const DENSITY: f64 = 1590.0;

pub(crate) fn wire(v: &Vec3) -> Vector3 {
    Vector3 { x: v.x, y: v.y, z: v.z }
}

/// The speed of the mode with this polarization in `stiffness`, with an error of half a percent.
fn wave(stiffness: &Stiffness, direction: Vec3, motion: Vec3) -> WaveSpeed {
    let (direction, motion) = (direction.normalize(), motion.normalize());
    let waves = stiffness.plane_waves(&direction);
    let along = |k: &usize| waves.polarizations[*k].dot(&motion).abs();
    let nearest = (0..3).max_by(|a, b| along(a).total_cmp(&along(b))).unwrap();
    let speed = (waves.moduli[nearest] / DENSITY).sqrt();
    WaveSpeed {
        method: WaveSpeed::METHOD_DISPERSION,
        direction: wire(&direction),
        polarization: wire(&motion),
        speed,
        speed_stddev: 0.005 * speed,
        ..WaveSpeed::default()
    }
}

/// P and S along and across the axis, and P in between; the sample is rotated by `turn`.
fn heard(turn: &Rotation3<f64>) -> WaveSpeeds {
    let (x, y, z) = (Vec3::x(), Vec3::y(), Vec3::z());
    let stiffness = s1_medium().rotated(turn.matrix());
    let waves = [(z, z), (x, x), (z, x), (x, z), (x, y), (x + z, x + z)];
    WaveSpeeds {
        header: s1().header,
        source_step: 42,
        density: DENSITY,
        pressure: 50e3,
        solid_fraction: 0.636,
        axis: wire(&(turn * z)),
        grain_shear_modulus: 29e9,
        grain_poisson_ratio: 0.2,
        contact_law: "hertz_mindlin".into(),
        speeds: waves.iter().map(|(n, p)| wave(&stiffness, turn * n, turn * p)).collect(),
        ..WaveSpeeds::default()
    }
}

pub(crate) fn upright() -> WaveSpeeds {
    heard(&Rotation3::identity())
}

pub(crate) fn answer(speeds: &WaveSpeeds, settings: &Settings) -> Estimate {
    of_ratio(microstructure_of_speeds(speeds, settings).message)
}

#[test]
fn speeds_give_what_the_moduli_of_the_same_medium_give() {
    let message = microstructure_of_speeds(&upright(), &Settings::default()).message;
    assert_eq!(
        (&message.header, message.source_step, message.source.as_str()),
        (&s1().header, 42, "wave_speeds")
    );
    let mut silent = s1_stiffness();
    silent.strain_ratios = Default::default();
    let (heard, told) = (of_ratio(message), of_packing(&silent, &Settings::default()));
    assert!(
        (heard.k[0] - told.k[0]).abs() < 1e-6 && (heard.k_hat[0] - told.k_hat[0]).abs() < 1e-6,
        "{heard:?}"
    );
    assert!((heard.eps[0] - told.eps[0]).abs() < 1e-7, "{} {}", heard.eps[0], told.eps[0]);
    assert_eq!(heard.gamma_over_delta_source, "zero", "an instrument knows no strain ratio");
    // Six speeds determine five moduli, of which the model uses three for its three unknowns.
    assert_eq!(heard.degrees_of_freedom, 1);
    assert!(heard.chi_square < 1e-9 && heard.status == Estimate::STATUS_OK, "{heard:?}");
}

#[test]
fn the_error_is_that_of_the_speeds_and_the_density_else_that_of_the_settings() {
    let none = Settings { modulus_error: 0.0, ..Settings::default() };
    let stated = answer(&upright(), &none);
    let mut twice = upright();
    twice.speeds.iter_mut().for_each(|s| s.speed_stddev *= 2.0);
    let ratio = of_data(&answer(&twice, &none), 0) / of_data(&stated, 0);
    assert!((ratio - 4.0).abs() < 1e-6, "{ratio}");
    // The density changes all moduli together: k follows them, and ε and k̂ depend only on ratios.
    let dense = answer(&WaveSpeeds { density_stddev: 0.02 * DENSITY, ..upright() }, &none);
    assert!(dense.covariance[0] > stated.covariance[0] + 0.9 * (0.02 * dense.k[0]).powi(2), "{dense:?}");
    for at in [6, 18] {
        assert!((of_data(&dense, at) / of_data(&stated, at) - 1.0).abs() < 1e-6, "{at}");
    }
    let mut unknown = upright();
    unknown.speeds.iter_mut().for_each(|s| s.speed_stddev = 0.0);
    let exact = answer(&unknown, &none);
    assert_eq!(exact.covariance, exact.covariance_model, "the error of the model alone");
    let assumed = answer(&unknown, &Settings::default());
    let of_moduli = of_packing(&s1_stiffness(), &Settings::default());
    assert!(
        (of_data(&assumed, 6) / of_data(&of_moduli, 6) - 1.0).abs() < 1e-4,
        "as for moduli without errors"
    );
    // A single speed without an error gets the largest one of the others, and there is a note.
    let mut one = upright();
    one.speeds[0].speed_stddev = 0.0;
    let one = answer(&one, &Settings::default());
    assert!(one.warnings.iter().any(|w| w.starts_with("1 of 6 wave speeds")), "{:?}", one.warnings);
}

#[test]
fn a_missing_speed_leaves_what_hangs_on_it_unknown_and_the_rest_known() {
    let whole = answer(&upright(), &Settings::default());
    let without = |missing: &[usize]| {
        let mut speeds = upright();
        let mut index = 0..;
        speeds.speeds.retain(|_| !missing.contains(&index.next().unwrap()));
        answer(&speeds, &Settings::default())
    };
    // Without the oblique wave C13, Θ, and so the coordination number are undetermined.
    let e = without(&[5]);
    assert_eq!((!e.k.is_empty(), !e.k_hat.is_empty(), !e.eps.is_empty()), (false, false, true));
    assert!((e.eps[0] - whole.eps[0]).abs() < 1e-7 && e.status == Estimate::STATUS_EXTRAPOLATED, "{e:?}");
    assert!(
        e.warnings.iter().any(|w| w == "the wave speeds do not determine Theta, C13"),
        "{:?}",
        e.warnings
    );
    // Without the S wave across the plane G12 is undetermined, and `ratio` has no result.
    let e = without(&[4]);
    assert_eq!((e.status, !e.k.is_empty(), !e.eps.is_empty()), (Estimate::STATUS_UNKNOWN, false, false));
    assert!(
        e.warnings[0].contains("needs G12") && e.warnings[1].contains("do not determine"),
        "{:?}",
        e.warnings
    );
    let e = without(&[0, 1, 2, 3, 4, 5]);
    assert!(e.status == Estimate::STATUS_UNKNOWN && e.warnings[0].contains("no wave speeds"), "{e:?}");
}

#[test]
fn speeds_that_contradict_each_other_say_so_and_name_the_worst() {
    let mut speeds = upright();
    // Two waves give the modulus G13, and one of them is off by eight standard deviations.
    speeds.speeds[3].speed *= 1.04;
    let e = answer(&speeds, &Settings::default());
    let conflict =
        e.warnings.iter().find(|w| w.contains("contradict each other")).unwrap_or_else(|| panic!("{e:?}"));
    assert!(conflict.contains("speeds[2]") || conflict.contains("speeds[3]"), "{conflict}");
    assert_eq!((e.status, e.degrees_of_freedom), (Estimate::STATUS_CONTRADICTORY, 1));
    // (8 sigma)² between two equal weights.
    assert!((e.chi_square - 32.0).abs() < 2.0, "{}", e.chi_square);
    // Within two standard deviations there is no warning.
    let mut speeds = upright();
    speeds.speeds[3].speed *= 1.01;
    let e = answer(&speeds, &Settings::default());
    assert!(e.status == Estimate::STATUS_OK && (e.chi_square - 2.0).abs() < 0.2, "{e:?}");
}

#[test]
fn a_sample_on_its_side_is_heard_about_its_own_axis() {
    let turn = Rotation3::from_euler_angles(0.7, -0.4, 0.2);
    let (standing, lying) = (upright(), heard(&turn));
    let expected = answer(&standing, &Settings::default());
    for axis in [Axis::Found, Axis::Given(turn * Vec3::z())] {
        let e = answer(&lying, &Settings { axis, ..Settings::default() });
        assert!(
            (e.k[0] - expected.k[0]).abs() < 1e-5 && (e.eps[0] - expected.eps[0]).abs() < 1e-6,
            "{axis:?} {e:?}"
        );
    }
    let nameless = WaveSpeeds { axis: Vector3::default(), ..standing.clone() };
    assert_eq!(answer(&nameless, &Settings::default()), expected, "e3 is e3");
    let e = answer(&nameless, &Settings { axis: Axis::Found, ..Settings::default() });
    let said = &e.warnings[0];
    assert!(e.status == Estimate::STATUS_UNKNOWN && said.contains("cannot determine 7 unknowns"), "{e:?}");
    assert!(said.contains("no axis was named, and none was found"), "{said}");
}

#[test]
fn an_axis_that_is_not_the_one_the_instrument_names_is_mentioned() {
    let other = WaveSpeeds { axis: wire(&Vec3::x()), ..upright() };
    let e = answer(&other, &Settings::default());
    assert!(e.warnings.iter().any(|w| w.contains("the data name (1.000, 0.000, 0.000)")), "{:?}", e.warnings);
    let e = answer(&upright(), &Settings::default());
    assert!(!e.warnings.iter().any(|w| w.contains("the data name")), "{:?}", e.warnings);
}

#[test]
fn speeds_of_no_medium_are_answered_with_the_reason() {
    // P is slower than S across the axis: C11 < G12.
    let mut swapped = upright();
    swapped.speeds[1].speed = 150.0;
    let e = answer(&swapped, &Settings::default());
    assert!(e.status == Estimate::STATUS_UNKNOWN && !e.warnings.is_empty(), "{e:?}");
}

#[test]
fn what_is_refused_is_answered_too_with_its_name_its_stamp_and_the_reason() {
    type Break = fn(&mut WaveSpeeds);
    let faults: [(Break, &str); 9] = [
        (|m| m.speeds[2].speed = -1.0, "WaveSpeeds.speeds[2].speed = -1.0 is refused"),
        (|m| m.speeds[0].speed = f64::NAN, "WaveSpeeds.speeds[0].speed = NaN is refused"),
        (|m| m.speeds[0].method = 250, "WaveSpeeds.speeds[0].method = 250 is refused"),
        (|m| m.density = 0.0, "WaveSpeeds.density = 0.0 is refused"),
        (|m| m.axis.z = 2.0, "WaveSpeeds.|axis| = 2.0 is refused"),
        (|m| m.grain_shear_modulus = 0.0, "WaveSpeeds.grain_shear_modulus = 0.0 is refused"),
        (|m| m.pressure_stddev = f64::INFINITY, "WaveSpeeds.pressure_stddev = inf is refused"),
        (|m| m.contact_law = "hooke".into(), "WaveSpeeds.contact_law is refused"),
        (|m| m.header.stamp.nanosec = u32::MAX, "WaveSpeeds.header.stamp.nanosec = 4294967295.0 is refused"),
    ];
    for (fault, reason) in faults {
        let mut broken = WaveSpeeds { name: "beads 3".into(), ..upright() };
        fault(&mut broken);
        let answer = microstructure_of_speeds(&broken, &Settings::default());
        assert!(answer.refused.unwrap().to_string().starts_with(reason), "{reason}");
        let m = answer.message;
        assert_eq!((&m.header, m.name.as_str(), m.source_step), (&broken.header, "beads 3", 42), "{reason}");
        assert_eq!(m.estimates.len(), Settings::default().models.len());
        for e in &m.estimates {
            assert_eq!(e.status, Estimate::STATUS_UNKNOWN);
            assert!(e.warnings[0].starts_with(reason), "{:?}", e.warnings);
        }
        assert!(m.results().is_ok(), "a reader takes the answer: {reason}");
    }
    let answer =
        microstructure_of_speeds(&WaveSpeeds { name: "sand".into(), ..upright() }, &Settings::default());
    assert_eq!((answer.refused, answer.message.name.as_str()), (None, "sand"));
}

#[test]
fn an_error_that_the_instrument_states_of_its_pressure_or_grains_is_in_the_answer() {
    let relaxed = |speeds: &WaveSpeeds| {
        let message = microstructure_of_speeds(speeds, &Settings::default()).message;
        message.estimates.into_iter().find(|e| e.model == "relaxed").unwrap()
    };
    let z = |e: &Estimate| e.covariance[12].sqrt();
    let known = WaveSpeeds { stress_ratio: vec![0.0], size_spread: vec![0.0], ..upright() };
    let exact = z(&relaxed(&known));
    for uncertain in [
        WaveSpeeds { pressure_stddev: 0.1 * known.pressure, ..known.clone() },
        WaveSpeeds { grain_shear_modulus_stddev: 0.05 * known.grain_shear_modulus, ..known.clone() },
    ] {
        let found = z(&relaxed(&uncertain));
        assert!(found > 1.02 * exact, "{found} {exact}");
    }
    // Speeds of smooth grains have no estimate.
    let smooth = relaxed(&WaveSpeeds { smooth: true, ..known });
    assert!(smooth.status == Estimate::STATUS_UNKNOWN && smooth.warnings[0].contains("smooth"), "{smooth:?}");
}

#[test]
fn contacts_that_are_not_known_are_inferred_and_those_of_smooth_spheres_are_not() {
    let models =
        |speeds: &WaveSpeeds| microstructure_of_speeds(speeds, &Settings::default()).message.estimates;
    let unknown = WaveSpeeds { contact_law: String::new(), ..upright() };
    let free = models(&unknown);
    let (first, others) = free.split_first().unwrap();
    assert_eq!((first.model.as_str(), first.status), ("free-contact", Estimate::STATUS_OK), "{first:?}");
    assert!(first.warnings[0].starts_with("the contacts are not known"), "{:?}", first.warnings);
    // Smooth spheres with these moduli have one z; with any contact the interval is wide and has that z.
    let smooth = others.iter().find(|e| e.model == "relaxed").unwrap();
    let [low, high] = [first.interval[4], first.interval[5]];
    assert!((low..high).contains(&smooth.z[0]) && high - low > 0.5, "{low} {high} {smooth:?}");
    assert!(first.covariance[12] > 4.0 * smooth.covariance[12], "{first:?} {smooth:?}");
    assert!(smooth.warnings.iter().any(|w| w.contains("taken as Hertz-Mindlin")), "{smooth:?}");
    assert_eq!(smooth.status, Estimate::STATUS_EXTRAPOLATED);
    assert!(models(&upright()).iter().all(|e| e.model != "free-contact"));
    // Another law has an estimate, of which the models of smooth spheres have none.
    let linear = WaveSpeeds {
        contact_law: "linear".into(),
        contact_law_parameters: vec![1e5, 8.0 / 9.0],
        size_spread: vec![0.0],
        stress_ratio: vec![0.0],
        ..upright()
    };
    let of_linear = models(&linear);
    assert!(
        of_linear[0].status == Estimate::STATUS_OK && of_linear[0].warnings[0].starts_with("linear contacts")
    );
    assert!(
        of_linear[1..]
            .iter()
            .all(|e| e.status == Estimate::STATUS_UNKNOWN && e.warnings[0].contains("linear"))
    );
    // One wave says nothing of the anisotropy.
    let two =
        |kept: [usize; 2]| WaveSpeeds { speeds: kept.map(|k| upright().speeds[k]).into(), ..unknown.clone() };
    assert!(models(&two([0, 2]))[0].eps.is_empty() && !models(&two([0, 1]))[0].eps.is_empty());
}
