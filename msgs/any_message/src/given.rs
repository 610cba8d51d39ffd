//! Messages from values that a user writes.

use std::sync::Arc;

use serde_json::Value as Json;

use crate::schema::Schema;
use crate::types::{Element, FieldType, Length, MessageType, Primitive};
use crate::value::{Array, Message, Value};

impl Schema {
    /// The message with these values of fields, as JSON or YAML has them. Fields that are not given have their defaults, or 0, an empty
    /// text, no elements. Numbers that are not finite are texts, as [`Shown::json`](crate::Shown::json) or YAML (`.inf`) writes them.
    ///
    /// # Errors
    /// A value that its field does not hold, or a field that the type does not have: with its path.
    ///
    /// ```
    /// use grainlab_any_message::{Schema, Shown};
    /// let schema = Schema::parse("p/msg/A", "int8 a\nfloat64[] x\nstring name \"none\"").unwrap();
    /// let message = schema.given(&serde_json::json!({"a": 3, "x": [1, 2.5]})).unwrap();
    /// assert_eq!(Shown::new(&message).json(), r#"{"a":3,"x":[1.0,2.5],"name":"none"}"#);
    /// assert_eq!(schema.given(&serde_json::json!({"a": 300})).unwrap_err(), "a: 300 is not of the type int8");
    /// ```
    pub fn given(&self, values: &Json) -> Result<Message, String> {
        message(self.root(), Some(values))
            .map_err(|fault| fault.trim_start_matches(['.', ':', ' ']).to_owned())
    }
}

fn message(kind: &Arc<MessageType>, given: Option<&Json>) -> Result<Message, String> {
    let none = serde_json::Map::new();
    let map = match given {
        None | Some(Json::Null) => &none,
        Some(Json::Object(map)) => map,
        Some(other) => return Err(format!(": {other} is not a map of the fields of {}", kind.name)),
    };
    if let Some(name) = map.keys().find(|name| !kind.fields.iter().any(|f| f.name == **name)) {
        let names: Vec<&str> = kind.fields.iter().map(|f| f.name.as_str()).collect();
        return Err(format!(": {} has no field {name:?}; its fields are: {}", kind.name, names.join(", ")));
    }
    let of = |field: &crate::types::Field| {
        let default = field.default.as_deref().map(written);
        value(&field.kind, map.get(&field.name).or(default.as_ref()))
            .map_err(|fault| format!(".{}{fault}", field.name))
    };
    Ok(Message { kind: kind.clone(), values: kind.fields.iter().map(of).collect::<Result<_, _>>()? })
}

fn written(text: &str) -> Json {
    let plain = text.replace('\'', "\"").replace("True", "true").replace("False", "false");
    serde_json::from_str(&plain).unwrap_or_else(|_| Json::String(text.to_owned()))
}

fn value(kind: &FieldType, given: Option<&Json>) -> Result<Value, String> {
    if kind.length == Length::One {
        return one(&kind.element, given);
    }
    let values = match given {
        None => &Vec::new(),
        Some(Json::Array(all)) => all,
        Some(other) => return Err(wrong(other, kind)),
    };
    let count = match kind.length {
        Length::Fixed(n) if given.is_none() => n as usize,
        Length::Fixed(n) if values.len() != n as usize => {
            return Err(format!(": {} values, and {kind} has {n}", values.len()));
        }
        Length::Any(Some(most)) if values.len() > most as usize => {
            return Err(format!(": {} values, and {kind} has at most {most}", values.len()));
        }
        _ => values.len(),
    };
    let each = |k: usize| one(&kind.element, values.get(k)).map_err(|fault| format!("[{k}]{fault}"));
    let all = (0..count).map(each).collect::<Result<Vec<_>, _>>()?;
    Ok(Value::Array(gathered(&kind.element, all)))
}

fn wrong(given: &Json, kind: &FieldType) -> String {
    let is_large = given.is_number() && kind.element == Element::Primitive(Primitive::F32);
    let range = if is_large { format!(", {:e} to {:e}", f32::MIN, f32::MAX) } else { String::new() };
    format!(": {given} is not of the type {kind}{range}")
}

fn one(element: &Element, given: Option<&Json>) -> Result<Value, String> {
    let found = match element {
        Element::Message(kind) => return message(kind, given).map(Value::Message),
        Element::String(most) | Element::WString(most) => {
            let text = given.map_or(Some(""), Json::as_str);
            text.filter(|text| most.is_none_or(|most| text.len() <= most as usize))
                .map(|text| Value::Text(text.into()))
        }
        Element::Primitive(kind) => primitive(*kind, given.unwrap_or(&Json::from(0))),
    };
    let kind = FieldType { element: element.clone(), length: Length::One };
    found.ok_or_else(|| wrong(given.unwrap_or(&Json::Null), &kind))
}

fn primitive(kind: Primitive, given: &Json) -> Option<Value> {
    let float = || match given.as_str() {
        Some(text) => text.replacen('.', "", 1).parse::<f64>().ok().filter(|value| !value.is_finite()),
        None => given.as_f64(),
    };
    let bit = || given.as_u64().filter(|n| *n < 2).map(|n| n == 1);
    Some(match kind {
        Primitive::Bool => Value::Bool(given.as_bool().or_else(bit)?),
        Primitive::I8 => Value::I8(given.as_i64()?.try_into().ok()?),
        Primitive::U8 => Value::U8(given.as_u64()?.try_into().ok()?),
        Primitive::I16 => Value::I16(given.as_i64()?.try_into().ok()?),
        Primitive::U16 => Value::U16(given.as_u64()?.try_into().ok()?),
        Primitive::I32 => Value::I32(given.as_i64()?.try_into().ok()?),
        Primitive::U32 => Value::U32(given.as_u64()?.try_into().ok()?),
        Primitive::I64 => Value::I64(given.as_i64()?),
        Primitive::U64 => Value::U64(given.as_u64()?),
        Primitive::F32 => {
            let wide = float()?;
            Value::F32(Some(wide as f32).filter(|v| v.is_finite() == wide.is_finite())?)
        }
        Primitive::F64 => Value::F64(float()?),
    })
}

fn gathered(element: &Element, all: Vec<Value>) -> Array {
    let all = all.into_iter();
    match element {
        Element::Primitive(kind) => Array::of(*kind, all.collect()),
        Element::String(_) | Element::WString(_) => {
            Array::Text(all.filter_map(|v| if let Value::Text(v) = v { Some(v) } else { None }).collect())
        }
        Element::Message(_) => Array::Message(
            all.filter_map(|v| if let Value::Message(v) = v { Some(v) } else { None }).collect(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_yaml_that_are_not_finite_are_taken_and_those_beyond_float32_are_refused_with_its_range() {
        let schema = Schema::parse("p/msg/A", "float32 x\nfloat64 y").unwrap();
        let given = |x: Json, y: Json| schema.given(&serde_json::json!({"x": x, "y": y}));
        let both = given("-.inf".into(), ".nan".into()).unwrap();
        assert!(matches!(both.values[0], Value::F32(f32::NEG_INFINITY)));
        assert!(matches!(both.values[1], Value::F64(y) if y.is_nan()));
        let refused = given(Json::from(1e300), Json::from(1e300)).unwrap_err();
        assert!(refused.ends_with("is not of the type float32, -3.4028235e38 to 3.4028235e38"), "{refused}");
        assert!(given(Json::from(0), "1.5".into()).is_err());
    }
}
