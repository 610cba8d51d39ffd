//! The members of a campaign, from its file.

use crate::file::{CampaignFile, Record};
use crate::member::{Member, Setting};
use grainlab_console::{Failure, separated};
use grainlab_recordings::input;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
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
        let table: Table =
            text.parse().map_err(|e: toml::de::Error| Failure::usage(e.to_string().trim_end()))?;
        let file = CampaignFile::read(table, "")?;
        let common = flat(&file.set);
        let mut members = product(&file, &common, folder, "")?;
        for (n, group) in file.group.into_iter().enumerate() {
            let place = format!("group[{n}].");
            members.extend(product(&CampaignFile::read(group, &place)?, &common, folder, &place)?);
        }
        if let Some(table) = &file.table {
            members.extend(table_of(&folder.join(table), &common, folder)?);
        }
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        let sets_seed = members.iter().any(|m| m.set.iter().any(|s| s.key == "seed"));
        let long = members.iter().find(|m| m.name.len() > MAX_NAME_LENGTH);
        let mut names = BTreeSet::new();
        let twice = members.iter().find(|m| !names.insert(m.name.as_str()));
        let fault = match (long.map(|m| &m.name), twice) {
            _ if file.name.is_empty() || !file.name.chars().all(is_plain) => {
                format!("name is {:?}: letters, digits, _ and - are allowed", file.name)
            }
            _ if members.is_empty() => "no members: name scenes and seeds, a [[group]], or a table".into(),
            _ if members.len() > MOST => format!("{} members, more than {MOST}", members.len()),
            _ if sets_seed => "seed is no key to set: name it in seeds, or as the seed of a member".into(),
            (Some(long), _) => format!("member {long}: longer than {MAX_NAME_LENGTH}: set this in a scene"),
            (_, Some(twice)) => format!(
                "two members are called {}: name each combination once, and give scenes different file names",
                twice.name
            ),
            _ => String::new(),
        };
        if !fault.is_empty() {
            return Err(Failure::usage(fault));
        }
        let argument = |(name, value): (&String, &Value)| format!("{name}:={}", plain(value));
        Ok(Self {
            name: file.name,
            description: file.description,
            launch: file.launch.map_or_else(|| "demo".to_owned(), |launch| found(&launch, folder)),
            arguments: file.arguments.iter().map(argument).collect(),
            processes: false,
            record_all: file.record == Record::All,
            report: file.report,
            members,
            text: text.to_owned(),
        })
    }
}

/// The whole path of a file beside the campaign; any other name is that of something built in.
fn found(name: &str, folder: &Path) -> String {
    let beside: PathBuf = folder.join(name);
    if beside.is_file() { beside.to_string_lossy().into_owned() } else { name.to_owned() }
}

/// Scenes × values × seeds of a group, or of the top of the file.
fn product(file: &CampaignFile, common: &[Setting], folder: &Path, at: &str) -> Result<Vec<Member>, Failure> {
    let seeds = file.seeds.as_ref().map(|seeds| seeds.all(MOST + 1)).unwrap_or_default();
    if file.scenes.is_empty() != seeds.is_empty() || file.scenes.is_empty() && !at.is_empty() {
        let message = format!("{at}scenes and seeds: both are needed, and neither may be empty");
        return Err(Failure::usage(message));
    }
    let mut combinations = vec![if at.is_empty() { Vec::new() } else { flat(&file.set) }];
    for rows in axes(file, at)? {
        combinations = combinations
            .iter()
            .flat_map(|old| rows.iter().map(move |row| [&old[..], row].concat()))
            .collect();
        if combinations.len() > MOST {
            return Err(Failure::usage(format!("more than {MOST} combinations of values")));
        }
    }
    let mut members = Vec::new();
    for scene in file.scenes.iter().map(|scene| found(scene, folder)) {
        for own in &combinations {
            for seed in &seeds {
                let all = common.iter().chain(own).cloned().collect();
                members.push(Member::new(&scene, *seed, all, common.len()));
            }
        }
    }
    Ok(members)
}

/// The settings of each row of what varies: each key of `vary` by itself, then each table of `together`.
fn axes(file: &CampaignFile, at: &str) -> Result<Vec<Vec<Vec<Setting>>>, Failure> {
    let single = flat(&file.vary).into_iter().map(|s| (format!("{at}vary"), vec![s]));
    let joint = file.together.iter().enumerate().map(|(n, t)| (format!("{at}together[{n}]"), flat(t)));
    let (mut axes, mut known) = (Vec::new(), BTreeMap::new());
    for (table, settings) in single.chain(joint) {
        let mut rows = Vec::new();
        for Setting { key, value } in settings {
            let fault = |why| Err(Failure::usage(format!("{table}.{key} {why}")));
            if file.scenes.is_empty() {
                return fault("has no effect without scenes: name scenes and seeds beside it, or add a column to the table".to_owned());
            }
            if let Some(other) = known.insert(key.clone(), table.clone()) {
                return fault(format!("is in {other}, too: name it once"));
            }
            let values = format!("v = {value}").parse().map(|mut t: Table| t.remove("v"));
            let values = values.ok().flatten().and_then(|v| v.as_array().cloned()).unwrap_or_default();
            if values.is_empty() {
                return fault(format!("is {value}: it takes a list of one value or more"));
            }
            if rows.is_empty() {
                rows = vec![Vec::new(); values.len()];
            }
            if rows.len() != values.len() {
                let (own, other) = (values.len(), rows.len());
                return fault(format!(
                    "has {own} values, and another key of its table {other}: give each as many"
                ));
            }
            for (row, value) in rows.iter_mut().zip(&values) {
                row.push(Setting { key: key.clone(), value: plain(value) });
            }
        }
        axes.extend(Some(rows).filter(|rows| !rows.is_empty()));
    }
    Ok(axes)
}

/// A value for a command line.
fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// The keys of nested tables with dots.
fn flat(table: &Table) -> Vec<Setting> {
    let mut all = Vec::new();
    flatten(table, "", &mut all);
    all
}

fn flatten(table: &Table, place: &str, all: &mut Vec<Setting>) {
    for (key, value) in table {
        // A part with a dot, as in "settle#2.x", needs quotes; at the top such a text is a whole key, as "phase.*.drag".
        let needs_quotes = !place.is_empty() && key.contains(['.', '=']);
        let key = if needs_quotes { format!("{place}{key:?}") } else { format!("{place}{key}") };
        match value {
            Value::Table(inner) => flatten(inner, &format!("{key}."), all),
            value => all.push(Setting { key, value: plain(value) }),
        }
    }
}

fn table_of(path: &Path, common: &[Setting], folder: &Path) -> Result<Vec<Member>, Failure> {
    let fault = |why: String| Failure::usage(format!("table {}: {why}", path.display()));
    let (_, text) = separated::read(path).map_err(|e| Failure::new(e.exit, format!("table {e}")))?;
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| fault(e.to_string()))?.clone();
    let is_known = |n: usize| header.iter().take(n).any(|name| name == &header[n]);
    if let Some(twice) = (0..header.len()).find(|n| is_known(*n)) {
        return Err(fault(format!("the column {} occurs twice: leave one of them", &header[twice])));
    }
    let column = |name: &str| {
        let all = || header.iter().collect::<Vec<_>>().join(", ");
        let missing = || fault(format!("it has no column {name}; its columns are: {}", all()));
        header.iter().position(|h| h == name).ok_or_else(missing)
    };
    let (scene, seed) = (column("scene")?, column("seed")?);
    let mut members = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| fault(e.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let unknown = |_| fault(format!("line {line}: seed {:?} is not a number", &record[seed]));
        let number = record[seed].parse().map_err(unknown)?;
        let is_set = |n: &usize| *n != scene && *n != seed && !record[*n].is_empty();
        let own = (0..header.len()).filter(is_set);
        let own = own.map(|n| Setting { key: header[n].to_owned(), value: record[n].to_owned() });
        let set = common.iter().cloned().chain(own).collect();
        members.push(Member::new(&found(&record[scene], folder), number, set, common.len()));
    }
    Ok(members)
}

#[cfg(test)]
mod tests;
