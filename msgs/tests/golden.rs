//! Every type against independent software: `golden/make_golden.py` made schema texts, type hashes and CDR
//! bytes with rosbags and mcap-ros2-support, and compared the standard types with those of ROS 2 Jazzy.

use grainlab_msgs::{Message, TypeInfo, from_cdr, to_cdr};
use serde::Deserialize;
use serde_json::Value;
use std::fmt::Debug;

include!(concat!(env!("OUT_DIR"), "/for_every_type.rs"));

/// What to do after a message file has changed.
const REMAKE: &str = "msgs/tests/golden/messages.json is of other message files. Run:\n    pip install rosbags==0.11.9 mcap-ros2-support==0.6.0\n    python3 msgs/tests/golden/make_golden.py\n";

#[derive(Deserialize)]
struct Golden {
    #[serde(rename = "type")]
    type_name: String,
    hash: String,
    definition: String,
    messages: Vec<GoldenMessage>,
}

#[derive(Deserialize)]
struct GoldenMessage {
    value: Value,
    cdr: String,
    cdr_big_endian: String,
}

fn golden() -> Vec<Golden> {
    serde_json::from_str(include_str!("golden/messages.json")).unwrap()
}

#[test]
fn type_hashes_and_schema_texts_are_the_independent_ones() {
    let golden = golden();
    assert_eq!(golden.len(), TypeInfo::all().len(), "{REMAKE}");
    for g in &golden {
        let info =
            TypeInfo::by_name(&g.type_name).unwrap_or_else(|| panic!("{} is missing: {REMAKE}", g.type_name));
        assert_eq!(info.definition, g.definition, "{}: {REMAKE}", g.type_name);
        assert_eq!(info.hash, g.hash, "{}", g.type_name);
        assert_eq!(info.type_name, format!("{}/msg/{}", info.package, info.name));
    }
}

#[test]
fn bytes_are_the_independent_ones_in_both_byte_orders() {
    let golden = golden();
    let mut seen = 0;
    macro_rules! check {
        ($t:ty) => {
            seen += check::<$t>(&golden)
        };
    }
    for_every_type!(check);
    // A filled and an empty message of each.
    assert_eq!(seen, 2 * golden.len());
}

fn check<T: Message + PartialEq + Debug>(golden: &[Golden]) -> usize {
    let g = golden
        .iter()
        .find(|g| g.type_name == T::TYPE)
        .unwrap_or_else(|| panic!("{} is new: {REMAKE}", T::TYPE));
    for m in &g.messages {
        let value: T =
            serde_json::from_value(m.value.clone()).unwrap_or_else(|e| panic!("{}: {e}. {REMAKE}", T::TYPE));
        let little = hex(&m.cdr);
        assert_eq!(to_cdr(&value), little, "{}", T::TYPE);
        assert_eq!(from_cdr::<T>(&little).unwrap(), value, "{}", T::TYPE);
        assert_eq!(from_cdr::<T>(&hex(&m.cdr_big_endian)).unwrap(), value, "{} big endian", T::TYPE);
    }
    g.messages.len()
}

fn hex(text: &str) -> Vec<u8> {
    (0..text.len()).step_by(2).map(|i| u8::from_str_radix(&text[i..i + 2], 16).unwrap()).collect()
}
