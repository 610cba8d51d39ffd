use super::refuses;
use super::results::header;
use grainlab_core::{Vec3, WaveMethod};
use grainlab_msgs::boundary::{TraceReading, WaveformReading, waveform_message};
use grainlab_msgs::{from_cdr, msg, stamp, to_cdr};

fn heard() -> WaveformReading {
    let trace = |name: &str, distance, samples: [f32; 3]| TraceReading {
        name: name.to_owned(),
        distance,
        samples: samples.to_vec(),
    };
    WaveformReading {
        stamp: stamp(0.25),
        source_step: Some(7),
        method: WaveMethod::CrossCorrelation,
        direction: Vec3::z(),
        polarization: Vec3::x(),
        frequency: 2e4,
        sample_rate: 1e6,
        start: -1e-6,
        channels: vec![trace("near", 4e-3, [0.0, 1e-6, 0.0]), trace("far", 8e-3, [0.0, 0.0, 5e-7])],
    }
}

fn sent() -> msg::Waveform {
    waveform_message(header(), &heard()).unwrap()
}

#[test]
fn every_channel_arrives_as_it_was_sent() {
    let received: msg::Waveform = from_cdr(&to_cdr(&sent())).unwrap();
    assert_eq!(WaveformReading::try_from(&received).unwrap(), heard());
    assert_eq!((received.quantity.as_str(), received.unit.as_str()), ("velocity", "m/s"));
    assert_eq!(received.sample, [0.0, 1e-6, 0.0, 0.0, 0.0, 5e-7]);
}

#[test]
fn channels_of_different_length_are_not_sent() {
    let mut torn = heard();
    torn.channels[1].samples.pop();
    let error = waveform_message(header(), &torn).unwrap_err().to_string();
    assert!(error.starts_with("Waveform.sample has 2 entries and is refused: it must have 3"), "{error}");
}

#[test]
fn each_fault_of_the_traces_is_refused_by_name() {
    refuses(
        &sent(),
        &[
            (|m| m.header.stamp.nanosec = u32::MAX, "Waveform.header.stamp.nanosec"),
            (|m| m.method = 5, "Waveform.method = 5 is refused"),
            (|m| m.direction.z = 0.0, "Waveform.|direction| = 0.0 is refused: it must be 1"),
            (|m| m.polarization.x = f64::NAN, "Waveform.|polarization| = NaN is refused"),
            (|m| m.frequency = 0.0, "Waveform.frequency = 0.0 is refused"),
            (|m| m.sample_rate = f64::INFINITY, "Waveform.sample_rate = inf is refused"),
            (|m| m.start = f64::NAN, "Waveform.start = NaN is refused"),
            (|m| m.quantity.clear(), "Waveform.quantity = \"\" is refused: it must be one of velocity"),
            (|m| m.unit = "mm/s".into(), "Waveform.unit = \"mm/s\" is refused: it must be one of m/s"),
            (|m| m.channel.clear(), "Waveform.channel has 0 entries and is refused: it must have 1"),
            (|m| m.distance.push(1.0), "Waveform.distance has 3 entries and is refused: it must have 2"),
            (|m| m.distance[1] = -1.0, "Waveform.distance[1] = -1.0 is refused"),
            (|m| m.sample.push(0.0), "Waveform.sample has 7 entries and is refused: it must have 6"),
            (|m| m.sample.clear(), "Waveform.sample has 0 entries and is refused: it must have 2"),
            (|m| m.sample[4] = f32::NAN, "Waveform.sample[4] = NaN is refused"),
        ],
        |m| WaveformReading::try_from(m),
    );
}
