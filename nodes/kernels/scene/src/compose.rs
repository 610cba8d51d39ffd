//! A scene from a base and its changes.
//!
//! Tables are merged key by key, every other value replaces that of the base, and `"unset"` removes it. A
//! path is an array, so `[[phase]]` replaces it whole; `[phase.NAME]` changes the phase of that name,
//! `remove` leaves phases out and `[[append]]` adds some, in this order. Keys set on a command line are
//! merged in the same way. `pressure` comes last in each layer.

use crate::built_in::built_in;
use crate::contact;
use crate::fault::{Fault, SceneError};
use crate::model::{Scene, Start};
use crate::overlay::overlay;
use crate::parse::{Resolved, read};
use crate::pressure;
use crate::reader::{Reader, as_number};
use grainlab_core::Packing;
use grainlab_core::contact::ContactLaw;
use std::collections::BTreeMap;
use toml::{Table, Value};

/// The text of a base.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// Identity of the base: the built-in name, or the whole path.
    pub name: String,
    /// Text in TOML.
    pub text: String,
}

/// Looks a base up by its name as written and the name of the source that contains it. The error is the
/// reason of a failure.
pub type Library<'a> = &'a dyn Fn(&str, &str) -> Result<Source, String>;

/// A scene as a table: its bases are merged, its values are not checked yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    table: Table,
    /// The sources that contain the paths of files to start from, by key of `[start]`.
    start_from: BTreeMap<&'static str, String>,
    /// Keys set outside the texts, as `KEY=VALUE`.
    overrides: Vec<String>,
}

/// Keys that no description contradicts.
const NEVER_DESCRIBED: [&str; 3] = ["name", "description", "seed"];

/// The keys of `[start]` that name files.
const FILES: [&str; 2] = ["packing", "contact_forces"];

impl Scene {
    /// Parses a scene. The error has every fault of the text. A base must be built in.
    ///
    /// ```
    /// let faults = grainlab_scene::Scene::parse("name = 'x'\nfriktion = 1").unwrap_err().faults;
    /// assert!(faults.iter().any(|f| f.place == "friktion" && f.message.starts_with("unknown key")));
    /// ```
    pub fn parse(text: &str) -> Result<Scene, SceneError> {
        Ok(Draft::of_text(text)?.resolve()?.scene)
    }
}

impl Draft {
    /// From a text whose base, if any, is built in.
    pub fn of_text(text: &str) -> Result<Draft, SceneError> {
        let source = Source { name: "scene".into(), text: text.into() };
        Self::of(&source, &|base, _| {
            let text = built_in(base).ok_or("only built-in scenes are known here")?;
            Ok(Source { name: base.into(), text: text.into() })
        })
    }

    /// From a text, with bases from `library`.
    ///
    /// # Errors
    /// A text that is invalid TOML, a base that is not found, a circle of bases, and overrides of missing
    /// keys.
    pub fn of(source: &Source, library: Library<'_>) -> Result<Draft, SceneError> {
        let (mut layers, mut names) = (Vec::new(), vec![source.name.clone()]);
        let mut next = Some(source.clone());
        while let Some(source) = next.take() {
            let mut table = parse(&source, names.len() > 1)?;
            if let Some(base) = table.remove("base") {
                let found = find(&base, &source.name, library).map_err(|m| SceneError::one("base", m))?;
                let circle = names.contains(&found.name);
                names.push(found.name.clone());
                if circle {
                    return Err(SceneError::one("base", format!("is a circle: {}", names.join(" -> "))));
                }
                next = Some(found);
            }
            layers.push((source.name, table));
        }
        let named =
            |key: &'static str| Some((key, layers.iter().find(|(_, table)| has_key(table, key))?.0.clone()));
        let start_from = FILES.into_iter().filter_map(named).collect();
        let mut table = layers.pop().unwrap_or_default().1;
        let mut faults = pressure::apply(&mut table);
        for (_, layer) in layers.into_iter().rev() {
            faults.extend(merge(&mut table, layer));
        }
        SceneError::of(faults).map(|()| Draft { table, start_from, overrides: Vec::new() })
    }

    /// Merges keys into the scene, as [`crate::assignment`] parses them. They are added to its description.
    pub fn set(&mut self, keys: Table) -> Result<(), SceneError> {
        named(&keys, "", &mut self.overrides);
        self.start_from.retain(|key, _| !has_key(&keys, key));
        SceneError::of(merge(&mut self.table, keys))
    }

    /// The packing that the scene starts from, if any: to be read and given to [`Draft::resolve_from`]. Paths are relative to the
    /// source that contains them; without a step it is the last packing.
    pub fn start(&self) -> Option<Start> {
        let start = self.table.get("start")?.as_table()?;
        let path = |key: &str| start.get(key)?.as_str().map(str::to_owned);
        let columns = start.get("contact_columns").and_then(Value::as_array).into_iter().flatten();
        Some(Start {
            packing: path("packing")?,
            contact_forces: path("contact_forces"),
            contact_columns: columns.filter_map(|name| name.as_str().map(str::to_owned)).collect(),
            step: start.get("step").and_then(Value::as_integer).and_then(|s| u64::try_from(s).ok()),
            // Others are refused where the scene is resolved.
            copies: start
                .get("copies")
                .and_then(Value::as_integer)
                .and_then(|n| u32::try_from(n).ok())
                .unwrap_or(1),
        })
    }

    /// The source that contains the path under this key of `[start]`; `None` if the path was set outside the scene.
    pub fn source_of(&self, key: &str) -> Option<&str> {
        self.start_from.get(key).map(String::as_str)
    }

    /// Sets the packing to start from by the whole paths of its files and its solver step. Other keys of `[start]` stay.
    pub fn start_at(&mut self, packing: &str, contact_forces: Option<&str>, step: u64) {
        let Some(start) = self.table.get_mut("start").and_then(Value::as_table_mut) else { return };
        start.insert("packing".into(), packing.into());
        start.insert("step".into(), Value::from(step as i64));
        contact_forces.map(|path| start.insert("contact_forces".into(), path.into()));
        self.start_from.clear();
    }

    /// The contact law of the scene, if it names a valid one: that of a packing whose file has none.
    pub fn law(&self) -> Option<ContactLaw> {
        let mut r = Reader::new("contact", self.table.get("contact")?.as_table()?);
        let law = contact::read(&mut r, &ContactLaw::default());
        r.finish().1.is_empty().then_some(law)
    }

    /// The friction of the first phase: its own, or that of the scene.
    pub fn first_friction(&self) -> Option<f64> {
        let first = self.table.get("phase").and_then(|phases| phases.get(0)?.get("friction"));
        as_number(first.or_else(|| self.table.get("friction"))?)
    }

    /// A value under `[material]`, which the file of a packing may lack.
    pub fn material(&self, key: &str) -> Option<f64> {
        as_number(self.table.get("material")?.as_table()?.get(key)?)
    }

    /// The scene, if all its values are valid. If it starts from a packing, use [`Draft::resolve_from`].
    pub fn resolve(&self) -> Result<Resolved, SceneError> {
        read(&self.described(), None)
    }

    /// A scene that starts from this packing.
    pub fn resolve_from(&self, packing: &Packing) -> Result<Resolved, SceneError> {
        read(&self.described(), Some(packing))
    }

    /// The table whose description, that of the texts, is followed by the keys set outside them.
    fn described(&self) -> Table {
        let mut table = self.table.clone();
        if let Some(Value::String(text)) = table.get_mut("description")
            && !(text.is_empty() || self.overrides.is_empty())
        {
            *text += &format!(", with {}", self.overrides.join(", "));
        }
        table
    }
}

/// Merges a layer; its `pressure` comes last, so that it is that of the phases that there are then.
fn merge(table: &mut Table, layer: Table) -> Vec<Fault> {
    let mut faults = overlay(table, layer);
    faults.extend(pressure::apply(table));
    faults
}

/// Adds the keys of a table with their values as `KEY=VALUE`.
fn named(keys: &Table, place: &str, found: &mut Vec<String>) {
    for (key, value) in keys {
        match value {
            _ if place.is_empty() && NEVER_DESCRIBED.contains(&key.as_str()) => {}
            Value::Table(inner) => named(inner, &format!("{place}{key}."), found),
            Value::String(text) => found.push(format!("{place}{key}={text}")),
            value => found.push(format!("{place}{key}={value}")),
        }
    }
}

fn has_key(table: &Table, key: &str) -> bool {
    table.get("start").and_then(Value::as_table).is_some_and(|start| start.contains_key(key))
}

fn parse(source: &Source, is_base: bool) -> Result<Table, SceneError> {
    source.text.parse().map_err(|e: toml::de::Error| {
        let place = if is_base { source.name.as_str() } else { "scene" };
        SceneError::one(place, e.to_string().trim_end())
    })
}

fn find(base: &Value, from: &str, library: Library<'_>) -> Result<Source, String> {
    let Value::String(name) = base else {
        return Err(format!("is {base}; it must be the name of a scene or the path of a file, in quotes"));
    };
    library(name, from).map_err(|why| format!("is {name:?}: {why}"))
}
