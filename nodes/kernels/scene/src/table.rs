//! Reading a TOML table field by field, collecting every fault instead of stopping at the first.

use crate::fault::Fault;
use toml::{Table, Value};

/// One table being read: knows its place in the text and which of its keys were asked for.
pub(crate) struct Reader<'a> {
    place: String,
    table: &'a Table,
    asked: Vec<&'static str>,
    faults: Vec<Fault>,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(place: impl Into<String>, table: &'a Table) -> Self {
        Self { place: place.into(), table, asked: Vec::new(), faults: Vec::new() }
    }

    /// Notes a fault at `key`, or at the table itself if `key` is empty.
    pub(crate) fn fault(&mut self, key: &str, message: impl Into<String>) {
        let place = match (self.place.as_str(), key) {
            ("", k) => k.to_string(),
            (p, "") => p.to_string(),
            (p, k) => format!("{p}.{k}"),
        };
        self.faults.push(Fault { place, message: message.into() });
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.table.contains_key(key)
    }

    pub(crate) fn get(&mut self, key: &'static str) -> Option<&'a Value> {
        self.asked.push(key);
        self.table.get(key)
    }

    /// A number in `range` (described by `requirement`); `default` where it is absent, a fault where there is no default.
    pub(crate) fn number(
        &mut self,
        key: &'static str,
        default: Option<f64>,
        requirement: &str,
        accept: impl Fn(f64) -> bool,
    ) -> f64 {
        let fallback = default.unwrap_or(f64::NAN);
        let Some(value) = self.get(key) else {
            if default.is_none() {
                self.fault(key, format!("is missing; it must be {requirement}"));
            }
            return fallback;
        };
        match as_number(value) {
            Some(v) if accept(v) => v,
            Some(v) => {
                self.fault(key, format!("is {v}; it must be {requirement}"));
                fallback
            }
            None => {
                self.fault(key, format!("is a {}; it must be {requirement}", value.type_str()));
                fallback
            }
        }
    }

    pub(crate) fn integer(&mut self, key: &'static str, default: Option<u64>, min: u64, max: u64) -> u64 {
        let requirement = format!("a whole number from {min} to {max}");
        let Some(value) = self.get(key) else {
            if default.is_none() {
                self.fault(key, format!("is missing; it must be {requirement}"));
            }
            return default.unwrap_or(min);
        };
        match value.as_integer().and_then(|v| u64::try_from(v).ok()) {
            Some(v) if (min..=max).contains(&v) => v,
            _ => {
                self.fault(key, format!("is {value}; it must be {requirement}"));
                default.unwrap_or(min)
            }
        }
    }

    pub(crate) fn boolean(&mut self, key: &'static str, default: bool) -> bool {
        match self.get(key) {
            None => default,
            Some(Value::Boolean(b)) => *b,
            Some(other) => {
                self.fault(key, format!("is {other}; it must be true or false"));
                default
            }
        }
    }

    pub(crate) fn text(&mut self, key: &'static str, default: Option<&str>) -> String {
        match self.get(key) {
            Some(Value::String(s)) => s.clone(),
            Some(other) => {
                self.fault(key, format!("is {other}; it must be a string"));
                String::new()
            }
            None => {
                if default.is_none() {
                    self.fault(key, "is missing; it must be a string");
                }
                default.unwrap_or_default().to_string()
            }
        }
    }

    /// One of the named choices.
    pub(crate) fn choice<T: Copy>(&mut self, key: &'static str, default: T, choices: &[(&str, T)]) -> T {
        let names = || choices.iter().map(|c| format!("{:?}", c.0)).collect::<Vec<_>>().join(" or ");
        match self.get(key) {
            None => default,
            Some(value) => match choices.iter().find(|c| Some(c.0) == value.as_str()) {
                Some(c) => c.1,
                None => {
                    self.fault(key, format!("is {value}; it must be {}", names()));
                    default
                }
            },
        }
    }

    /// A sub-table, read by `read`; `None` where it is absent.
    pub(crate) fn sub<T>(&mut self, key: &'static str, read: impl FnOnce(&mut Reader<'a>) -> T) -> Option<T> {
        match self.get(key) {
            None => None,
            Some(Value::Table(t)) => {
                let place =
                    if self.place.is_empty() { key.to_string() } else { format!("{}.{key}", self.place) };
                let mut reader = Reader::new(place, t);
                let out = read(&mut reader);
                self.faults.extend(reader.finish());
                Some(out)
            }
            Some(other) => {
                self.fault(key, format!("is a {}; it must be a table", other.type_str()));
                None
            }
        }
    }

    pub(crate) fn adopt(&mut self, faults: Vec<Fault>) {
        self.faults.extend(faults);
    }

    /// Ends the reading: keys never asked for are faults.
    pub(crate) fn finish(mut self) -> Vec<Fault> {
        let unknown: Vec<String> =
            self.table.keys().filter(|k| !self.asked.contains(&k.as_str())).cloned().collect();
        let mut known = self.asked.clone();
        known.sort_unstable();
        known.dedup();
        for key in unknown {
            self.fault(&key, format!("unknown key; known here: {}", known.join(", ")));
        }
        self.faults
    }
}

pub(crate) fn as_number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(v) => Some(*v),
        Value::Integer(v) => Some(*v as f64),
        _ => None,
    }
}
