//! YAML of any shape, and the parameter values in it.

use super::value::ParameterValue;
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use std::fmt;

/// A YAML document of any shape; mappings keep the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Yaml {
    Null,
    Bool(bool),
    Integer(i64),
    Double(f64),
    Text(String),
    List(Vec<Yaml>),
    Map(Vec<(String, Yaml)>),
}

/// The value of a parameter written as YAML, as on a command line: `0.5`, `true`, `[1, 2]`, `text`.
///
/// # Errors
/// With the reason, for text that is not YAML or of a type that no parameter has.
pub fn parse_value(yaml: &str) -> Result<ParameterValue, String> {
    Yaml::parse(yaml).and_then(Yaml::into_value)
}

impl Yaml {
    /// Reads one document. Non-finite numbers are read as numbers; ranges decide on them later.
    pub(super) fn parse(text: &str) -> Result<Yaml, String> {
        let options = serde_saphyr::options! {
            non_finite_float_policy: serde_saphyr::NonFiniteFloatPolicy::PassThrough,
        };
        serde_saphyr::from_str_with_options(text, options).map_err(|e| e.to_string())
    }

    fn kind(&self) -> &'static str {
        match self {
            Yaml::Null => "nothing",
            Yaml::Bool(_) => "bool",
            Yaml::Integer(_) => "integer",
            Yaml::Double(_) => "double",
            Yaml::Text(_) => "string",
            Yaml::List(_) => "list",
            Yaml::Map(_) => "mapping",
        }
    }

    /// Converts it to a parameter value. A list must hold values of one type; integers among doubles become doubles.
    pub(super) fn into_value(self) -> Result<ParameterValue, String> {
        match self {
            Yaml::Bool(v) => Ok(ParameterValue::Boolean(v)),
            Yaml::Integer(v) => Ok(ParameterValue::Integer(v)),
            Yaml::Double(v) => Ok(ParameterValue::Double(v)),
            Yaml::Text(v) => Ok(ParameterValue::String(v)),
            Yaml::List(items) => list(&items),
            other => Err(format!("{} is not a parameter value", other.kind())),
        }
    }
}

fn list(items: &[Yaml]) -> Result<ParameterValue, String> {
    fn all<T>(items: &[Yaml], pick: impl Fn(&Yaml) -> Option<T>) -> Option<Vec<T>> {
        items.iter().map(pick).collect()
    }
    let integers = |y: &Yaml| if let Yaml::Integer(v) = y { Some(*v) } else { None };
    let doubles = |y: &Yaml| match y {
        Yaml::Double(v) => Some(*v),
        Yaml::Integer(v) => Some(*v as f64),
        _ => None,
    };
    let bools = |y: &Yaml| if let Yaml::Bool(v) = y { Some(*v) } else { None };
    let texts = |y: &Yaml| if let Yaml::Text(v) = y { Some(v.clone()) } else { None };
    all(items, integers)
        .map(ParameterValue::IntegerArray)
        .or_else(|| all(items, doubles).map(ParameterValue::DoubleArray))
        .or_else(|| all(items, bools).map(ParameterValue::BooleanArray))
        .or_else(|| all(items, texts).map(ParameterValue::StringArray))
        .ok_or_else(|| {
            let kinds: Vec<&str> = items.iter().map(Yaml::kind).collect();
            format!("a list must hold values of one type, this one holds {}", kinds.join(", "))
        })
}

impl<'de> Deserialize<'de> for Yaml {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl<'de> Visitor<'de> for Any {
            type Value = Yaml;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("YAML")
            }
            fn visit_unit<E>(self) -> Result<Yaml, E> {
                Ok(Yaml::Null)
            }
            fn visit_bool<E>(self, v: bool) -> Result<Yaml, E> {
                Ok(Yaml::Bool(v))
            }
            fn visit_i64<E>(self, v: i64) -> Result<Yaml, E> {
                Ok(Yaml::Integer(v))
            }
            fn visit_u64<E: serde::de::Error>(self, v: u64) -> Result<Yaml, E> {
                i64::try_from(v)
                    .map(Yaml::Integer)
                    .map_err(|_| E::custom(format!("{v} does not fit 64 bits with a sign")))
            }
            fn visit_f64<E>(self, v: f64) -> Result<Yaml, E> {
                Ok(Yaml::Double(v))
            }
            fn visit_str<E>(self, v: &str) -> Result<Yaml, E> {
                Ok(Yaml::Text(v.into()))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Yaml, A::Error> {
                let mut items = Vec::new();
                while let Some(item) = seq.next_element()? {
                    items.push(item);
                }
                Ok(Yaml::List(items))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Yaml, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry::<String, Yaml>()? {
                    entries.push(entry);
                }
                Ok(Yaml::Map(entries))
            }
        }
        deserializer.deserialize_any(Any)
    }
}
