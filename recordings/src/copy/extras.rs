//! Stored files and metadata records of several recordings as those of one.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Metadata;

use crate::metadata_keys::{COPY_RECORD, LEDGER_KEY, METADATA_RECORD, SESSION_KEY};
use crate::reader::{Recording, StoredFile};

/// Stored files and metadata records of a copy.
#[derive(Default)]
pub(super) struct Extras {
    pub(super) files: Vec<StoredFile>,
    pub(super) metadata: Vec<Metadata>,
    /// Names that were changed.
    pub(super) notes: Vec<String>,
}

impl Extras {
    pub(super) fn of(recordings: &[Recording], operation: &str) -> Self {
        let mut all = Self::default();
        for recording in recordings {
            recording.stored_files().into_iter().for_each(|file| all.file(recording, file));
            // Rosbag2's record has the counts of its own file. The recorder writes its own again in each file.
            let own = recording.metadata(METADATA_RECORD);
            let others =
                recording.all_metadata().filter(|m| !["rosbag2", METADATA_RECORD].contains(&&*m.name));
            let own = own.map(|metadata| Metadata { name: METADATA_RECORD.to_owned(), metadata });
            others.chain(own).for_each(|m| all.record(recording, m.name, m.metadata));
        }
        all.notes.extend(several_runs(recordings));
        let sources: Vec<String> = recordings.iter().map(|r| r.path().display().to_string()).collect();
        let metadata = BTreeMap::from([
            ("operation".to_owned(), operation.to_owned()),
            ("sources".to_owned(), serde_json::Value::from(sources).to_string()),
        ]);
        all.metadata.push(Metadata { name: COPY_RECORD.to_owned(), metadata });
        all
    }

    fn file(&mut self, recording: &Recording, mut file: StoredFile) {
        let same = |known: &&StoredFile| known.name == file.name && known.bytes == file.bytes;
        if self.files.iter().find(same).is_some() {
            return;
        }
        let name = free_name(&file.name, |name| self.files.iter().any(|f| f.name == name));
        self.note(recording, "stored file", &file.name, &name);
        file.name = name;
        self.files.push(file);
    }

    fn record(&mut self, recording: &Recording, name: String, mut content: BTreeMap<String, String>) {
        if name == METADATA_RECORD {
            content.retain(|key, _| key != LEDGER_KEY && key != SESSION_KEY);
        }
        // The source was a copy itself.
        let base = if name == COPY_RECORD { "grainlab_copied".to_owned() } else { name };
        if self.metadata.iter().any(|m| m.name == base && m.metadata == content) {
            return;
        }
        let name = free_name(&base, |name| self.metadata.iter().any(|m| m.name == name));
        self.note(recording, "metadata record", &base, &name);
        self.metadata.push(Metadata { name, metadata: content });
    }

    fn note(&mut self, recording: &Recording, what: &str, old: &str, new: &str) {
        if old != new {
            let path = recording.path().display();
            self.notes
                .push(format!("{what} {old} of {path} is named {new}: there is another one of its name"));
        }
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
