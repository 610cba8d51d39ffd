//! Completes the file of a recorder that was killed, so that every tool reads it.
//!
//! All readable messages are written again, one by one, into a complete file: bytes, log times, publish times
//! and sequences of messages, schemas, channels with their metadata, attachments and metadata records are
//! unchanged. Nothing is added: a damaged chunk is left out and reported. The new file is written beside the
//! old one, checked, and renamed to it; the old one is kept as `<name>.mcap.orig`. A directory gets a new
//! `metadata.yaml`.

use std::ffi::OsString;
use std::fmt::Display;
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use grainlab_console::Failure;
use grainlab_msgs::Exit;
use serde::Serialize;

use crate::bag_metadata::BagMetadata;
use crate::failures::{cannot, reason};
use crate::reader::{BagInformation, Recording, Warning, WarningKind};
use crate::writer::is_locked;
use grainlab_console::input;

mod rewrite;

/// The result for a recording.
#[derive(Clone, Debug, Serialize)]
pub struct Recovery {
    /// Path of the recording.
    pub path: PathBuf,
    /// Files of the recording, in order.
    pub files: Vec<RecoveredFile>,
    /// Files of its `metadata.yaml` that are missing or have no byte.
    pub missing: Vec<Warning>,
    /// True if a new `metadata.yaml` was written.
    pub metadata_written: bool,
}

/// The result for one file.
#[derive(Clone, Debug, Serialize)]
pub struct RecoveredFile {
    /// Path of the file.
    pub path: PathBuf,
    /// Number of messages in the new file.
    pub messages: u64,
    /// Path of the original file; `None` if it was complete.
    pub original: Option<PathBuf>,
    /// Parts that could not be read, and are not in the new file.
    pub unreadable: Vec<Warning>,
}

impl Recovery {
    /// True if the recording was incomplete.
    pub fn changed(&self) -> bool {
        self.metadata_written || self.files.iter().any(|f| f.original.is_some())
    }

    /// Parts of the recording that could not be read.
    pub fn unreadable(&self) -> impl Iterator<Item = &Warning> {
        self.missing.iter().chain(self.files.iter().flat_map(|f| &f.unreadable))
    }
}

/// Completes the file, or all incomplete files of the directory, of a killed recorder. A second call changes
/// nothing.
///
/// # Errors
/// If a recorder is writing it, a complete file is damaged, the file system fails, or there is no recording.
pub fn recover(path: &Path) -> Result<Recovery, Failure> {
    let recording = Recording::open(path)?;
    let paths = recording.paths();
    for path in &paths {
        if input::open(path).is_ok_and(|(file, _)| is_locked(&file)) {
            let path = path.display();
            return Err(Failure::failed(format!(
                "{path} is being recorded: end the recorder first, it then finishes the file itself"
            )));
        }
    }
    let mut missing = recording.warnings();
    missing.retain(|w| {
        w.kind == WarningKind::MissingFile || w.kind == WarningKind::Truncated && !paths.contains(&w.path)
    });
    drop(recording);
    let mut files = Vec::with_capacity(paths.len());
    for path in paths {
        files.push(file(path)?);
    }
    let metadata_written = path.is_dir() && bring_up_to_date(path, &files)?;
    Ok(Recovery { path: path.to_owned(), files, missing, metadata_written })
}

fn file(path: PathBuf) -> Result<RecoveredFile, Failure> {
    let recording = Recording::open(&path)?;
    let opened = recording.warnings();
    let needs_end = |w: &Warning| matches!(w.kind, WarningKind::Truncated | WarningKind::NoIndex);
    if !recording.is_without_index() && !opened.iter().any(needs_end) {
        return match recording.verify_files().into_iter().next() {
            None => {
                let messages = recording.parts().iter().map(|p| p.messages).sum();
                Ok(RecoveredFile { path, messages, original: None, unreadable: Vec::new() })
            }
            // Writing it again could only lose more.
            Some(first) => {
                let what =
                    format!("{} is complete but damaged ({first}): nothing was changed", path.display());
                let rest =
                    "its readable part can be used as it is, and `grainlab bag check` lists all damage";
                Err(Failure::new(Exit::DataLoss, format!("{what}; {rest}")))
            }
        };
    }
    let io = |action| unchanged(&path, action);
    let new = beside(&path, ".recovering");
    let wrong = |problem: String| {
        let what = format!("the new file does not equal the original ({problem})");
        Failure::failed(format!("{}: {what}; the recording is unchanged", new.display()))
    };
    let written = rewrite::rewrite(&recording, &new).map_err(|e| unchanged(&new, "write")(reason(e)));
    let outcome = written.and_then(|written| {
        let faults = Recording::open(&new)?.verify_files();
        match faults.first() {
            Some(fault) => Err(wrong(fault.to_string())),
            None => {
                let mut made = Recording::open(&new)?;
                made.compressed = recording.compressed;
                compare(&recording, &made).map_err(wrong).map(|()| written)
            }
        }
    });
    let written = outcome.inspect_err(|_| _ = fs::remove_file(&new))?;
    drop(recording);
    let original = keep(&path).map_err(io("keep the original"))?;
    fs::rename(&new, &path).map_err(io("replace it by the new file"))?;
    sync_directory(&path).map_err(io("sync the directory to the device"))?;
    Ok(RecoveredFile {
        path,
        messages: written.messages,
        original: Some(original),
        unreadable: written.unreadable,
    })
}

fn compare(old: &Recording, new: &Recording) -> Result<(), String> {
    let all = crate::reader::Selection::default();
    let (mut a, mut b) =
        (old.messages(&all).map_err(|e| e.to_string())?, new.messages(&all).map_err(|e| e.to_string())?);
    for n in 1u64.. {
        match (a.next(), b.next()) {
            (None, None) => break,
            (Some(a), Some(b)) if a.says_the_same(&b) => {}
            _ => return Err(format!("message {n} differs from the original")),
        }
    }
    Ok(())
}

/// Keeps the original under another name: by a second link, so that a recording always exists, or else renamed.
fn keep(path: &Path) -> io::Result<PathBuf> {
    for n in 0u32.. {
        let suffix = if n == 0 { ".orig".to_owned() } else { format!(".orig{n}") };
        let kept = beside(path, &suffix);
        match fs::hard_link(path, &kept) {
            Ok(()) => return Ok(kept),
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
            Err(_) if !kept.exists() => return fs::rename(path, &kept).map(|()| kept),
            Err(e) => return Err(e),
        }
    }
    Err(io::Error::other("no free name"))
}

/// Writes `metadata.yaml` if it is missing or not to be read, files were recovered, or it does not list all of them; true if written.
fn bring_up_to_date(directory: &Path, files: &[RecoveredFile]) -> Result<bool, Failure> {
    let recording = Recording::open(directory)?;
    let unlisted = recording.warnings().iter().any(|w| w.kind == WarningKind::Unlisted);
    let missing = !matches!(BagInformation::of(directory), Ok(Some(_)));
    if !(unlisted || missing || files.iter().any(|f| f.original.is_some())) {
        return Ok(false);
    }
    let old = directory.join("metadata.yaml");
    if old.exists() {
        keep(&old).map_err(unchanged(directory, "keep metadata.yaml"))?;
    }
    let written = BagMetadata::of(&recording).write(directory);
    written.map_err(unchanged(directory, "write metadata.yaml"))?;
    Ok(true)
}

fn unchanged<E: Display>(path: &Path, action: &str) -> impl FnOnce(E) -> Failure + use<E> {
    let fails = cannot(path, action);
    move |reason| fails(format!("{reason}; the recording is unchanged"))
}

fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_name().map(OsString::from).unwrap_or_default();
    name.push(suffix);
    path.with_file_name(name)
}

fn sync_directory(path: &Path) -> io::Result<()> {
    let directory = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    File::open(directory)?.sync_all()
}
