//! Loads packings from a path.

use std::fs;
use std::io::{self, Read as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use super::imported::Imported;
use super::text::{lines, shown};
use super::{ImportError, ImportOptions, csv, extended_xyz, lammps_data, lammps_dump, recording, yade};
use crate::reader::{Recording, Warning};
use grainlab_console::input;

/// The packings of a path.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The packings, at least one, in order.
    pub packings: Vec<Imported>,
    /// The parts of a recording that could not be read: data was lost if this is not empty.
    pub warnings: Vec<Warning>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Csv,
    Dump,
    Data,
    Xyz,
    Yade,
}

/// All packings of a file or run directory at once: see [`each`].
///
/// # Errors
/// As [`each`].
pub fn load(path: &Path, options: &ImportOptions) -> Result<Loaded, ImportError> {
    let mut packings = Vec::new();
    let warnings = each(path, options, &mut |imported| {
        packings.push(imported);
        ControlFlow::Continue(())
    })?;
    Ok(Loaded { packings, warnings })
}

/// Passes the packings of a file or run directory to `take` one by one, in order, until it stops: those of a
/// recording, a CSV (with the sidecar `<stem>.json` if there is one), a LAMMPS dump or data file, extended XYZ, a
/// YADE export;
/// `.gz` is decompressed, to 64 times its size or 16 MiB at most; texts have at most 4 GiB, and pipes and devices are
/// refused. The content determines the format, or else the name. Returns the warnings of a
/// recording: data was lost if there are any.
///
/// # Errors
/// See [`ImportError`]; the message begins with the path. `take` has received the packings before the
/// error.
pub fn each(
    path: &Path,
    options: &ImportOptions,
    take: &mut dyn FnMut(Imported) -> ControlFlow<()>,
) -> Result<Vec<Warning>, ImportError> {
    let inside = |source| ImportError::In { path: path.to_owned(), source: Box::new(source) };
    let metadata = fs::metadata(path).map_err(ImportError::io(path))?;
    let (stem, extension) = stem_and_extension(path);
    if metadata.is_dir() || extension == "mcap" || starts_with(path, MCAP) {
        let recording = Recording::open(path)?;
        recording::each(&recording, options, take).map_err(|e| match e {
            ImportError::Recording(_) => e,
            other => inside(other),
        })?;
        return Ok(recording.warnings());
    }
    if let Some(instead) = instead_of_hdf5(path) {
        return Err(inside(ImportError::Given(instead.to_owned())));
    }
    let text = text(path)?;
    match format(&extension, &stem, &text).map_err(inside)? {
        Format::Csv | Format::Xyz | Format::Yade if options.contact_forces.is_some() => {
            Err(ImportError::forces_beside())
        }
        Format::Csv => {
            let sidecar = path.with_file_name(format!("{stem}.json"));
            let sidecar = if sidecar.exists() { Some(self::text(&sidecar)?) } else { None };
            csv::packing(&text, sidecar.as_deref(), options).map(|p| _ = take(p))
        }
        Format::Dump => lammps_dump::each(&text, options, take),
        Format::Data => lammps_data::packing(&text, options).map(|p| _ = take(p)),
        Format::Xyz => extended_xyz::each(&text, options, take),
        Format::Yade => yade::packing(&text, options).map(|p| _ = take(p)),
    }
    .map_err(inside)?;
    Ok(Vec::new())
}

/// Returns what to use instead of an HDF5 file; `None` for any other file.
pub(crate) fn instead_of_hdf5(path: &Path) -> Option<&'static str> {
    starts_with(path, HDF5).then_some(INSTEAD_OF_HDF5)
}

/// Stem and extension of the name without `.gz`.
fn stem_and_extension(path: &Path) -> (String, String) {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let name = PathBuf::from(name.strip_suffix(".gz").unwrap_or(&name));
    let part = |p: Option<&std::ffi::OsStr>| p.map(|p| p.to_string_lossy().into_owned()).unwrap_or_default();
    (part(name.file_stem()), part(name.extension()).to_lowercase())
}

/// The format of a text, from its first lines or else from its name.
fn format(extension: &str, stem: &str, text: &str) -> Result<Format, ImportError> {
    let mut full = lines(text).filter(|l| !l.text.trim().is_empty());
    let first = full.next().ok_or_else(ImportError::empty)?;
    let begins = |prefix: &str| first.text.trim_start().starts_with(prefix);
    let unsupported = |what: &str, reason| Err(ImportError::unsupported(first.number, what, reason));
    if begins("# vtk DataFile") {
        return unsupported("a VTK file", FROM_YADE);
    }
    if text.contains("<VTKFile") {
        return unsupported("VTK's XML", "it is for viewing: export with format csv");
    }
    if begins("<?xml") || begins("<boost_serialization") {
        return unsupported("XML (a saved simulation of YADE?)", FROM_YADE);
    }
    if begins("LIGGGHTS Description") {
        let reason = "it has radii for diameters and no periodic cell: export with format id_x_y_z_r_matId";
        return unsupported("YADE's format liggghts_in", reason);
    }
    let row = full.find(|l| !l.text.trim_start().starts_with('#')).unwrap_or(first);
    let row = if begins("#") { row } else { first };
    let is_row = |text: &str| text.starts_with("p,") || text.starts_with("c,");
    let atoms = |text: &str| matches!(text.split_whitespace().collect::<Vec<_>>()[..], [n, "atoms", ..] if n.parse::<u64>().is_ok());
    let is_xyz = first.text.trim().parse::<u64>().is_ok()
        && lines(text).nth(first.number).is_some_and(|l| extended_xyz::is_comment(l.text));
    if is_xyz {
        Ok(Format::Xyz)
    } else if begins("ITEM:") {
        Ok(Format::Dump)
    } else if begins("#format") {
        Ok(Format::Yade)
    } else if is_row(row.text.trim_start()) || begins("# particles") {
        Ok(Format::Csv)
    } else if begins("LAMMPS") || text.lines().take(HEADER).any(atoms) {
        Ok(Format::Data)
    } else {
        by_name(extension, stem).ok_or_else(|| {
            ImportError::Invalid(format!("line {}, {}, {UNKNOWN}", first.number, shown(first.text.trim())))
        })
    }
}

const FROM_YADE: &str =
    "from YADE, export with textExt, or with the script of `grainlab analyze --yade-script`";

const UNKNOWN: &str = "has an unknown format: neither CSV (p,id,x,y,z,...), nor a LAMMPS dump (ITEM: ...) or data file (LAMMPS ..., or N atoms), nor extended XYZ (N, then Properties=...), nor a YADE export (#format ...), each also as .gz, nor a recording (.mcap or its directory)";

/// First lines that must contain the number of atoms of a LAMMPS data file; the very first is arbitrary.
const HEADER: usize = 20;

const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

const INSTEAD_OF_HDF5: &str = "HDF5 (VTKHDF) is not read: write the packings by `grainlab bag export --format csv`, which loses nothing, \
    or as lammps or xyz";

const MCAP: &[u8] = b"\x89MCAP0\r\n";

fn by_name(extension: &str, stem: &str) -> Option<Format> {
    // LAMMPS users name files dump.x and data.x as well as x.dump and x.data.
    match (extension, stem) {
        ("csv", _) => Some(Format::Csv),
        ("dump" | "lammpstrj", _) | (_, "dump") => Some(Format::Dump),
        ("data", _) | (_, "data") => Some(Format::Data),
        _ => None,
    }
}

fn starts_with(path: &Path, magic: &[u8]) -> bool {
    let mut bytes = vec![0; magic.len()];
    input::open(path).and_then(|(mut f, _)| f.read_exact(&mut bytes)).is_ok() && bytes == magic
}

/// The text of a file; `.gz` is decompressed.
///
/// # Errors
/// If it cannot be read, is damaged or is not text.
pub fn text(path: &Path) -> Result<String, ImportError> {
    let mut bytes = input::bytes(path, input::TEXT).map_err(ImportError::io(path))?;
    let refuse = |problem: String| ImportError::io(path)(io::Error::new(io::ErrorKind::InvalidData, problem));
    if bytes.starts_with(&input::MAGIC) {
        bytes = input::gunzip(&bytes).map_err(ImportError::io(path))?;
    }
    if [&b"BZh"[..], b"\xfd7zXZ", b"\x28\xb5\x2f\xfd", b"PK\x03\x04"].iter().any(|m| bytes.starts_with(m)) {
        let problem = "it is not compressed by gzip: unpack it first";
        return Err(refuse(problem.to_owned()));
    }
    let mut text = String::from_utf8(bytes).map_err(|e| {
        let (good, e) = (e.utf8_error().valid_up_to(), e);
        let line = e.as_bytes()[..good].iter().filter(|b| **b == b'\n').count() + 1;
        refuse(format!("line {line}: it is not text (byte {good} is not UTF-8)"))
    })?;
    // Some Windows programs write a byte order mark first.
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}
