//! Stored files and metadata records of several recordings as those of one.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Metadata;

use crate::metadata_keys::{COPY_RECORD, LEDGER_KEY, METADATA_RECORD, SESSION_KEY};
use crate::reader::{Recording, StoredFile};

/// Stored files and metadata records of a copy.
pub(super) struct Extras {
    pub(super) files: Vec<StoredFile>,
    pub(super) metadata: Vec<Metadata>,
    /// Names that were changed.
    pub(super) notes: Vec<String>,
}

impl Extras {
    pub(super) fn of(recordings: &[Recording]) -> Self {
        let mut files = Kept::<StoredFile>::of("stored file", |a, b| a.bytes == b.bytes);
        let mut records = Kept::of("metadata record", |a: &BTreeMap<_, _>, b| a == b);
        for (number, recording) in recordings.iter().enumerate() {
            for (part, source) in recording.files.iter().enumerate() {
                let origin = (number, part);
                for file in source.stored_files(|w| recording.warn(w)) {
                    files.add(recording, origin, &file.name.clone(), file);
                }
                // Rosbag2's record has the counts of its own file. The recorder writes its own again in each file.
                let others = source.all_metadata(|w| recording.warn(w));
                for Metadata { name, metadata } in
                    others.filter(|m| !["rosbag2", METADATA_RECORD].contains(&&*m.name))
                {
                    // The source was a copy itself.
                    let base = if name == COPY_RECORD { "grainlab_copied" } else { &name };
                    records.add(recording, origin, base, metadata);
                }
            }
            if let Some(mut metadata) = recording.metadata(METADATA_RECORD) {
                metadata.retain(|key, _| key != LEDGER_KEY && key != SESSION_KEY);
                records.add(recording, (number, 0), METADATA_RECORD, metadata);
            }
        }
        let sources: Vec<String> = recordings.iter().map(|r| r.path().display().to_string()).collect();
        let sources = ("sources".to_owned(), serde_json::Value::from(sources).to_string());
        records.items.push((COPY_RECORD.to_owned(), BTreeMap::from([sources])));
        let mut notes = files.notes;
        notes.extend(records.notes);
        notes.extend(several_runs(recordings));
        Self {
            files: files.items.into_iter().map(|(name, file)| StoredFile { name, ..file }).collect(),
            metadata: records.items.into_iter().map(|(name, metadata)| Metadata { name, metadata }).collect(),
            notes,
        }
    }
}

/// Source of an item: the number of its recording, and the number of the file in the recording.
type Origin = (usize, usize);

struct Kept<T> {
    kind: &'static str,
    is_same: fn(&T, &T) -> bool,
    /// In order, with the name of each.
    items: Vec<(String, T)>,
    /// Places in the list, by name and source.
    places: BTreeMap<String, BTreeMap<Origin, Vec<usize>>>,
    notes: Vec<String>,
}

impl<T> Kept<T> {
    fn of(kind: &'static str, is_same: fn(&T, &T) -> bool) -> Self {
        Self { kind, is_same, items: Vec::new(), places: BTreeMap::new(), notes: Vec::new() }
    }

    /// Adds an item, unless another file has the same under its name. Within a recording equal names stay, which MCAP allows; an
    /// item whose name is taken by another recording gets a number.
    fn add(&mut self, recording: &Recording, origin: Origin, name: &str, item: T) {
        let others = self.places.get(name).into_iter().flatten().filter(|(source, _)| **source != origin);
        if others.flat_map(|(_, places)| places).any(|place| (self.is_same)(&self.items[*place].1, &item)) {
            return;
        }
        let is_of_another =
            |name: &str| self.places.get(name).is_some_and(|all| all.keys().any(|from| from.0 != origin.0));
        let new = free_name(name, is_of_another);
        if new != name {
            let (kind, path) = (self.kind, recording.path().display());
            self.notes.push(format!(
                "{kind} {name} of {path} is named {new}: another of the recordings has one of its name"
            ));
        }
        self.places.entry(new.clone()).or_default().entry(origin).or_default().push(self.items.len());
        self.items.push((new, item));
    }
}

/// A note if the recordings are of several runs: their messages are in the same topics of the copy.
fn several_runs(recordings: &[Recording]) -> Option<String> {
    let id = |r: &Recording| r.metadata(METADATA_RECORD)?.remove("run");
    let runs: BTreeSet<String> = recordings.iter().filter_map(id).collect();
    (runs.len() > 1).then(|| {
        let runs = runs.into_iter().collect::<Vec<_>>().join(", ");
        format!("the recordings are of several runs ({runs}): a topic has the messages of all of them, one beside the other")
    })
}

/// `scene.toml`, `scene.2.toml`, and so on: the first that is free.
fn free_name(name: &str, taken: impl Fn(&str) -> bool) -> String {
    let (stem, extension) =
        name.rsplit_once('.').map_or((name, String::new()), |(s, e)| (s, format!(".{e}")));
    let numbered = (2u32..).map(|n| format!("{stem}.{n}{extension}"));
    std::iter::once(name.to_owned()).chain(numbered).find(|name| !taken(name)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_taken_name_gets_a_number_before_its_extension() {
        let taken = |names: &'static [&'static str]| move |name: &str| names.contains(&name);
        assert_eq!(free_name("scene.toml", taken(&[])), "scene.toml");
        assert_eq!(free_name("scene.toml", taken(&["scene.toml", "scene.2.toml"])), "scene.3.toml");
        assert_eq!(free_name("grainlab", taken(&["grainlab"])), "grainlab.2");
    }
}
