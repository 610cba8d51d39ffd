use super::not_finite::refuses_non_finite;
use super::results::header;
use super::{refuses, refuses_values};
use grainlab_core::{Vec3, WaveMethod, WaveSpeed};
use grainlab_msgs::boundary::{WaveSpeedsReading, wave_speeds_message};
use grainlab_msgs::geometry_msgs::Vector3;
use grainlab_msgs::{from_cdr, msg, stamp, to_cdr};

const NAN: f64 = f64::NAN;

fn sent() -> msg::WaveSpeeds {
    let (x, z) = (Vector3 { x: 1.0, y: 0.0, z: 0.0 }, Vector3 { x: 0.0, y: 0.0, z: 1.0 });
    let compression = msg::WaveSpeed {
        method: msg::WaveSpeed::METHOD_DISPERSION,
        direction: z,
        polarization: z,
        speed: 500.0,
        speed_stddev: 1.5,
        ..msg::WaveSpeed::default()
    };
    let shear = msg::WaveSpeed {
        method: msg::WaveSpeed::METHOD_FIRST_ARRIVAL,
        polarization: x,
        speed: 300.0,
        speed_stddev: 0.0,
        frequency: 2e4,
        strain_amplitude: 1e-7,
        ..compression
    };
    msg::WaveSpeeds {
        header: header(),
        name: "beads 3".to_owned(),
        source_step: 7,
        grains: 500,
        density: 1550.0,
        density_stddev: 8.0,
        pressure: 5e4,
        pressure_stddev: 500.0,
        solid_fraction: 0.64,
        stress_ratio: vec![-0.1],
        stress_ratio_stddev: 0.02,
        size_spread: vec![0.2],
        axis: z,
        grain_shear_modulus: 29e9,
        grain_shear_modulus_stddev: 1.5e9,
        grain_poisson_ratio: 0.2,
        grain_poisson_ratio_stddev: 0.01,
        contact_law: "linear".to_owned(),
        contact_law_parameters: vec![1e5, 0.5],
        smooth: true,
        speeds: vec![compression, shear],
        warnings: vec!["send less".to_owned()],
        notes: vec![msg::Note { text: "send less".to_owned(), ..msg::Note::default() }],
    }
}

#[test]
fn an_inversion_reads_the_speeds_that_were_sent() {
    let received: msg::WaveSpeeds = from_cdr(&to_cdr(&sent())).unwrap();
    let r = WaveSpeedsReading::try_from(&received).unwrap();
    assert_eq!((r.stamp, r.source_step, r.axis), (stamp(0.25), Some(7), Some(Vec3::z())));
    assert_eq!((r.density, r.density_stddev, r.pressure), (1550.0, Some(8.0), 5e4));
    assert_eq!((r.solid_fraction, r.grain_shear_modulus, r.grain_poisson_ratio), (Some(0.64), 29e9, 0.2));
    assert_eq!((r.stress_ratio, r.size_spread), (Some(-0.1), Some(0.2)));
    assert_eq!((r.name.as_str(), r.smooth), ("beads 3", true));
    assert_eq!((r.pressure_stddev, r.stress_ratio_stddev), (500.0, 0.02));
    assert_eq!((r.grain_shear_modulus_stddev, r.grain_poisson_ratio_stddev), (1.5e9, 0.01));
    assert_eq!((r.contact_law, r.grains), (Some("linear:1e5,0.5".parse().unwrap()), Some(500)));
    let compression =
        WaveSpeed { direction: Vec3::z(), polarization: Vec3::z(), speed: 500.0, stddev: Some(1.5) };
    let shear = WaveSpeed { polarization: Vec3::x(), speed: 300.0, stddev: None, ..compression };
    assert_eq!(r.measured(), [compression, shear]);
    assert_eq!(grainlab_core::notes::texts(&r.notes), ["send less"]);
    let [p, s] = &r.speeds[..] else { panic!("two speeds") };
    assert_eq!((p.method, p.frequency, p.strain_amplitude), (WaveMethod::Dispersion, None, 0.0));
    assert_eq!((s.method, s.frequency, s.strain_amplitude), (WaveMethod::FirstArrival, Some(2e4), 1e-7));
}

#[test]
fn what_was_read_is_sent_as_it_came_and_nothing_goes_out_that_would_be_refused() {
    let message = msg::WaveSpeeds { axis: Vector3::default(), density_stddev: 0.0, ..sent() };
    for message in [message, sent()] {
        let mut reading = WaveSpeedsReading::try_from(&message).unwrap();
        assert_eq!(wave_speeds_message(header(), &reading).unwrap(), message);
        reading.speeds[1].wave.speed = NAN;
        let error = wave_speeds_message(header(), &reading).unwrap_err().to_string();
        assert!(error.starts_with("WaveSpeeds.speeds[1].speed = NaN is refused"), "{error}");
    }
}

#[test]
fn zeros_of_an_instrument_are_unknown() {
    let message = msg::WaveSpeeds {
        source_step: 0,
        grains: 0,
        density_stddev: 0.0,
        solid_fraction: 0.0,
        stress_ratio: vec![],
        stress_ratio_stddev: 0.0,
        size_spread: vec![],
        contact_law: String::new(),
        contact_law_parameters: vec![],
        axis: Vector3::default(),
        speeds: Vec::new(),
        ..sent()
    };
    let r = WaveSpeedsReading::try_from(&message).unwrap();
    assert_eq!((r.source_step, r.density_stddev, r.solid_fraction, r.axis), (None, None, None, None));
    assert_eq!((r.contact_law, r.grains), (None, None));
    assert!(r.speeds.is_empty());
}

#[test]
fn every_method_has_a_code_and_a_name() {
    for (code, word) in
        ["first_arrival", "cross_correlation", "peak", "standing_wave", "dispersion"].iter().enumerate()
    {
        let mut m = sent();
        m.speeds[0].method = code as u8;
        let method = WaveSpeedsReading::try_from(&m).unwrap().speeds[0].method;
        assert_eq!(method.word(), *word);
    }
}

#[test]
fn each_fault_of_the_wave_speeds_is_refused_by_name() {
    refuses_non_finite(&sent(), &[], |m| WaveSpeedsReading::try_from(m));
    refuses(
        &sent(),
        &[
            (|m| m.header.stamp.nanosec = u32::MAX, "WaveSpeeds.header.stamp.nanosec"),
            (
                |m| m.stress_ratio.clear(),
                "WaveSpeeds.stress_ratio_stddev = 0.02 is refused: it must be 0 where the quantity is not known",
            ),
            (|m| m.axis.z = 0.5, "WaveSpeeds.|axis| = 0.5 is refused: it must be 1"),
            (
                |m| m.speeds[1].method = 5,
                "WaveSpeeds.speeds[1].method = 5 is refused: it must be one of 0 (first arrival)",
            ),
            (
                |m| m.speeds[0].direction.z = 0.0,
                "WaveSpeeds.|speeds[0].direction| = 0.0 is refused: it must be 1",
            ),
            (|m| m.speeds[1].polarization.x = 0.9, "WaveSpeeds.|speeds[1].polarization| = 0.9 is refused"),
        ],
        |m| WaveSpeedsReading::try_from(m),
    );
    refuses_values!(&sent(), |m| WaveSpeedsReading::try_from(m), "WaveSpeeds", m:
        m.density => 0.0,
        m.density_stddev => -1.0,
        m.pressure => -5e4,
        m.solid_fraction => 1.5,
        m.pressure_stddev => -1.0,
        m.grain_poisson_ratio_stddev => -0.1,
        m.size_spread[0] => -0.1,
        m.grain_shear_modulus => 0.0,
        m.speeds[1].speed => 0.0,
        m.speeds[1].speed_stddev => -1.0,
        m.speeds[0].frequency => -1.0,
    );
}
