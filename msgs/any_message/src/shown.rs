//! Messages as JSON and as text.

use std::fmt::Write as _;

use serde::ser::{Serialize, SerializeMap, SerializeSeq, Serializer};

use crate::value::{Array, Message, Value};

/// A message to print, with all values or with long arrays shortened.
///
/// Numbers that are not finite are the strings `NaN`, `Infinity` and `-Infinity` in JSON, as in the JSON of protocol buffers.
/// An array that is shortened ends with a string that states how many values are left out.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    message: &'a Message,
    longest: usize,
}

impl<'a> Shown<'a> {
    /// Message with all values.
    pub fn new(message: &'a Message) -> Self {
        Self { message, longest: usize::MAX }
    }

    /// At most `longest` values of each array.
    #[must_use]
    pub fn shortened(self, longest: usize) -> Self {
        Self { longest, ..self }
    }

    /// As JSON in one line.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }

    /// As `ros2 topic echo` prints it: YAML, two spaces per level.
    pub fn text(&self) -> String {
        let mut text = String::new();
        block(self.message, self.longest, 0, &mut text);
        text
    }
}

impl Serialize for Shown<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let mut map = to.serialize_map(Some(self.message.values.len()))?;
        for (name, value) in self.message.fields() {
            map.serialize_entry(name, &Part { value, longest: self.longest })?;
        }
        map.end()
    }
}

struct Part<'a> {
    value: &'a Value,
    longest: usize,
}

impl Serialize for Part<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.value {
            Value::Bool(v) => v.serialize(to),
            Value::I8(v) => v.serialize(to),
            Value::U8(v) => v.serialize(to),
            Value::I16(v) => v.serialize(to),
            Value::U16(v) => v.serialize(to),
            Value::I32(v) => v.serialize(to),
            Value::U32(v) => v.serialize(to),
            Value::I64(v) => v.serialize(to),
            Value::U64(v) => v.serialize(to),
            Value::F32(v) => Single(*v).serialize(to),
            Value::F64(v) => Double(*v).serialize(to),
            Value::Text(v) => v.serialize(to),
            Value::Message(message) => Shown { message, longest: self.longest }.serialize(to),
            Value::Array(array) => List { array, longest: self.longest }.serialize(to),
        }
    }
}

pub(crate) struct List<'a> {
    array: &'a Array,
    longest: usize,
}

impl Array {
    /// All values as JSON in one line.
    pub fn json(&self) -> String {
        serde_json::to_string(&List { array: self, longest: usize::MAX }).unwrap_or_default()
    }
}

impl Serialize for List<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let shown = self.array.len().min(self.longest);
        let mut list = to.serialize_seq(None)?;
        match self.array {
            Array::U8(v) => v[..shown].iter().try_for_each(|v| list.serialize_element(v))?,
            Array::F64(v) => v[..shown].iter().try_for_each(|v| list.serialize_element(&Double(*v)))?,
            Array::Message(v) => v[..shown]
                .iter()
                .try_for_each(|message| list.serialize_element(&Shown { message, longest: self.longest }))?,
            others => (0..shown).filter_map(|at| others.get(at)).try_for_each(|value| {
                list.serialize_element(&Part { value: &value, longest: self.longest })
            })?,
        }
        if shown < self.array.len() {
            list.serialize_element(&left_out(self.array.len() - shown))?;
        }
        list.end()
    }
}

fn left_out(count: usize) -> String {
    format!("... {count} more")
}

fn not_finite(v: f64) -> &'static str {
    if v.is_nan() {
        "NaN"
    } else if v > 0.0 {
        "Infinity"
    } else {
        "-Infinity"
    }
}

struct Single(f32);
struct Double(f64);

impl Serialize for Single {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() {
            to.serialize_f32(self.0)
        } else {
            to.serialize_str(not_finite(self.0.into()))
        }
    }
}

impl Serialize for Double {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() { to.serialize_f64(self.0) } else { to.serialize_str(not_finite(self.0)) }
    }
}

// Writing to a String cannot fail.
fn block(message: &Message, longest: usize, level: usize, text: &mut String) {
    for (name, value) in message.fields() {
        let _ = write!(text, "{:1$}{name}:", "", 2 * level);
        match value {
            Value::Message(inner) => {
                text.push('\n');
                block(inner, longest, level + 1, text);
            }
            Value::Array(array) if !array.is_empty() => {
                text.push('\n');
                items(array, longest, level, text);
            }
            Value::Array(_) => text.push_str(" []\n"),
            scalar => {
                let _ = writeln!(text, " {}", plain(scalar));
            }
        }
    }
}

fn items(array: &Array, longest: usize, level: usize, text: &mut String) {
    let shown = array.len().min(longest);
    for at in 0..shown {
        if let Array::Message(messages) = array {
            let start = text.len();
            block(&messages[at], longest, level + 1, text);
            // The first field stands behind the dash.
            if text.len() > start {
                text.replace_range(start + 2 * level..start + 2 * level + 2, "- ");
            }
        } else if let Some(value) = array.get(at) {
            let _ = writeln!(text, "{:2$}- {}", "", plain(&value), 2 * level);
        }
    }
    if shown < array.len() {
        let _ = writeln!(text, "{:2$}- '{}'", "", left_out(array.len() - shown), 2 * level);
    }
}

/// A value that is neither a message nor an array.
fn plain(value: &Value) -> String {
    match value {
        Value::F32(v) if !v.is_finite() => yaml_not_finite((*v).into()),
        Value::F64(v) if !v.is_finite() => yaml_not_finite(*v),
        Value::Text(text) => match text.as_str() {
            "" => "''".to_owned(),
            simple if is_simple(simple) => simple.to_owned(),
            other => serde_json::Value::from(other).to_string(),
        },
        other => serde_json::to_string(&Part { value: other, longest: usize::MAX }).unwrap_or_default(),
    }
}

fn yaml_not_finite(v: f64) -> String {
    match not_finite(v) {
        "NaN" => ".nan",
        "Infinity" => ".inf",
        _ => "-.inf",
    }
    .to_owned()
}

/// True if YAML reads the text without quotes as the same string.
fn is_simple(text: &str) -> bool {
    let word = text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '/' || c == '_');
    let reserved = ["true", "false", "yes", "no", "on", "off", "null", "y", "n"];
    word && text.chars().all(|c| c.is_ascii_alphanumeric() || "_/.- ".contains(c))
        && !text.ends_with(' ')
        && !reserved.contains(&text.to_ascii_lowercase().as_str())
}
