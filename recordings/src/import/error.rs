//! Errors of an import.

use std::io;
use std::path::{Path, PathBuf};

use grainlab_core::PackingError;

use super::contacts::SearchError;
use super::setting::Setting;
use crate::reader::ReadError;

/// Errors of an import.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// A file cannot be read.
    #[error("{path}: {source}")]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// A recording cannot be read.
    #[error(transparent)]
    Recording(#[from] ReadError),
    /// An error with its file.
    #[error("{path}: {source}")]
    In {
        /// Path of the file.
        path: PathBuf,
        /// Description of the fault.
        source: Box<ImportError>,
    },
    /// The format of the file is unknown.
    #[error(
        "line {line}, {first}, has an unknown format: neither CSV (p,id,x,y,z,...), nor a LAMMPS dump (ITEM: ...) or data file (LAMMPS ..., or N atoms), nor extended XYZ (N, then Properties=...), nor a YADE export (#format ...), each also as .gz, nor VTKHDF, nor a recording (.mcap or its directory)"
    )]
    UnknownFormat {
        /// First line that is not empty, counted from 1.
        line: usize,
        /// The beginning of that line, quoted.
        first: String,
    },
    /// A line is invalid in its format.
    #[error("line {line}: {problem}")]
    Syntax {
        /// Line, counted from 1.
        line: usize,
        /// Expectation, and what was found.
        problem: String,
    },
    /// An HDF5 file is damaged, or is not VTKHDF.
    #[error("HDF5: {0}")]
    Hdf(String),
    /// The file, its sidecar and the options lack these quantities.
    #[error("the file lacks {}", list(.0))]
    Missing(Vec<Setting>),
    /// The sidecar is invalid.
    #[error("sidecar: {0}")]
    Sidecar(String),
    /// The cell has no positive volume.
    #[error("the cell {0:?} (row-major, columns are the edge vectors, m) has no positive volume")]
    Cell([f64; 9]),
    /// The file uses a feature that is not supported.
    #[error("line {line}: {what} is not supported: {reason}")]
    Unsupported {
        /// Line, counted from 1.
        line: usize,
        /// Name of the feature.
        what: String,
        /// Why, and what to do.
        reason: &'static str,
    },
    /// An id occurs twice.
    #[error("line {line}: grain {id} occurs twice, before in line {before}")]
    DuplicateId {
        /// Id of the grain.
        id: u32,
        /// Line, counted from 1.
        line: usize,
        /// Line of its first occurrence.
        before: usize,
    },
    /// A contact names a grain that does not exist.
    #[error("line {line}: a contact names grain {id}, which does not exist")]
    UnknownId {
        /// Line, counted from 1.
        line: usize,
        /// Id of the grain.
        id: u32,
    },
    /// A contact contradicts the positions.
    #[error(
        "line {line}: {quantity} of the contact of grains {i} and {j} is {given:e}, but positions give {found:e}: positions, cell and contacts are not of the same state, or have too few digits (17 are needed)"
    )]
    Contradiction {
        /// Line, counted from 1.
        line: usize,
        /// Id of the first grain.
        i: u32,
        /// Id of the second grain.
        j: u32,
        /// The quantity that disagrees, with its unit.
        quantity: &'static str,
        /// Value in the file.
        given: f64,
        /// Value from positions.
        found: f64,
    },
    /// Contacts cannot be found; grains are named by id.
    #[error(transparent)]
    Contacts(#[from] SearchError),
    /// Contact forces without tangential ones, of a packing with friction.
    #[error(
        "contact forces all point along their contacts, with a friction of {friction}: for granular pair styles LAMMPS gives \
         the normal force alone as fx fy fz. Add the tangential force, p1 p2 p3: compute pl all property/local patom1 patom2, \
         compute pf all pair/local dist fx fy fz p1 p2 p3, dump forces all local 1 forces.dump c_pl[*] c_pf[*], dump_modify \
         forces format float %.17g; or give --friction 0 if there is none"
    )]
    NoTangentialForces {
        /// Coefficient of friction.
        friction: f64,
    },
    /// Columns of contact forces that are not what they are taken for.
    #[error("contact forces: {problem}; {likely}")]
    Columns {
        /// The parts of the force that are wrong, and their columns.
        problem: String,
        /// The columns that fit.
        likely: String,
    },
    /// Contact forces given with a file that has them itself, or cannot have them.
    #[error("contact forces in a file of their own are read beside a LAMMPS dump or data file only")]
    ForcesBeside,
    /// A file has another number of grains or contacts than it states.
    #[error("it has {found} {what}, and states {stated}: it is cut, or of another state")]
    Count {
        /// Grains or contacts.
        what: &'static str,
        /// Number that is stated.
        stated: usize,
        /// Number that was found.
        found: usize,
    },
    /// Grains and contact forces are of different steps.
    #[error(
        "the contact forces are of step {} and the grains of step {grains}: dump both at the same step", some(.forces)
    )]
    OtherStep {
        /// Steps of the contact forces.
        forces: Vec<u64>,
        /// Step of the grains.
        grains: u64,
    },
    /// The packing is invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// A recorded message is not a valid packing.
    #[error("message {sequence} on {topic}: {problem}")]
    Message {
        /// Name of the topic.
        topic: String,
        /// Low half of its sequence number.
        sequence: u32,
        /// Description of the fault.
        problem: String,
    },
    /// Data were given for a recording, which has its own.
    #[error(
        "a recording has its own cell, grains, material, friction and forces: leave out {}, or export the packing with \
         `grainlab bag export` and analyze the file",
        .0.join(", ")
    )]
    HasItsOwn(Vec<&'static str>),
    /// The file contains no packing.
    #[error("it contains no packing")]
    Empty,
}

impl ImportError {
    /// An error of the system with a file.
    pub(super) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }

    /// A feature in a line that is not supported, and why.
    pub(super) fn unsupported(line: usize, what: impl Into<String>, reason: &'static str) -> Self {
        Self::Unsupported { line, what: what.into(), reason }
    }
}

fn list(settings: &[Setting]) -> String {
    let names: Vec<String> = settings.iter().map(|s| format!("{} (give {})", s.what(), s.flag())).collect();
    names.join(", ")
}

/// The steps, or the first and the last of many.
fn some(steps: &[u64]) -> String {
    match steps {
        [first, second, .., last] if steps.len() > 6 => {
            format!("{first}, {second}, ... {last} ({} frames)", steps.len())
        }
        _ => steps.iter().map(u64::to_string).collect::<Vec<_>>().join(", "),
    }
}
