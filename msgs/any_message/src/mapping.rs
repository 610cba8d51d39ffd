//! A definition compared with another one of the same type, and messages of the one as messages of the other.
//!
//! Bytes of CDR have no names: they are read by the definition that they were written with, or not at all.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::decode::DecodeError;
use crate::schema::Schema;
use crate::types::{Element, FieldType, Length, MessageType};
use crate::value::{Array, Message, Value};

/// Relation of a definition to the one that is wanted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// Names, types, order and constants are the same; comments and defaults may differ.
    Same,
    /// Every wanted field exists under its name and with its type, or is a list that was added later, which is read as empty.
    Mapped(Mapping),
    /// A wanted field is missing or has another type, or a constant has another meaning: what differs.
    Differs(Vec<String>),
}

/// Messages of one definition as messages of another one, by the names of their fields.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mapping {
    from: Schema,
    to: Schema,
    notes: Vec<String>,
}

impl Mapping {
    /// Differences that a reader should know: an order, fields that are left out. Lists that are read as empty are none.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The bytes of a message as those of the wanted definition, little endian.
    ///
    /// # Errors
    /// If they are not a message of the first definition.
    pub fn apply(&self, bytes: &[u8]) -> Result<Vec<u8>, DecodeError> {
        Ok(by_names(self.from.decode(bytes)?, self.to.root()).encode())
    }
}

impl Schema {
    /// Compares this definition, with which messages were written, with the one by which they will be read.
    ///
    /// ```
    /// use grainlab_any_message::{Comparison, Schema};
    /// let [written, wanted] = ["float64 g\nfloat64 nu", "float64 nu\nfloat64 g"].map(|t| Schema::parse("p/msg/A", t).unwrap());
    /// assert_eq!(written.compare(&written), Comparison::Same);
    /// let Comparison::Mapped(mapping) = written.compare(&wanted) else { panic!("by names") };
    /// assert_eq!(mapping.notes(), ["the fields of p/A are in another order"]);
    /// ```
    pub fn compare(&self, wanted: &Self) -> Comparison {
        let mut found = Differences::default();
        if self.root().name != wanted.root().name {
            found.faults.push(format!("its type is {}, not {}", self.root().name, wanted.root().name));
        }
        found.message(self.root(), wanted.root());
        match found {
            Differences { faults, .. } if !faults.is_empty() => Comparison::Differs(faults),
            Differences { notes, added: false, .. } if notes.is_empty() => Comparison::Same,
            Differences { notes, .. } => {
                Comparison::Mapped(Mapping { from: self.clone(), to: wanted.clone(), notes })
            }
        }
    }
}

#[derive(Default)]
struct Differences {
    faults: Vec<String>,
    notes: Vec<String>,
    /// True if a list was added since the messages were written.
    added: bool,
    /// Types that were compared.
    done: BTreeSet<String>,
}

impl Differences {
    fn message(&mut self, written: &MessageType, wanted: &MessageType) {
        let name = &wanted.name;
        if !self.done.insert(name.clone()) {
            return;
        }
        let is_wanted = |own: &&str| wanted.fields.iter().any(|f| f.name == *own);
        let all: Vec<&str> = written.fields.iter().map(|f| f.name.as_str()).collect();
        // A field that is not known may be the list under another name.
        let is_earlier = all.iter().all(&is_wanted);
        for field in &wanted.fields {
            match written.fields.iter().find(|f| f.name == field.name) {
                None if is_earlier && matches!(field.kind.length, Length::Any(_)) => self.added = true,
                None => self.faults.push(format!("{name} has no field {}", field.name)),
                Some(own) => match (&own.kind.element, &field.kind.element) {
                    _ if !fits(&own.kind, &field.kind) => self
                        .faults
                        .push(format!("{} of {name} is {}, not {}", field.name, own.kind, field.kind)),
                    (Element::Message(own), Element::Message(inner)) => self.message(own, inner),
                    _ => {}
                },
            }
        }
        for more in all.iter().filter(|own| !is_wanted(own)) {
            self.notes.push(format!("{more} of {name} is not read"));
        }
        let common: Vec<&str> = all.into_iter().filter(is_wanted).collect();
        let in_order = wanted.fields.iter().filter(|f| common.contains(&f.name.as_str()));
        if common.iter().zip(in_order).any(|(a, b)| **a != b.name) {
            self.notes.push(format!("the fields of {name} are in another order"));
        }
        // A constant that is not known, or has another value, gives a field another meaning.
        for own in &written.constants {
            match wanted.constants.iter().find(|c| c.name == own.name) {
                Some(known) if known.value.trim() == own.value.trim() => {}
                Some(known) => self.faults.push(format!(
                    "the constant {} of {name} is {}, not {}",
                    own.name, own.value, known.value
                )),
                None => self.faults.push(format!("the constant {} of {name} is not known", own.name)),
            }
        }
    }
}

/// True if every value of the type is a value of the wanted one, with the same name.
fn fits(own: &FieldType, wanted: &FieldType) -> bool {
    let within = |own: Option<u32>, most: Option<u32>| most.is_none_or(|most| own.is_some_and(|n| n <= most));
    let element = match (&own.element, &wanted.element) {
        (Element::Primitive(a), Element::Primitive(b)) => a == b,
        (Element::String(a), Element::String(b)) | (Element::WString(a), Element::WString(b)) => {
            within(*a, *b)
        }
        (Element::Message(a), Element::Message(b)) => a.name == b.name,
        _ => false,
    };
    element
        && match (own.length, wanted.length) {
            (Length::Any(a), Length::Any(b)) => within(a, b),
            (a, b) => a == b,
        }
}

/// Returns the message with the fields of `wanted`. Of those, it has all but lists, which are then empty.
fn by_names(message: Message, wanted: &Arc<MessageType>) -> Message {
    let Message { kind, values } = message;
    let mut own: Vec<_> =
        kind.fields.iter().map(|f| f.name.as_str()).zip(values.into_iter().map(Some)).collect();
    let mut take = |name: &str| own.iter_mut().find(|(n, _)| *n == name).and_then(|(_, value)| value.take());
    let values = wanted.fields.iter().map(|field| match (take(&field.name), &field.kind.element) {
        (Some(Value::Message(inner)), Element::Message(kind)) => Value::Message(by_names(inner, kind)),
        (Some(Value::Array(Array::Message(all))), Element::Message(kind)) => {
            Value::Array(Array::Message(all.into_iter().map(|m| by_names(m, kind)).collect()))
        }
        (Some(value), _) => value,
        (None, element) => Value::Array(Array::empty(element)),
    });
    Message { values: values.collect(), kind: wanted.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WANTED: &str = "uint8 HELD=0\nuint8 mode\nfloat64 g\nfloat64 nu\nInner[] all\nstring name\n";
    const INNER: &str = "int32 a\nfloat64[2] b\n";

    fn schema(root: &str, inner: &str) -> Schema {
        let bar = "=".repeat(80);
        Schema::parse("p/msg/A", &format!("{root}{bar}\nMSG: p/Inner\n{inner}")).unwrap()
    }

    #[test]
    fn a_definition_that_differs_in_a_name_a_type_or_a_constant_is_refused_with_what_differs() {
        let wanted = schema(WANTED, INNER);
        for (from, to, says) in [
            ("float64 g\n", "float64 shear\n", "p/A has no field g"),
            ("float64 g\n", "", "p/A has no field g"),
            ("float64 g", "float32 g", "g of p/A is float32, not float64"),
            ("float64 g", "float64[1] g", "g of p/A is float64[1], not float64"),
            ("Inner[] all", "Inner all", "all of p/A is p/Inner, not p/Inner[]"),
            ("HELD=0", "HELD=1", "the constant HELD of p/A is 1, not 0"),
            ("HELD=0", "FREE=0", "the constant FREE of p/A is not known"),
        ] {
            let Comparison::Differs(faults) = schema(&WANTED.replace(from, to), INNER).compare(&wanted)
            else {
                panic!("{from} as {to} is not refused")
            };
            assert_eq!(faults, [says]);
        }
        let other = schema(WANTED, "int32 a\nfloat64[3] b\n").compare(&wanted);
        assert_eq!(other, Comparison::Differs(vec!["b of p/Inner is float64[3], not float64[2]".into()]));
    }

    #[test]
    fn a_list_that_was_added_later_is_read_as_empty_without_a_note() {
        let wanted = schema(WANTED, INNER);
        for (line, shown) in
            [("Inner[] all\n", "all"), ("string[] texts\n", "texts"), ("float64[<=3] few\n", "few")]
        {
            let written = schema(&WANTED.replace("Inner[] all\n", ""), INNER);
            let wanted = schema(&WANTED.replace("Inner[] all\n", line), INNER);
            let Comparison::Mapped(mapping) = written.compare(&wanted) else { panic!("{line}") };
            assert!(mapping.notes().is_empty(), "{:?}", mapping.notes());
            let values = vec![Value::U8(0), Value::F64(1.0), Value::F64(0.2), Value::Text("a".into())];
            let message = Message { kind: written.root().clone(), values };
            let read = wanted.decode(&mapping.apply(&message.encode()).unwrap()).unwrap();
            assert!(
                crate::Shown::new(&read).json().contains(&format!(r#""{shown}":[],"name":"a""#)),
                "{read:?}"
            );
        }
        // A list with another name is not one that was added.
        let renamed = schema(&WANTED.replace("[] all", "[] every"), INNER);
        assert_eq!(renamed.compare(&wanted), Comparison::Differs(vec!["p/A has no field all".into()]));
    }

    #[test]
    fn comments_defaults_and_names_of_one_byte_are_no_difference() {
        let wanted = schema(WANTED, INNER);
        let other =
            WANTED.replace("uint8 mode", "byte mode 0 # the mode").replace("float64 nu", "# nu\nfloat64 nu");
        assert_eq!(schema(&other, INNER).compare(&wanted), Comparison::Same);
    }

    #[test]
    fn messages_with_fields_in_another_order_and_more_fields_are_read_by_names() {
        let wanted = schema(WANTED, INNER);
        let written = schema(
            "string name\nInner[] all\nfloat64 nu\nfloat64 more\nfloat64 g\nuint8 mode\n",
            "float64[2] b\nint8 c\nint32 a\n",
        );
        let inner = |n: f64| {
            let Element::Message(kind) = &written.root().fields[1].kind.element else { panic!("inner") };
            Message {
                kind: kind.clone(),
                values: vec![Value::Array(Array::F64(vec![n, -n])), Value::I8(9), Value::I32(n as i32)],
            }
        };
        let message = Message {
            kind: written.root().clone(),
            values: vec![
                Value::Text("né".into()),
                Value::Array(Array::Message(vec![inner(1.0), inner(2.0)])),
                Value::F64(0.2),
                Value::F64(f64::NAN),
                Value::F64(29e9),
                Value::U8(3),
            ],
        };
        let Comparison::Mapped(mapping) = written.compare(&wanted) else { panic!("not mapped") };
        assert_eq!(mapping.notes().len(), 4, "{:?}", mapping.notes());
        let read = wanted.decode(&mapping.apply(&message.encode()).unwrap()).unwrap();
        assert_eq!(
            crate::Shown::new(&read).json(),
            r#"{"mode":3,"g":29000000000.0,"nu":0.2,"all":[{"a":1,"b":[1.0,-1.0]},{"a":2,"b":[2.0,-2.0]}],"name":"né"}"#
        );
    }
}
