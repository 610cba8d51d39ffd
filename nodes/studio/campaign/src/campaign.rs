//! The members of a campaign, from its file.

use crate::file::{CampaignFile, Group, Record};
use crate::member::{Member, Setting};
use grainlab_console::Failure;
use grainlab_recordings::input;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Largest number of members.
const MOST: usize = 100_000;

/// Largest number of characters of a member's name, which is that of a folder.
const MAX_NAME_LENGTH: usize = 200;

/// A campaign of runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Campaign {
    /// Name of the campaign; letters, digits, `_` and `-`.
    pub name: String,
    /// Description in one line.
    pub description: String,
    /// Launch file: built in, or the whole path of a file.
    pub launch: String,
    /// Values for its arguments, as `NAME:=VALUE`.
    pub arguments: Vec<String>,
    /// The nodes of a run are processes.
    #[serde(default)]
    pub processes: bool,
    /// Every message is recorded, not only packings and results.
    #[serde(default)]
    pub record_all: bool,
    /// Each run has its page.
    #[serde(default)]
    pub report: bool,
    /// The runs, in the order of their results.
    pub members: Vec<Member>,
    /// The text of the file.
    pub text: String,
}

impl Campaign {
    /// Reads a file. Paths in it are relative to it.
    ///
    /// # Errors
    /// Invalid TOML, unknown keys, no members, or two of one name. Scenes are not read.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let text = input::text(path, input::SETTINGS).map_err(Failure::at(path))?;
        let folder =
            path.canonicalize().ok().and_then(|p| p.parent().map(Path::to_owned)).unwrap_or_default();
        Self::parse(&text, &folder).map_err(|e| Failure::new(e.exit, format!("{}: {e}", path.display())))
    }

    /// The campaign of a text, whose paths are relative to `folder`.
    pub fn parse(text: &str, folder: &Path) -> Result<Self, Failure> {
        let file: CampaignFile =
            toml::from_str(text).map_err(|e| Failure::usage(e.to_string().trim_end()))?;
        check_name(&file.name)?;
        let first = Group {
            scenes: file.scenes.clone(),
            seeds: file.seeds.clone(),
            vary: file.vary.clone(),
            ..Group::default()
        };
        let mut members = product(&first, &file.set, folder)?;
        for group in &file.group {
            members.extend(product(group, &file.set, folder)?);
        }
        if let Some(table) = &file.table {
            members.extend(table_of(&folder.join(table), &file.set, folder)?);
        }
        if members.is_empty() {
            return Err(Failure::usage("no members: name scenes and seeds, a [[group]], or a table"));
        }
        if members.len() > MOST {
            return Err(Failure::usage(format!("{} members, more than {MOST}", members.len())));
        }
        if let Some(long) = members.iter().find(|m| m.name.len() > MAX_NAME_LENGTH) {
            return Err(Failure::usage(format!(
                "the name of member {} has {} characters, more than {MAX_NAME_LENGTH}: put its settings into a scene",
                long.name,
                long.name.len()
            )));
        }
        if members.iter().any(|m| m.set.iter().any(|s| s.key == "seed")) {
            return Err(Failure::usage(
                "seed is no key to set: name it in seeds, or as the seed of a member",
            ));
        }
        let mut names = BTreeSet::new();
        if let Some(twice) = members.iter().find(|m| !names.insert(m.name.as_str())) {
            return Err(Failure::usage(format!("two members are called {}", twice.name)));
        }
        Ok(Self {
            name: file.name,
            description: file.description,
            launch: file.launch.map_or_else(|| "demo".to_owned(), |launch| found(&launch, folder)),
            arguments: file
                .arguments
                .iter()
                .map(|(name, value)| format!("{name}:={}", plain(value)))
                .collect(),
            processes: false,
            record_all: file.record == Record::All,
            report: file.report,
            members,
            text: text.to_owned(),
        })
    }
}

fn check_name(name: &str) -> Result<(), Failure> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(is_plain) {
        return Ok(());
    }
    Err(Failure::usage(format!("name is {name:?}: letters, digits, _ and - are allowed")))
}

/// The whole path of a file beside the campaign; any other name is that of something built in.
fn found(name: &str, folder: &Path) -> String {
    let beside: PathBuf = folder.join(name);
    if beside.is_file() { beside.to_string_lossy().into_owned() } else { name.to_owned() }
}

/// Scenes × values × seeds.
fn product(group: &Group, common: &Table, folder: &Path) -> Result<Vec<Member>, Failure> {
    let seeds = group.seeds.as_ref().map(|seeds| seeds.all(MOST + 1)).unwrap_or_default();
    if group.scenes.is_empty() != seeds.is_empty() {
        return Err(Failure::usage("scenes and seeds: both are needed, and neither may be empty"));
    }
    if group.scenes.is_empty()
        && let Some(key) = flat(&group.vary).first().map(|setting| &setting.key)
    {
        return Err(Failure::usage(format!(
            "vary.{key} has no effect without scenes beside it: name scenes and seeds, or give each row of a table its own values"
        )));
    }
    let mut combinations = vec![flat(&group.set)];
    for Setting { key, value } in flat(&group.vary) {
        let values = values(&key, &value)?;
        let with = |old: &Vec<Setting>, value: &String| {
            let mut new = old.clone();
            new.push(Setting { key: key.clone(), value: value.clone() });
            new
        };
        combinations =
            combinations.iter().flat_map(|old| values.iter().map(move |value| with(old, value))).collect();
        if combinations.len() > MOST {
            return Err(Failure::usage(format!("more than {MOST} combinations of values")));
        }
    }
    let set = flat(common);
    let mut members = Vec::new();
    for scene in group.scenes.iter().map(|scene| found(scene, folder)) {
        for own in &combinations {
            for seed in &seeds {
                let all = set.iter().chain(own).cloned().collect();
                members.push(Member::new(&scene, *seed, all, set.len()));
            }
        }
    }
    Ok(members)
}

/// The values of a key of `vary`.
fn values(key: &str, text: &str) -> Result<Vec<String>, Failure> {
    let table: Result<Table, _> = format!("v = {text}").parse();
    match table.ok().and_then(|mut t| t.remove("v")) {
        Some(Value::Array(values)) if !values.is_empty() => Ok(values.iter().map(plain).collect()),
        _ => Err(Failure::usage(format!("vary.{key} is {text}: it takes a list of one value or more"))),
    }
}

/// A value for a command line.
fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// The keys of nested tables with dots.
fn flat(table: &Table) -> Vec<Setting> {
    let mut all = Vec::new();
    for (key, value) in table {
        // A part with a dot, as in "settle#2.x", needs quotes.
        let key = if key.contains(['.', '=']) { format!("{key:?}") } else { key.clone() };
        match value {
            Value::Table(inner) => {
                all.extend(flat(inner).into_iter().map(|s| Setting { key: format!("{key}.{}", s.key), ..s }));
            }
            value => all.push(Setting { key, value: plain(value) }),
        }
    }
    all
}

/// The members in a CSV.
fn table_of(path: &Path, common: &Table, folder: &Path) -> Result<Vec<Member>, Failure> {
    let text = input::text(path, input::SETTINGS)
        .map_err(|e| Failure::failed(format!("table {}: {e}", path.display())))?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
    let bad = |e: csv::Error| Failure::usage(format!("table {}: {e}", path.display()));
    let header = reader.headers().map_err(bad)?.clone();
    if let Some((_, twice)) =
        header.iter().enumerate().find(|(n, name)| header.iter().take(*n).any(|h| h == *name))
    {
        let path = path.display();
        return Err(Failure::usage(format!(
            "table {path}: the column {twice} occurs twice: leave one of them"
        )));
    }
    let column = |name: &str| {
        header
            .iter()
            .position(|h| h == name)
            .ok_or_else(|| Failure::usage(format!("table {} has no column {name}", path.display())))
    };
    let (scene, seed) = (column("scene")?, column("seed")?);
    let mut members = Vec::new();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(bad)?;
        let number = record[seed].parse().map_err(|_| {
            Failure::usage(format!(
                "table {}, row {}: seed {:?} is not a number",
                path.display(),
                row + 2,
                &record[seed]
            ))
        })?;
        let own = header
            .iter()
            .zip(&record)
            .enumerate()
            .filter(|(n, (_, v))| *n != scene && *n != seed && !v.is_empty());
        let own = own.map(|(_, (key, value))| Setting { key: key.to_owned(), value: value.to_owned() });
        let set = flat(common).into_iter().chain(own).collect();
        members.push(Member::new(&found(&record[scene], folder), number, set, flat(common).len()));
    }
    Ok(members)
}

#[cfg(test)]
mod tests;
