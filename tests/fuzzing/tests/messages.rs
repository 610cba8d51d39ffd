//! CDR of every message, and the boundary to the kernels' types.

use fuzzing::{Counting, Target};
use grainlab_core::contact::ContactLaw;
use grainlab_core::results::Estimate;
use grainlab_core::results::PackingReport;
use grainlab_core::{Cell, Contact, Packing, Vec3};
use grainlab_msgs::boundary::{ModuliReading, WaveSpeedsReading, packing_message};
use grainlab_msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use grainlab_msgs::{Message, from_cdr, msg, rcl_interfaces, rosgraph_msgs, tf2_msgs, to_cdr};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A decoded message is at most a few times as large as its bytes: an empty string has four in CDR and 24 in
/// memory.
const MEMORY: (usize, usize) = (1 << 20, 64);

fn packing() -> Packing {
    let contact = |i, j, z: f64| Contact {
        tangential_force: Vec3::x(),
        rolling_force: Vec3::y(),
        ..Contact::pressed([i, j], [0; 3], Vec3::z() * z, 1e-6, 1.0)
    };
    Packing {
        step: 7,
        time: 0.1,
        contacts: vec![contact(0, 1, 1.0), contact(1, 2, 1.0)],
        law: ContactLaw::new("hertz_mindlin", &[1e4, 0.0, 0.1]).expect("a law with resistance to rolling"),
        friction: 0.3,
        time_step: 1e-7,
        ..Packing::at_rest(
            Cell::cube(1e-2).unwrap(),
            vec![1e-3; 3],
            (0..3).map(|k| Vec3::z() * (k as f64 * 1.999e-3)).collect(),
        )
    }
}

fn decode<T: Message + Default>(name: &str, seed: T, mut beyond: impl FnMut(&T)) {
    Target {
        name,
        seeds: vec![to_cdr(&seed), to_cdr(&T::default())],
        words: &[],
        memory: MEMORY,
        decode: &mut |bytes| {
            if let Ok(message) = from_cdr::<T>(bytes) {
                beyond(&message);
            }
        },
    }
    .run();
}

#[test]
fn every_message_gives_a_value_or_an_error() {
    decode("cdr-packing", packing_message(&packing(), "demo", vec![7; 9]), |m| drop(Packing::try_from(m)));
    decode("cdr-stress", msg::Stress::default(), |m| drop(grainlab_servo::ServoRequest::try_from(m)));
    decode("cdr-strain-rate", msg::StrainRate::default(), |m| _ = m.checked());
    decode("cdr-run-state", msg::RunState::default(), |m| _ = m.checked());
    let stiffness = vec![msg::ElasticStiffness::default()];
    decode("cdr-packing-report", msg::PackingReport { stiffness, ..Default::default() }, |m| {
        drop(PackingReport::try_from(m))
    });
    decode("cdr-moduli", msg::Moduli::default(), |m| drop(ModuliReading::try_from(m)));
    decode(
        "cdr-wave-speeds",
        msg::WaveSpeeds { speeds: vec![msg::WaveSpeed::default(); 3], ..Default::default() },
        |m| {
            drop(WaveSpeedsReading::try_from(m));
        },
    );
    decode("cdr-waveform", msg::Waveform::default(), |m| _ = m.checked());
    let estimates = vec![msg::Estimate::default(); 2];
    decode("cdr-microstructure", msg::Microstructure { estimates, ..Default::default() }, |m| {
        drop(m.results());
        m.estimates.iter().for_each(|e| drop(Estimate::try_from(e)));
    });
    decode("cdr-packing-chunk", msg::PackingChunk::default(), |_| ());
    decode("cdr-packing-credit", msg::PackingCredit::default(), |_| ());
    decode("cdr-log", rcl_interfaces::Log::default(), |_| ());
    decode("cdr-clock", rosgraph_msgs::Clock::default(), |_| ());
    decode("cdr-tf", tf2_msgs::TFMessage::default(), |_| ());
    let values = vec![KeyValue { key: "published /stress".into(), value: "7 00".into() }; 3];
    let status = vec![DiagnosticStatus { name: "grainlab: x".into(), values, ..Default::default() }; 2];
    decode("cdr-diagnostics", DiagnosticArray { status, ..Default::default() }, |m| {
        drop(grainlab_node_kit::Report::from_message(m));
    });
}
