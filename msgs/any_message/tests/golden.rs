//! Hand-made bytes of every type, in both byte orders, and the JSON that they mean.

use grainlab_any_message::{Schema, Shown};
use proptest::prelude::*;

const SCHEMA: &str = "\
# every type
uint8 LIMIT = 3
string NAME = \"a # b\"
bool flag true
byte octet
char letter
int8 i8
uint8 u8
int16 i16
uint16 u16
int32 i32 -5
uint32 u32
int64 i64
uint64 u64
float32 f32
float64 f64
string text \"x\"
string<=4 short_text
wstring wide
int16[3] fixed
float64[] open
uint8[<=4] bounded
string[] texts
Inner inner
Inner[<=2] inners
other_msgs/Nothing nothing
float64[] last
================================================================================
MSG: p/Inner
builtin_interfaces/Time stamp
float32[2] pair
================================================================================
MSG: other_msgs/Nothing
";

const JSON: &str = r#"{"flag":true,"octet":200,"letter":65,"i8":-1,"u8":255,"i16":-2,"u16":65534,"i32":-3,"u32":4294967293,"i64":-4,"u64":18446744073709551612,"f32":0.1,"f64":"NaN","text":"né","short_text":"","wide":"é𝄞","fixed":[1,-2,3],"open":[1.5,"-Infinity"],"bounded":[7,8],"texts":["a",""],"inner":{"stamp":{"sec":-1,"nanosec":2},"pair":[0.5,-0.5]},"inners":[{"stamp":{"sec":3,"nanosec":4},"pair":[1.0,"Infinity"]}],"nothing":{},"last":[]}"#;

/// Writes aligned values of either byte order.
struct Bytes {
    body: Vec<u8>,
    big: bool,
}

impl Bytes {
    fn put(&mut self, little: &[u8]) -> &mut Self {
        while !self.body.len().is_multiple_of(little.len()) {
            self.body.push(0xaa);
        }
        let mut bytes = little.to_vec();
        if self.big {
            bytes.reverse();
        }
        self.body.extend(bytes);
        self
    }

    fn string(&mut self, text: &str) -> &mut Self {
        self.put(&(text.len() as u32 + 1).to_le_bytes());
        self.body.extend(text.as_bytes());
        self.body.push(0);
        self
    }
}

fn every_type(big: bool) -> Vec<u8> {
    let mut b = Bytes { body: Vec::new(), big };
    b.put(&[1]).put(&[200]).put(&[65]).put(&[255]).put(&[255]);
    b.put(&(-2i16).to_le_bytes()).put(&65534u16.to_le_bytes());
    b.put(&(-3i32).to_le_bytes()).put(&4294967293u32.to_le_bytes());
    b.put(&(-4i64).to_le_bytes()).put(&18446744073709551612u64.to_le_bytes());
    b.put(&0.1f32.to_le_bytes()).put(&f64::NAN.to_le_bytes());
    b.string("né").string("");
    b.put(&3u32.to_le_bytes());
    "é𝄞".encode_utf16().for_each(|unit| _ = b.put(&u32::from(unit).to_le_bytes()));
    [1i16, -2, 3].iter().for_each(|v| _ = b.put(&v.to_le_bytes()));
    b.put(&2u32.to_le_bytes()).put(&1.5f64.to_le_bytes()).put(&f64::NEG_INFINITY.to_le_bytes());
    b.put(&2u32.to_le_bytes()).put(&[7]).put(&[8]);
    b.put(&2u32.to_le_bytes()).string("a").string("");
    b.put(&(-1i32).to_le_bytes())
        .put(&2u32.to_le_bytes())
        .put(&0.5f32.to_le_bytes())
        .put(&(-0.5f32).to_le_bytes());
    b.put(&1u32.to_le_bytes());
    b.put(&3i32.to_le_bytes()).put(&4u32.to_le_bytes());
    b.put(&1f32.to_le_bytes()).put(&f32::INFINITY.to_le_bytes());
    // A message without fields is one byte; an empty array has no padding behind its length.
    b.put(&[0]).put(&0u32.to_le_bytes());
    let mut bytes = vec![0, u8::from(!big), 0, 0];
    bytes.extend(b.body);
    bytes
}

fn schema() -> Schema {
    Schema::parse("p/msg/Every", SCHEMA).unwrap()
}

#[test]
fn every_type_in_both_byte_orders_is_the_golden_json() {
    for big in [false, true] {
        let message = schema().decode(&every_type(big)).unwrap();
        assert_eq!(Shown::new(&message).json(), JSON, "big endian: {big}");
    }
}

#[test]
fn every_type_is_encoded_as_the_golden_bytes() {
    let golden = every_type(false);
    for big in [false, true] {
        let encoded = schema().decode(&every_type(big)).unwrap().encode();
        assert_eq!(encoded.len(), golden.len());
        // Padding is zero, and marked in the golden bytes.
        let differs = |(own, golden): &(&u8, &u8)| own != golden && !(**own == 0 && **golden == 0xaa);
        assert_eq!(encoded.iter().zip(&golden).position(|pair| differs(&pair)), None, "big endian: {big}");
    }
}

#[test]
fn a_shortened_array_states_what_is_left_out_and_text_is_yaml() {
    let message = schema().decode(&every_type(false)).unwrap();
    let json = Shown::new(&message).shortened(1).json();
    assert!(json.contains(r#""fixed":[1,"... 2 more"],"open":[1.5,"... 1 more"]"#), "{json}");
    let text = Shown::new(&message).shortened(2).text();
    assert!(text.starts_with("flag: true\noctet: 200\n"), "{text}");
    assert!(text.contains("f64: .nan\ntext: \"né\"\nshort_text: ''\n"), "{text}");
    assert!(text.contains("fixed:\n- 1\n- -2\n- '... 1 more'\n"), "{text}");
    let inners =
        "inners:\n- stamp:\n    sec: 3\n    nanosec: 4\n  pair:\n  - 1.0\n  - .inf\nnothing:\nlast: []\n";
    assert!(text.ends_with(inners), "{text}");
}

#[test]
fn a_message_cut_anywhere_is_an_error_that_names_the_field() {
    let bytes = every_type(false);
    for length in 0..bytes.len() {
        assert!(schema().decode(&bytes[..length]).is_err(), "{length} bytes");
    }
    let problem = |bytes: &[u8]| schema().decode(bytes).unwrap_err().problem;
    assert!(problem(&bytes[..bytes.len() - 32]).starts_with("inner.pair at byte"));
    let longer = [&bytes[..], &[0; 4]].concat();
    assert!(problem(&longer).starts_with("4 bytes follow"));
    assert!(schema().decode(&longer[..longer.len() - 1]).is_ok(), "three bytes of padding are allowed");
    assert!(problem(&[0, 3, 0, 0]).starts_with("encapsulation [00, 03] is not plain CDR"));
}

#[test]
fn a_false_length_is_an_error_before_anything_is_reserved() {
    let of = |text: &str, bytes: &[u8]| {
        let whole = [&[0, 1, 0, 0], bytes].concat();
        Schema::parse("p/msg/A", text).unwrap().decode(&whole).unwrap_err().problem
    };
    let claim = u32::MAX.to_le_bytes();
    for text in ["float64[] a", "string a", "wstring a", "string[] a", "builtin_interfaces/Time[] a"] {
        assert!(of(text, &claim).starts_with("a at byte"), "{text}");
    }
    assert!(of("uint8[4000000000] a", &claim).starts_with("a at byte"));
    let long = of("uint8[<=4] a", &[5, 0, 0, 0, 1, 2, 3, 4, 5]);
    assert_eq!(long, "a has 5 entries, and its type allows at most 4");
    let long = of("string<=2 a", &[4, 0, 0, 0, 65, 66, 67, 0]);
    assert_eq!(long, "a has 3 entries, and its type allows at most 2");
    // Sixty levels of messages around one byte, ten thousand times.
    let bar = "=".repeat(80);
    let chain: String = (1..60).map(|n| format!("{bar}\nMSG: p/T{n}\nT{} t\n", n + 1)).collect();
    let deep = format!("T1[] a\n{chain}{bar}\nMSG: p/T60\nbool b\n");
    let bytes = [&10_000u32.to_le_bytes()[..], &[1; 10_000]].concat();
    assert!(of(&deep, &bytes).contains("more than 256 times"));
}

proptest! {
    #[test]
    fn random_bytes_and_random_schemas_never_panic(
        bytes in proptest::collection::vec(any::<u8>(), 0..400),
        lines in proptest::collection::vec("[ -~]{0,30}", 0..12),
        kinds in proptest::collection::vec(0usize..8, 1..8),
    ) {
        let names = ["float64[]", "string", "string[]", "A[<=3]", "int16[7]", "wstring[2]", "bool", "A"];
        let fields: String = kinds.iter().enumerate().map(|(n, k)| format!("{} f{n}\n", names[*k])).collect();
        let text = format!("{fields}====\nMSG: p/A\nuint8 a\nstring b\n");
        let schema = Schema::parse("p/msg/T", &text).unwrap();
        let _ = schema.decode(&bytes);
        let _ = schema.decode(&[&[0, 1, 0, 0], &bytes[..]].concat()).map(|m| Shown::new(&m).json());
        let _ = Schema::parse("p/msg/T", &lines.join("\n"));
    }
}
