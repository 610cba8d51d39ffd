//! A path to packings.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

use super::{ImportError, ImportOptions, Imported, csv, lammps_data, lammps_dump, recording};
use crate::reader::{Recording, Warning};

/// What a path gave.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The packings, at least one, in order.
    pub packings: Vec<Imported>,
    /// What of a recording could not be read: data was lost if this is not empty.
    pub warnings: Vec<Warning>,
}

enum Format {
    Csv,
    Dump,
    Data,
}

/// The packings of a file or run directory: a recording, a CSV (with the sidecar `<stem>.json` if there is
/// one), a LAMMPS dump or data file; `.gz` is decompressed. The name decides, and where it does not, the
/// first line.
///
/// # Errors
/// With the path in front of the reason: see [`ImportError`].
pub fn load(path: &Path, options: &ImportOptions) -> Result<Loaded, ImportError> {
    let inside = |source| ImportError::In { path: path.to_owned(), source: Box::new(source) };
    let io = |source| ImportError::Io { path: path.to_owned(), source };
    let metadata = fs::metadata(path).map_err(io)?;
    let (stem, extension) = stem_and_extension(path);
    if metadata.is_dir() || extension == "mcap" {
        let recording = Recording::open(path)?;
        let packings = recording::packings(&recording, options).map_err(|e| match e {
            ImportError::Recording(_) => e,
            other => inside(other),
        })?;
        return Ok(Loaded { packings, warnings: recording.warnings() });
    }
    let text = text(path)?;
    let packings = match format(&extension, &stem, &text).ok_or(ImportError::UnknownFormat).map_err(inside)? {
        Format::Csv => {
            let sidecar = path.with_file_name(format!("{stem}.json"));
            let sidecar = if sidecar.exists() { Some(self::text(&sidecar)?) } else { None };
            csv::packing(&text, sidecar.as_deref(), options).map(|p| vec![p])
        }
        Format::Dump => lammps_dump::packings(&text, options),
        Format::Data => lammps_data::packing(&text, options).map(|p| vec![p]),
    };
    Ok(Loaded { packings: packings.map_err(inside)?, warnings: Vec::new() })
}

/// Stem and extension of the name without `.gz`.
fn stem_and_extension(path: &Path) -> (String, String) {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let name = PathBuf::from(name.strip_suffix(".gz").unwrap_or(&name));
    let part = |p: Option<&std::ffi::OsStr>| p.map(|p| p.to_string_lossy().into_owned()).unwrap_or_default();
    (part(name.file_stem()), part(name.extension()).to_lowercase())
}

fn format(extension: &str, stem: &str, text: &str) -> Option<Format> {
    match extension {
        "csv" => return Some(Format::Csv),
        "dump" | "lammpstrj" => return Some(Format::Dump),
        "data" => return Some(Format::Data),
        _ => {}
    }
    // LAMMPS users name files dump.x and data.x as often as x.dump and x.data.
    match stem {
        "dump" => return Some(Format::Dump),
        "data" => return Some(Format::Data),
        _ => {}
    }
    let first = text.lines().find(|l| !l.trim().is_empty())?;
    if first.starts_with("ITEM:") {
        Some(Format::Dump)
    } else if first.starts_with("LAMMPS") {
        Some(Format::Data)
    } else if ["p,", "c,", "# particles"].iter().any(|s| first.starts_with(s)) {
        Some(Format::Csv)
    } else {
        None
    }
}

fn text(path: &Path) -> Result<String, ImportError> {
    let io = |source| ImportError::Io { path: path.to_owned(), source };
    let bytes = fs::read(path).map_err(io)?;
    let mut text = String::new();
    if bytes.starts_with(&[0x1f, 0x8b]) {
        MultiGzDecoder::new(bytes.as_slice()).read_to_string(&mut text).map_err(io)?;
        return Ok(text);
    }
    String::from_utf8(bytes).map_err(|e| io(std::io::Error::new(std::io::ErrorKind::InvalidData, e)))
}
