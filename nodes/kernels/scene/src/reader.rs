//! Reading a TOML table key by key. All faults are collected, and what is read is kept, with defaults, as the
//! canonical form of the table.

use crate::canonical::{Entries, Entry, number};
use crate::fault::Fault;
use crate::key::{DefaultValue, Domain, Key};
use crate::nearest::{hint, nearest};
use toml::{Table, Value};

/// A table being read, with its place in the text and the keys read so far.
pub(crate) struct Reader<'a> {
    place: String,
    table: &'a Table,
    asked: Vec<&'static str>,
    faults: Vec<Fault>,
    entries: Entries,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(place: impl Into<String>, table: &'a Table) -> Self {
        let (asked, faults, entries) = <_>::default();
        Self { place: place.into(), table, asked, faults, entries }
    }

    /// Records a fault at `key`, or at the table if `key` is empty.
    pub(crate) fn fault(&mut self, key: &str, message: impl Into<String>) {
        let place = self.place_of(key);
        self.faults.push(Fault { place, message: message.into() });
    }

    pub(crate) fn is_sound(&self) -> bool {
        self.faults.is_empty()
    }

    pub(crate) fn place_of(&self, key: &str) -> String {
        match (self.place.as_str(), key) {
            ("", k) => k.to_string(),
            (p, "") => p.to_string(),
            (p, k) => format!("{p}.{k}"),
        }
    }

    /// Records that a key is missing or has an invalid value.
    pub(crate) fn refuse(&mut self, key: &Key, value: Option<&Value>) {
        let found = match value {
            None => "is missing".into(),
            Some(v @ (Value::Table(_) | Value::Array(_))) => format!("is {}", kind(v)),
            Some(Value::Float(v)) => format!("is {v:?}"),
            Some(v) => format!("is {v}"),
        };
        let written = match (key.domain, value) {
            (Domain::Whole(..), Some(Value::Float(_))) => ", written without a decimal point or exponent",
            _ => "",
        };
        self.fault(key.name(), format!("{found}; it must be {}{written}", key.requirement()));
    }

    pub(crate) fn has(&self, key: &Key) -> bool {
        self.table.contains_key(key.name())
    }

    pub(crate) fn get(&mut self, key: &Key) -> Option<&'a Value> {
        self.asked.push(key.name());
        self.table.get(key.name())
    }

    /// The value of a key that is not in the table of keys: a component.
    pub(crate) fn get_named(&mut self, name: &'static str) -> Option<&'a Value> {
        self.asked.push(name);
        self.table.get(name)
    }

    /// Adds to the canonical form what no method of this reader added.
    pub(crate) fn keep(&mut self, key: &Key, entry: Entry) {
        self.keep_named(key.name(), entry);
    }

    pub(crate) fn keep_named(&mut self, name: &'static str, entry: Entry) {
        self.entries.push((name, entry));
    }

    /// Removes a value without effect from the canonical form.
    pub(crate) fn leave_out(&mut self, keys: &[&Key]) {
        self.entries.retain(|(name, _)| keys.iter().all(|k| k.name() != *name));
    }

    /// A number; `default`, else the default of its key, if it is absent, a fault if there is neither.
    pub(crate) fn number(&mut self, key: &'static Key, default: Option<f64>) -> f64 {
        let of_key = if let DefaultValue::Number(value) = key.default { Some(value) } else { None };
        let default = default.or(of_key);
        let read = |value: &Value| number_of(key, value);
        self.read(key, default, read, |v| number(*v)).or(default).unwrap_or(f64::NAN)
    }

    /// A value as `read` takes it, or `default` if it is absent: kept as `entry` writes it, or refused.
    fn read<T>(
        &mut self,
        key: &'static Key,
        default: Option<T>,
        read: impl FnOnce(&'a Value) -> Option<T>,
        entry: impl FnOnce(&T) -> Entry,
    ) -> Option<T> {
        let value = self.get(key);
        let found = value.map_or(default, read);
        match &found {
            Some(found) => self.keep(key, entry(found)),
            None => self.refuse(key, value),
        }
        found
    }

    /// A number, if present; an invalid one is a fault and returned as 1.
    pub(crate) fn optional(&mut self, key: &'static Key) -> Option<f64> {
        self.get(key)?;
        Some(self.read(key, None, |value| number_of(key, value), |v| number(*v)).unwrap_or(1.0))
    }

    /// A whole number, as [`Reader::number`].
    pub(crate) fn whole(&mut self, key: &'static Key, default: Option<u64>) -> u64 {
        let of_key = if let DefaultValue::Whole(value) = key.default { Some(value) } else { None };
        let default = default.or(of_key);
        let (min, max) = if let Domain::Whole(min, max) = key.domain { (min, max) } else { (0, u64::MAX) };
        let within = |v: &u64| (min..=max).contains(v);
        let read = |value: &Value| u64::try_from(value.as_integer()?).ok().filter(within);
        let entry = |v: &u64| Entry::Value(v.to_string());
        self.read(key, default.filter(within), read, entry).or(default).unwrap_or(min)
    }

    pub(crate) fn flag(&mut self, key: &'static Key) -> bool {
        let default = matches!(key.default, DefaultValue::Flag(true));
        let entry = |v: &bool| Entry::Value(v.to_string());
        self.read(key, Some(default), Value::as_bool, entry).unwrap_or(default)
    }

    /// A text, as [`Reader::number`].
    pub(crate) fn text(&mut self, key: &'static Key, default: Option<&str>) -> String {
        let of_key = if let DefaultValue::Text(value) = key.default { Some(value) } else { None };
        let default = default.or(of_key);
        let read = |value: &Value| value.as_str().map(str::to_owned);
        let entry = |v: &String| Entry::Value(Value::from(v.as_str()).to_string());
        self.read(key, default.map(str::to_owned), read, entry).unwrap_or_default()
    }

    pub(crate) fn choice<T: Copy>(
        &mut self,
        key: &'static Key,
        default: &str,
        choices: &[(&'static str, T)],
    ) -> T {
        let named = |word: &str| choices.iter().find(|c| c.0 == word);
        let entry = |(word, _): &&(&str, T)| Entry::Value(format!("{word:?}"));
        let found = self.read(key, named(default), |value| named(value.as_str()?), entry);
        found.or(named(default)).unwrap_or(&choices[0]).1
    }

    /// A sub-table, read by `read`; `None` where it is absent, a fault if it is required.
    pub(crate) fn sub<T>(&mut self, key: &'static Key, read: impl FnOnce(&mut Reader<'_>) -> T) -> Option<T> {
        match self.get(key) {
            None => {
                if matches!(key.default, DefaultValue::Required) {
                    self.refuse(key, None);
                }
                None
            }
            Some(Value::Table(table)) => Some(self.read_table(key.name(), table, read)),
            Some(other) => {
                self.fault(key.name(), format!("is {}; it must be a table", kind(other)));
                None
            }
        }
    }

    /// A table at the top of the scene, read by `read` whether it is present or not: its keys have defaults.
    pub(crate) fn section<T>(&mut self, name: &'static str, read: impl FnOnce(&mut Reader<'_>) -> T) -> T {
        self.asked.push(name);
        let empty = Table::new();
        match self.table.get(name) {
            Some(Value::Table(table)) => self.read_table(name, table, read),
            None => self.read_table(name, &empty, read),
            Some(other) => {
                self.fault(name, format!("is {}; it must be a table", kind(other)));
                read(&mut Reader::new(name, &empty))
            }
        }
    }

    fn read_table<T>(
        &mut self,
        name: &'static str,
        table: &Table,
        read: impl FnOnce(&mut Reader<'_>) -> T,
    ) -> T {
        let mut reader = Reader::new(self.place_of(name), table);
        let out = read(&mut reader);
        let (entries, faults) = reader.finish();
        self.faults.extend(faults);
        self.entries.push((name, Entry::Table(entries)));
        out
    }

    pub(crate) fn adopt(&mut self, faults: Vec<Fault>) {
        self.faults.extend(faults);
    }

    /// Ends the reading: keys that were not read are faults.
    pub(crate) fn finish(mut self) -> (Entries, Vec<Fault>) {
        let mut known = std::mem::take(&mut self.asked);
        known.sort_unstable();
        known.dedup();
        for key in self.table.keys().filter(|k| !known.contains(&k.as_str())) {
            let place = self.place_of(key);
            let problem = needs(&place).unwrap_or_else(|| {
                let hint = nearest(key, known.iter().copied()).map_or_else(|| elsewhere(key), |k| hint(&k));
                format!("unknown key{hint}")
            });
            let message = format!("{problem}; known here: {}", known.join(", "));
            self.faults.push(Fault { place, message });
        }
        (self.entries, self.faults)
    }
}

/// Requirement of a key of the format that is not taken at its own place; `None` if there is no such key.
fn needs(place: &str) -> Option<String> {
    // A place such as `phase[1] (rest).until.speed`, which in a cycle has the place of the cycle before it.
    let path = place.rsplit_once("phase[").map_or_else(
        || place.to_owned(),
        |(_, own)| own.split_once('.').map_or_else(String::new, |(_, rest)| format!("phase.{rest}")),
    );
    let key = crate::keys::KEYS.iter().find(|k| k.path == path)?;
    let laws = crate::keys::LAW_KEYS.iter().filter(|(_, keys)| keys.iter().any(|k| k.path == path));
    let laws: Vec<String> = laws.map(|(law, _)| format!("law = {law:?}")).collect();
    let kinds: Vec<String> = key.kinds.iter().map(|kind| format!("kind = {kind:?}")).collect();
    let needed = if laws.is_empty() { kinds } else { laws };
    let needed = if needed.is_empty() { String::new() } else { format!(" needs {};", needed.join(" or ")) };
    Some(format!("is not taken here:{needed} {}", key.meaning))
}

fn elsewhere(name: &str) -> String {
    let found = crate::keys::KEYS.iter().find(|k| k.name() == name);
    found.map_or_else(String::new, |k| hint(&k.path.replacen("phase.", "phase.NAME.", 1)))
}

pub(crate) fn number_of(key: &Key, value: &Value) -> Option<f64> {
    as_number(value).filter(|v| match key.domain {
        Domain::Number(range) => range.contains(*v),
        _ => v.is_finite(),
    })
}

pub(crate) fn as_number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(v) => Some(*v),
        Value::Integer(v) => Some(*v as f64),
        _ => None,
    }
}

/// The type of a value, with its article.
pub(crate) fn kind(value: &Value) -> String {
    let kind = value.type_str();
    let article = if kind.starts_with(['a', 'i']) { "an" } else { "a" };
    format!("{article} {kind}")
}
