//! Messages decoded by a schema text, and schema texts.

use fuzzing::{Counting, Target};
use grainlab_any_message::Schema;
use grainlab_msgs::rcl_interfaces::Log;
use grainlab_msgs::{TypeInfo, diagnostic_msgs, msg, to_cdr};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The bound stated by `Schema::decode`, and room for an error.
const MEMORY: (usize, usize) = ((64 + 16) << 10, 256);

fn decoded(name: &str, info: &TypeInfo, seed: Vec<u8>) {
    let schema = Schema::parse(info.type_name, info.definition).unwrap();
    assert!(schema.decode(&seed).is_ok(), "{name}");
    Target {
        name,
        seeds: vec![seed],
        words: &["grainlab", "NaN"],
        memory: MEMORY,
        decode: &mut |bytes| drop(schema.decode(bytes)),
    }
    .run();
}

#[test]
fn bytes_give_a_message_or_an_error() {
    let status = diagnostic_msgs::DiagnosticStatus { name: "a".into(), ..Default::default() };
    let array = diagnostic_msgs::DiagnosticArray { status: vec![status; 3], ..Default::default() };
    let packing = msg::Packing { position: vec![0.5; 30], ..Default::default() };
    decoded("any-log", &TypeInfo::of::<Log>(), to_cdr(&Log { msg: "it began".into(), ..Default::default() }));
    decoded("any-diagnostics", &TypeInfo::of::<diagnostic_msgs::DiagnosticArray>(), to_cdr(&array));
    decoded("any-packing", &TypeInfo::of::<msg::Packing>(), to_cdr(&packing));
}

#[test]
fn a_schema_text_gives_types_or_an_error() {
    let seeds = TypeInfo::all().iter().map(|info| info.definition.as_bytes().to_vec()).collect();
    Target {
        name: "any-schema",
        seeds,
        words: &["MSG: ", "string<=", "[<=3]", "uint8[]", "std_msgs/Header", "==="],
        memory: (64 << 10, 512),
        decode: &mut |bytes| drop(Schema::parse("a_msgs/msg/B", &String::from_utf8_lossy(bytes))),
    }
    .run();
}
