use super::*;
use bytes::Bytes;
use grainlab_any_message::{Element, FieldType, Length, Message, Primitive, Schema};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row};

fn read(file: Vec<u8>) -> (usize, Vec<Row>) {
    let reader = SerializedFileReader::new(Bytes::from(file)).unwrap();
    (reader.num_row_groups(), reader.get_row_iter(None).unwrap().map(Result::unwrap).collect())
}

/// A table with a time and the fields of a type.
fn table(schema: &Schema) -> ParquetTable<Vec<u8>> {
    let fields = schema.root().fields.iter();
    let fields = fields.map(|f| Column { name: f.name.clone(), kind: Kind::Field(f.kind.clone()) });
    let time = Column { name: "log_time".into(), kind: Kind::Time };
    ParquetTable::new(Vec::new(), "rows", &[vec![time], fields.collect()].concat()).unwrap()
}

fn add(table: &mut ParquetTable<Vec<u8>>, time: u64, message: &Message) {
    table.row([&Value::U64(time)].into_iter().chain(&message.values).map(Some)).unwrap();
}

#[test]
fn lists_of_structs_with_lists_are_read_back_with_every_value_and_every_empty_list() {
    let text = "bool flag\nint8 i8\nuint32 u32\nuint64 u64\nfloat32 f32\nstring text\nuint8[] data\nuint8[2] mode\nint16[] many\nPair pair\n\
                Pair[] pairs\nNone none\nNone[] nones\n====\nMSG: p/Pair\nNone none\nfloat64[2] xy\nstring[] names\nOne[] ones\n\
                ====\nMSG: p/One\nuint16 n\n====\nMSG: p/None\n";
    let schema = Schema::parse("p/msg/All", text).unwrap();
    let pair = |names: &[&str], ones: &[u16]| {
        let ones: Vec<_> = ones.iter().map(|n| serde_json::json!({ "n": n })).collect();
        serde_json::json!({"xy": [0.5, "NaN"], "names": names, "ones": ones})
    };
    let given = |pairs: Vec<serde_json::Value>, many: &[i16]| {
        let values = serde_json::json!({
            "flag": true, "i8": -3, "u32": u32::MAX, "u64": u64::MAX, "f32": 0.5, "text": "ε", "data": [1, 2], "mode": [3, 4], "many": many,
            "pair": pair(&[], &[7]), "pairs": pairs,
        });
        schema.given(&values).unwrap()
    };
    let messages = [
        given(vec![], &[]),
        given(vec![pair(&["a", "b"], &[1, 2]), pair(&[], &[]), pair(&["c"], &[3])], &[4, -5]),
        given(vec![pair(&[], &[9])], &[6]),
    ];
    let mut table = table(&schema);
    let time = 1_700_000_000_000_000_001;
    messages.iter().for_each(|message| add(&mut table, time, message));
    let (_, rows) = read(table.finish().unwrap());
    let shown: Vec<String> = rows.iter().map(Row::to_string).collect();
    let pairs = [
        "[]",
        "[{xy: [0.5, NaN], names: [\"a\", \"b\"], ones: [{n: 1}, {n: 2}]}, {xy: [0.5, NaN], names: [], ones: []}, \
         {xy: [0.5, NaN], names: [\"c\"], ones: [{n: 3}]}]",
        "[{xy: [0.5, NaN], names: [], ones: [{n: 9}]}]",
    ];
    for ((row, pairs), many) in shown.iter().zip(pairs).zip(["[]", "[4, -5]", "[6]"]) {
        assert!(row.contains(&format!("mode: [3, 4], many: {many}, pair: ")), "{row}");
        assert!(row.ends_with(&format!("pairs: {pairs}}}")), "{row}");
    }
    let values: Vec<&Field> = rows[0].get_column_iter().map(|(_, value)| value).collect();
    assert!(format!("{:?}", values[0]).contains(&time.to_string()), "{:?}", values[0]);
    let expected = [
        Field::Bool(true),
        Field::Byte(-3),
        Field::UInt(u32::MAX),
        Field::ULong(u64::MAX),
        Field::Float(0.5),
        Field::Str("ε".into()),
        Field::Bytes(vec![1, 2].into()),
    ];
    assert_eq!(values[1..8].iter().map(|v| (*v).clone()).collect::<Vec<_>>(), expected);
}

#[test]
fn rows_are_written_in_groups_what_is_missing_is_null_and_a_late_time_is_refused() {
    let schema = Schema::parse("p/msg/Many", "float64[] many\n").unwrap();
    let many = schema.given(&serde_json::json!({ "many": vec![1.0; 1 << 16] })).unwrap();
    let mut nested = table(&schema);
    (0..60).for_each(|n| add(&mut nested, n, &many));
    let (groups, rows) = read(nested.finish().unwrap());
    assert!(groups == 2 && rows.len() == 60, "{groups}");

    let number = FieldType { element: Element::Primitive(Primitive::F64), length: Length::One };
    let columns = [("t", Kind::Time), ("x", Kind::Field(number))];
    let columns = columns.map(|(name, kind)| Column { name: name.into(), kind });
    let mut flat = ParquetTable::new(Vec::new(), "rows", &columns).unwrap();
    let late = flat.row([Some(&Value::U64(1 << 63)), None]).unwrap_err().to_string();
    assert!(late.contains("year 2262"), "it would be one of 1677: {late}");
    (0..=ROWS).for_each(|_| flat.row([None, None]).unwrap());
    let (groups, rows) = read(flat.finish().unwrap());
    assert!(groups == 2 && rows.len() == ROWS + 1);
    assert!(rows.iter().all(|row| row.get_column_iter().all(|(_, value)| *value == Field::Null)));
}

#[test]
fn a_type_with_very_many_fields_is_refused() {
    let chain: String = (1..30).map(|n| format!("====\nMSG: p/T{n}\nT{0} a\nT{0} b\n", n + 1)).collect();
    let schema =
        Schema::parse("p/msg/T0", &format!("T1 a\nT1 b\n{chain}====\nMSG: p/T30\nint8 a\n")).unwrap();
    let kind =
        Kind::Field(FieldType { element: Element::Message(schema.root().clone()), length: Length::One });
    let refused = ParquetTable::new(Vec::new(), "rows", &[Column { name: "all".into(), kind }]);
    assert!(refused.err().unwrap().to_string().contains("20000 columns"));
}
