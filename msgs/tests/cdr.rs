//! Decoding of arbitrary bytes.

use grainlab_msgs::builtin_interfaces::Time;
use grainlab_msgs::diagnostic_msgs::{DiagnosticArray, DiagnosticStatus, KeyValue};
use grainlab_msgs::msg::{Estimate, Packing, StrainRate};
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{Message, from_cdr, to_cdr};
use proptest::array::uniform9;
use proptest::collection::vec;
use proptest::prelude::*;

include!(concat!(env!("OUT_DIR"), "/for_every_type.rs"));

/// Any bit pattern, including infinities, subnormals and every NaN.
fn any_f64() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits)
}

prop_compose! {
    fn any_packing()(
        (sec, nanosec, frame_id) in (any::<i32>(), any::<u32>(), ".{0,9}"),
        (step, time, cell) in (any::<u64>(), any_f64(), uniform9(any_f64())),
        id in vec(any::<u32>(), 0..9),
        radius in vec(any_f64(), 0..9),
        position in vec(any_f64(), 0..9),
        contact_image in vec(any::<i8>(), 0..9),
        contact_overlap in vec(any_f64(), 0..9),
        (friction, run_state, scene) in (any_f64(), vec(any::<u8>(), 0..9), ".{0,9}"),
    ) -> Packing {
        let header = Header { stamp: Time { sec, nanosec }, frame_id };
        Packing {
            header, step, time, cell, id, radius, position, contact_image, contact_overlap, friction, run_state, scene,
            ..Packing::default()
        }
    }
}

proptest! {
    /// Compared as bytes: NaN is unequal to itself.
    #[test]
    fn a_packing_comes_back_bit_for_bit(packing in any_packing()) {
        let bytes = to_cdr(&packing);
        prop_assert_eq!(&bytes[..4], [0, 1, 0, 0]);
        let back: Packing = from_cdr(&bytes).unwrap();
        prop_assert_eq!(to_cdr(&back), bytes);
        prop_assert_eq!(back.time.to_bits(), packing.time.to_bits());
        prop_assert_eq!(back.contact_image, packing.contact_image);
        prop_assert_eq!(back.scene, packing.scene);
    }

    #[test]
    fn diagnostics_come_back(rows in vec((any::<u8>(), ".{0,9}", vec((".{0,5}", ".{0,5}"), 0..4)), 0..4)) {
        let status = rows.into_iter().map(|(level, name, values)| DiagnosticStatus {
            level,
            name,
            values: values.into_iter().map(|(key, value)| KeyValue { key, value }).collect(),
            ..DiagnosticStatus::default()
        });
        let message = DiagnosticArray { status: status.collect(), ..DiagnosticArray::default() };
        prop_assert_eq!(from_cdr::<DiagnosticArray>(&to_cdr(&message)).unwrap(), message);
    }

    #[test]
    fn arbitrary_bytes_never_panic(mut bytes in vec(any::<u8>(), 0..600), plain in any::<bool>()) {
        if plain && bytes.len() >= 2 {
            bytes[..2].copy_from_slice(&[0, 1]);
        }
        macro_rules! decode { ($t:ty) => { let _ = from_cdr::<$t>(&bytes); }; }
        for_every_type!(decode);
    }

    /// A corrupted valid message is decoded further than noise.
    #[test]
    fn corrupted_messages_never_panic(packing in any_packing(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = to_cdr(&packing);
        let index = at.index(bytes.len());
        bytes[index] = byte;
        let _ = from_cdr::<Packing>(&bytes);
    }

    #[test]
    fn a_message_cut_anywhere_is_refused(packing in any_packing(), at in any::<prop::sample::Index>()) {
        let bytes = to_cdr(&packing);
        let cut = &bytes[..at.index(bytes.len())];
        let fault = from_cdr::<Packing>(cut).unwrap_err().problem;
        let refused = fault.contains("end within the message") || fault.contains("too few for a CDR header");
        prop_assert!(refused, "{} of {} bytes: {fault}", cut.len(), bytes.len());
    }
}

#[test]
fn headers_other_than_plain_cdr_are_refused_and_named() {
    let mut bytes = to_cdr(&StrainRate::default());
    for representation in [2, 3, 6, 7, 8, 9, 10, 11] {
        bytes[1] = representation;
        let fault = from_cdr::<StrainRate>(&bytes).unwrap_err().to_string();
        let expected = format!(
            "grainlab_msgs/msg/StrainRate: encapsulation [00, {representation:02x}] is not plain CDR"
        );
        assert!(fault.starts_with(&expected), "{fault}");
    }
    bytes[..4].copy_from_slice(&[0, 1, 0, 3]);
    assert!(from_cdr::<StrainRate>(&bytes).is_ok(), "options are not ours to judge");
}

#[test]
fn padding_is_tolerated_and_more_is_not() {
    let mut bytes = to_cdr(&StrainRate::default());
    for _ in 0..3 {
        bytes.push(0);
        assert!(from_cdr::<StrainRate>(&bytes).is_ok());
    }
    bytes.push(0);
    assert!(from_cdr::<StrainRate>(&bytes).unwrap_err().problem.starts_with("4 bytes follow"));
}

#[test]
fn values_that_their_type_does_not_allow_are_refused() {
    let mut bytes = to_cdr(&StrainRate::default());
    let last = bytes.len() - 1;
    bytes[last] = 2;
    assert!(from_cdr::<StrainRate>(&bytes).is_err(), "a bool of 2");
    let mut bytes = to_cdr(&KeyValue { key: "abc".into(), value: String::new() });
    bytes[8] = 0xff;
    assert!(from_cdr::<KeyValue>(&bytes).is_err(), "a string that is not UTF-8");
}

#[test]
fn another_type_is_noticed_by_its_length() {
    let bytes = to_cdr(&Estimate::default());
    assert!(from_cdr::<StrainRate>(&bytes).is_err());
    assert!(from_cdr::<Packing>(&bytes).is_err());
    assert_eq!(Packing::TYPE, "grainlab_msgs/msg/Packing");
}
