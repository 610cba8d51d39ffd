use super::not_finite::refuses_non_finite;
use super::results::header;
use super::{refuses, refuses_values};
use grainlab_core::{Vec3, WaveMethod};
use grainlab_msgs::boundary::vector_message;
use grainlab_msgs::{from_cdr, msg, to_cdr};

fn sent() -> msg::Waveform {
    msg::Waveform {
        header: header(),
        source_step: 7,
        method: msg::WaveSpeed::code(WaveMethod::CrossCorrelation),
        direction: vector_message(&Vec3::z()),
        polarization: vector_message(&Vec3::x()),
        frequency: 2e4,
        sample_rate: 1e6,
        start: -1e-6,
        quantity: msg::Waveform::QUANTITY.into(),
        unit: msg::Waveform::UNIT.into(),
        channel: vec!["near".into(), "far".into()],
        distance: vec![4e-3, 8e-3],
        sample: vec![0.0, 1e-6, 0.0, 0.0, 0.0, 5e-7],
    }
}

#[test]
fn every_channel_arrives_as_it_was_sent() {
    let received: msg::Waveform = from_cdr(&to_cdr(&sent())).unwrap();
    assert_eq!(received.checked().unwrap(), &sent());
    assert_eq!((received.quantity.as_str(), received.unit.as_str()), ("velocity", "m/s"));
}

#[test]
fn each_fault_of_the_traces_is_refused_by_name() {
    refuses_non_finite(&sent(), &[], |m| m.checked().cloned());
    refuses(
        &sent(),
        &[
            (|m| m.header.stamp.nanosec = u32::MAX, "Waveform.header.stamp.nanosec"),
            (|m| m.direction.z = 0.0, "Waveform.|direction| = 0.0 is refused: it must be 1"),
            (|m| m.quantity.clear(), "Waveform.quantity = \"\" is refused: it must be one of velocity"),
            (|m| m.unit = "mm/s".into(), "Waveform.unit = \"mm/s\" is refused: it must be one of m/s"),
            (|m| m.channel.clear(), "Waveform.channel has 0 entries and is refused: it must have 1"),
            (|m| m.distance.push(1.0), "Waveform.distance has 3 entries and is refused: it must have 2"),
            (|m| m.sample.push(0.0), "Waveform.sample has 7 entries and is refused: it must have 6"),
            (|m| m.sample.clear(), "Waveform.sample has 0 entries and is refused: it must have 2"),
            (|m| m.sample[4] = f32::NAN, "Waveform.sample[4] = NaN is refused"),
        ],
        |m| m.checked().cloned(),
    );
    refuses_values!(&sent(), |m| m.checked().cloned(), "Waveform", m:
        m.method => 5,
        m.frequency => 0.0,
        m.distance[1] => -1.0,
    );
}
