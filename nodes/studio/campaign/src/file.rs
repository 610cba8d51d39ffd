//! The keys of the file of a campaign. The parser and its errors use these tables, and the reference is written from them.

use grainlab_console::Failure;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use toml::{Table, Value};

/// Messages that the recording of a member has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Record {
    #[default]
    Results,
    All,
}

pub(crate) struct Key {
    pub(crate) name: &'static str,
    /// True if each `[[group]]` has it, too.
    pub(crate) in_groups: bool,
    /// Values that it takes.
    pub(crate) form: &'static str,
    pub(crate) default: &'static str,
    pub(crate) meaning: &'static str,
}

/// Declares the fields of the file, and the same as [`KEYS`]: of the whole campaign, and with `in_groups` of its runs.
macro_rules! keys {
    ($($name:ident: $type:ty, $in_groups:literal, $form:literal, $default:literal, $meaning:literal;)*) => {
        /// The file of a campaign, or a `[[group]]` of it.
        #[derive(Debug, Default)]
        pub(crate) struct CampaignFile {
            $(#[doc = $meaning] pub(crate) $name: $type,)*
        }

        /// Every key, in the order of the reference.
        pub(crate) const KEYS: &[Key] = &[$(Key {
            name: stringify!($name), in_groups: $in_groups, form: $form, default: $default, meaning: $meaning,
        },)*];

        impl CampaignFile {
            /// Reads the file, at an empty place, or a group.
            pub(crate) fn read(mut table: Table, place: &str) -> Result<Self, Failure> {
                refuse_unknown(&table, place)?;
                Ok(Self { $($name: take(&mut table, place, stringify!($name), $form)?,)* })
            }
        }
    };
}

keys! {
    name: String, false, "letters, digits, _ and -", "required", "name of the campaign, and of its folder";
    description: String, false, "text in quotes", "empty", "description in one line";
    launch: Option<String>, false, "text in quotes", "`\"demo\"`", "launch file of every run: a built-in one by name, or a file by its path from this one";
    arguments: BTreeMap<String, Value>, false, "a table", "none", "values for arguments of the launch file, as in { threads = 2 }";
    record: Record, false, "\"results\" or \"all\"", "`\"results\"`", "messages to record: packings, and what is measured of them and inferred, or every message";
    report: bool, false, "true or false", "`false`", "each run has a page, report.html";
    table: Option<String>, false, "text in quotes", "none", "CSV with a run in each row, by its path from this file: columns scene, seed, and keys of scenes; an empty cell sets nothing";
    group: Vec<Table>, false, "tables: [[group]]", "none", "more runs; what set says at the top holds for them, too";
    scenes: Vec<String>, true, "a list of texts", "none", "scenes, each run with every combination of values and every seed: built-in ones by name, or files by their paths from this file";
    seeds: Option<Seeds>, true, "a list of whole numbers from 0, or { first = 1, count = 5 }", "required with scenes", "seeds of every combination";
    set: Table, true, "a table of keys of scenes", "none", "keys set in every scene; at the top also in those of groups and of the table";
    vary: Table, true, "a table of keys of scenes, each with a list of values", "none", "keys of which every combination of values is run";
    together: Vec<Table>, true, "tables like vary, with lists of one length: [[together]]", "none", "keys that vary in step, the n-th values together; combined with vary and with other such tables";
}

fn take<T: Default + DeserializeOwned>(
    table: &mut Table,
    at: &str,
    key: &str,
    form: &str,
) -> Result<T, Failure> {
    let Some(value) = table.remove(key) else { return Ok(T::default()) };
    let fault = |_| Failure::usage(format!("{at}{key} is {value}: it must be {form}"));
    value.clone().try_into().map_err(fault)
}

fn refuse_unknown(table: &Table, place: &str) -> Result<(), Failure> {
    let known = KEYS.iter().filter(|k| place.is_empty() || k.in_groups).map(|k| k.name);
    let known: Vec<&str> = known.collect();
    let Some(key) = table.keys().find(|key| !known.contains(&key.as_str())) else { return Ok(()) };
    Err(Failure::usage(format!(
        "{place}{key}: unknown key; known here: {}; keys of scenes belong under set, vary or together",
        known.join(", ")
    )))
}

#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
pub(crate) enum Seeds {
    List(Vec<u64>),
    Range { first: u64, count: u64 },
}

impl Seeds {
    pub(crate) fn all(&self, most: usize) -> Vec<u64> {
        match self {
            Self::List(seeds) => seeds.iter().take(most).copied().collect(),
            Self::Range { first, count } => (*first..first.saturating_add(*count)).take(most).collect(),
        }
    }
}
