//! The files of a recording.

use std::collections::BTreeSet;
use std::collections::btree_map::{BTreeMap, Entry};
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Component, Path, PathBuf};

use grainlab_console::{Failure, count};
use serde::Deserialize;

use grainlab_console::input;

use super::error::{self, Warning, WarningKind};

/// Maximum size of a `metadata.yaml`, bytes.
const METADATA: u64 = 16 << 20;

#[derive(Deserialize)]
struct BagFile {
    rosbag2_bagfile_information: BagInformation,
}

/// Parts of a `metadata.yaml`.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(crate) struct BagInformation {
    pub(super) relative_file_paths: Vec<String>,
    pub(super) message_count: Option<u64>,
    pub(super) compression_format: String,
    pub(super) compression_mode: String,
    pub(super) storage_identifier: Option<String>,
    pub(super) starting_time: Time,
    pub(super) duration: Time,
    pub(super) topics_with_message_count: Option<Vec<TopicEntry>>,
    pub(super) files: Vec<FileEntry>,
    /// Texts of the user by their names, or null.
    pub(crate) custom_data: serde_json::Value,
    pub(crate) ros_distro: Option<String>,
}

/// A time or a duration.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Time {
    #[serde(alias = "nanoseconds_since_epoch")]
    pub(super) nanoseconds: Option<u64>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TopicEntry {
    pub(super) topic_metadata: TopicMetadata,
    pub(super) message_count: u64,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TopicMetadata {
    pub(super) name: String,
    #[serde(rename = "type")]
    pub(super) ros_type: String,
    pub(super) serialization_format: String,
    type_description_hash: Option<String>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct FileEntry {
    pub(super) path: String,
    pub(super) message_count: Option<u64>,
}

impl BagInformation {
    /// Reads the `metadata.yaml` of a directory; `None` if there is none.
    pub(crate) fn of(directory: &Path) -> Result<Option<Self>, String> {
        let path = directory.join("metadata.yaml");
        if !path.exists() {
            return Ok(None);
        }
        let text = input::text(&path, METADATA).map_err(|e| e.to_string())?;
        let read = serde_saphyr::from_str::<BagFile>(&text).map_err(|e| e.to_string());
        read.map(|b| Some(b.rosbag2_bagfile_information))
    }

    /// Reads the `metadata.yaml` of a directory, or the `metadata.yaml` beside a file if this names the file.
    pub(super) fn beside(path: &Path) -> Result<Option<Self>, String> {
        if path.is_dir() {
            return Self::of(path);
        }
        let beside = path.parent().and_then(|directory| Self::of(directory).ok()?);
        Ok(beside.filter(|bag| bag.names(path)))
    }

    pub(super) fn names(&self, file: &Path) -> bool {
        self.relative_file_paths.iter().any(|name| file.ends_with(name))
    }

    pub(crate) fn type_hashes(&self) -> impl Iterator<Item = (String, String)> {
        let topics = self.topics_with_message_count.iter().flatten().map(|entry| &entry.topic_metadata);
        topics.filter_map(|topic| Some((topic.name.clone(), topic.type_description_hash.clone()?)))
    }

    pub(super) fn differs(&self, found: u64) -> Option<String> {
        let stated = self.message_count.filter(|n| *n != found)?;
        Some(format!("it states {}, the files hold {found}", count(stated, "message")))
    }

    /// True for this mode of compression: `message` or `file`.
    pub(super) fn is_by(&self, mode: &str) -> bool {
        self.compression_mode.eq_ignore_ascii_case(mode)
    }
}

/// Returns the file, or the files of a directory in order, each once.
pub(super) fn of_recording(
    path: &Path,
    bag: Option<&BagInformation>,
    warnings: &mut BTreeSet<Warning>,
) -> Result<Vec<PathBuf>, Failure> {
    if !fs::metadata(path).map_err(Failure::at(path))?.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut files: Vec<PathBuf> = Vec::new();
    for name in bag.iter().flat_map(|bag| &bag.relative_file_paths) {
        let file = path.join(name);
        let is_inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
        if is_inside && file.exists() {
            files.push(file);
        } else {
            let outside = if is_inside { "" } else { ", outside of its directory, which is not read" };
            let detail = format!("metadata.yaml names it{outside}");
            warnings.insert(Warning::of_file(file, WarningKind::MissingFile, detail));
        }
    }
    // Without a valid metadata.yaml (the recorder was killed): the existing files.
    let stems: BTreeSet<String> = files.iter().filter_map(|f| part(f)).map(|(stem, _)| stem).collect();
    let nothing_listed = files.is_empty();
    let mut others = Vec::new();
    for entry in fs::read_dir(path).map_err(Failure::at(path))? {
        let file = entry.map_err(Failure::at(path))?.path();
        if file.extension().is_none_or(|e| e != "mcap") || files.contains(&file) {
            continue;
        }
        if nothing_listed {
            files.push(file);
        } else if part(&file).is_some_and(|(stem, _)| stems.contains(&stem)) {
            // The run continued after metadata.yaml was written, and its recorder was killed.
            let detail = "metadata.yaml does not name it, but its name is that of a part";
            warnings.insert(Warning::of_file(file.clone(), WarningKind::Unlisted, detail));
            files.push(file);
        } else {
            others.push(file);
        }
    }
    warnings.extend(unread(others, &files));
    if nothing_listed || warnings.iter().any(|w| w.kind == WarningKind::Unlisted) {
        files.sort_by_key(|f| (part(f).map(|(_, number)| number), f.clone()));
    }
    if nothing_listed {
        warnings.extend(gaps(path, &files));
    }
    read_once(&mut files, warnings);
    if files.is_empty() { Err(error::empty(path)) } else { Ok(files) }
}

/// Returns a warning for each of the `others` that has content of its own, which no reader of the directory sees.
fn unread(mut others: Vec<PathBuf>, files: &[PathBuf]) -> impl Iterator<Item = Warning> {
    let identity = |file: &PathBuf| fs::metadata(file).ok().map(|found| (found.dev(), found.ino()));
    let known: BTreeSet<_> = files.iter().filter_map(identity).collect();
    others.retain(|file| {
        let has_content = fs::metadata(file).is_ok_and(|found| found.is_file() && found.len() > 0);
        has_content && identity(file).is_some_and(|identity| !known.contains(&identity))
    });
    others.into_iter().map(|path| {
        let detail = "metadata.yaml does not name it, and its name is not that of a part. Move it to another directory, and read it there";
        Warning::of_file(path, WarningKind::Unread, detail)
    })
}

/// Removes a file that is in the list before, under the same name or, through a link, under another one.
fn read_once(files: &mut Vec<PathBuf>, warnings: &mut BTreeSet<Warning>) {
    let mut known = BTreeMap::new();
    files.retain(|file| {
        // A file that cannot be found is an error when it is opened.
        let Ok(found) = fs::metadata(file) else { return true };
        match known.entry((found.dev(), found.ino())) {
            Entry::Vacant(free) => {
                free.insert(file.clone());
                true
            }
            Entry::Occupied(first) => {
                let detail = match first.get() == file {
                    true => "metadata.yaml names it twice; it is read once".to_owned(),
                    false => format!("it is the same file as {}; it is read once", first.get().display()),
                };
                warnings.insert(Warning::of_file(file.clone(), WarningKind::Inconsistent, detail));
                false
            }
        }
    });
}

/// The parts that are missing between others, where no `metadata.yaml` lists them.
fn gaps(directory: &Path, files: &[PathBuf]) -> Vec<Warning> {
    let parts: Vec<(String, u64)> = files.iter().filter_map(|f| part(f)).collect();
    let between = parts.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    let missing =
        between.flat_map(|pair| (pair[0].1 + 1..pair[1].1).map(|n| format!("{}_{n}.mcap", pair[0].0)));
    let detail = "the parts before and after it are there";
    missing.map(|name| Warning::of_file(directory.join(name), WarningKind::MissingFile, detail)).collect()
}

/// `<name>` and n of `<name>_<n>.mcap`: parts are numbered without leading zeros.
fn part(file: &Path) -> Option<(String, u64)> {
    let (stem, number) = file.file_stem()?.to_str()?.rsplit_once('_')?;
    Some((stem.to_owned(), number.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_metadata_the_parts_between_others_are_missing() {
        let files =
            ["run_0.mcap", "run_1.mcap", "run_4.mcap", "other_7.mcap", "single.mcap"].map(PathBuf::from);
        let missing: Vec<PathBuf> = gaps(Path::new("d"), &files).into_iter().map(|w| w.path).collect();
        assert_eq!(missing, ["d/run_2.mcap", "d/run_3.mcap"].map(PathBuf::from));
    }
}
