//! A scene from a base and what changes it.
//!
//! One rule: tables are merged key by key, everything else replaces what the base has, and `"unset"` forgets it. A path is
//! an array, so `[[phase]]` replaces it whole; `[phase.NAME]` changes the phase of that name, `remove` leaves phases out and
//! `[[append]]` adds some, in this order. What is set on a command line is merged in the same way.

use crate::built_in::built_in;
use crate::fault::{Fault, SceneError};
use crate::model::Scene;
use crate::overlay::overlay;
use crate::parse::{Resolved, read};
use toml::{Table, Value};

/// A text that a base names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// What identifies it: the built-in name, or the whole path.
    pub name: String,
    /// The text.
    pub text: String,
}

/// Looks a base up: its name as it is written, and the name of the source that it is written in. The error says why there
/// is none.
pub type Library<'a> = &'a dyn Fn(&str, &str) -> Result<Source, String>;

/// A scene as a table: its bases are merged, its values are not judged yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    table: Table,
}

impl Scene {
    /// Parses a scene; every fault of the text is in the error. Its base, if it has one, is built in.
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
    /// Of a text whose base, if it has one, is built in.
    pub fn of_text(text: &str) -> Result<Draft, SceneError> {
        let source = Source { name: "scene".into(), text: text.into() };
        Self::of(&source, &|base, _| {
            let text = built_in(base).ok_or("only built-in scenes are known here")?;
            Ok(Source { name: base.into(), text: text.into() })
        })
    }

    /// Of a text, with bases from `library`.
    ///
    /// # Errors
    /// A text that is no TOML, a base that is not found, a circle of bases, and overrides of what is not there.
    pub fn of(source: &Source, library: Library<'_>) -> Result<Draft, SceneError> {
        let (mut layers, mut names) = (Vec::new(), vec![source.name.clone()]);
        let mut next = Some(source.clone());
        while let Some(source) = next.take() {
            let mut table = parse(&source, names.len() > 1)?;
            if let Some(base) = table.remove("base") {
                let found = find(&base, &source.name, library).map_err(|m| fault("base", m))?;
                let circle = names.contains(&found.name);
                names.push(found.name.clone());
                if circle {
                    return Err(fault("base", format!("goes in a circle: {}", names.join(" -> "))));
                }
                next = Some(found);
            }
            layers.push(table);
        }
        let mut table = layers.pop().unwrap_or_default();
        let mut faults = Vec::new();
        for layer in layers.into_iter().rev() {
            faults.extend(overlay(&mut table, layer));
        }
        if faults.is_empty() { Ok(Draft { table }) } else { Err(SceneError { faults }) }
    }

    /// Lays keys over the scene, as [`crate::assignment`] reads them.
    pub fn set(&mut self, keys: Table) -> Result<(), SceneError> {
        let faults = overlay(&mut self.table, keys);
        if faults.is_empty() { Ok(()) } else { Err(SceneError { faults }) }
    }

    /// The scene, if all its values hold.
    pub fn resolve(&self) -> Result<Resolved, SceneError> {
        read(&self.table)
    }
}

fn fault(place: &str, message: impl Into<String>) -> SceneError {
    SceneError { faults: vec![Fault { place: place.into(), message: message.into() }] }
}

fn parse(source: &Source, is_base: bool) -> Result<Table, SceneError> {
    source.text.parse().map_err(|e: toml::de::Error| {
        let place = if is_base { source.name.as_str() } else { "scene" };
        fault(place, e.to_string().trim_end())
    })
}

fn find(base: &Value, from: &str, library: Library<'_>) -> Result<Source, String> {
    let Value::String(name) = base else {
        return Err(format!("is {base}; it must be the name of a scene or the path of a file, in quotes"));
    };
    library(name, from).map_err(|why| format!("is {name:?}: {why}"))
}
