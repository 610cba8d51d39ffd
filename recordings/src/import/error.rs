//! Errors of an import.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use grainlab_console::Failure;
use grainlab_core::PackingError;

use super::setting::Setting;
use grainlab_core::contact_search::SearchError;

/// Errors of an import.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// A recording cannot be read.
    #[error(transparent)]
    Recording(#[from] Failure),
    /// An error with its file.
    #[error("{path}: {source}")]
    In {
        /// Path of the file.
        path: PathBuf,
        /// Description of the fault.
        source: Box<ImportError>,
    },
    /// The file, its sidecar and the options lack these quantities.
    #[error("{}", missing(.0))]
    Missing(Vec<Setting>),
    /// Data that were given do not fit the file.
    #[error("{0}")]
    Given(String),
    /// Contacts cannot be found; grains are named by id.
    #[error(transparent)]
    Contacts(#[from] SearchError),
    /// The packing is invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// The content is not that of a packing: the line, what was expected and what was found.
    #[error("{0}")]
    Invalid(String),
}

impl ImportError {
    /// An error of the system with a file.
    pub(super) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::In { path, source: Box::new(Self::Invalid(source.to_string())) }
    }

    /// The file contains no packing.
    pub(super) fn empty() -> Self {
        Self::Invalid("it contains no packing".to_owned())
    }

    /// Contact forces given with a file that has them itself, or cannot have them.
    pub(super) fn forces_beside() -> Self {
        Self::Given(
            "contact forces in a file of their own are read beside a LAMMPS dump or data file only"
                .to_owned(),
        )
    }

    /// A line, counted from 1, that is invalid in its format.
    pub(super) fn line(line: usize, problem: impl Display) -> Self {
        Self::Invalid(format!("line {line}: {problem}"))
    }

    /// A feature in a line that is not supported, and why.
    pub(super) fn unsupported(line: usize, what: impl Display, reason: &str) -> Self {
        Self::line(line, format_args!("{what} is not supported: {reason}"))
    }

    /// A grain that occurs twice, in two lines.
    pub(super) fn twice(id: u32, line: usize, before: usize) -> Self {
        Self::line(line, format_args!("grain {id} occurs twice, before in line {before}"))
    }

    /// Another number of grains or contacts than is stated.
    pub(super) fn count(what: &str, stated: usize, found: usize) -> Self {
        Self::Invalid(format!("it has {found} {what}, and states {stated}: it is cut, or of another state"))
    }

    /// A contact with a grain that does not exist.
    pub(super) fn unknown_id(line: usize, id: u32) -> Self {
        Self::line(line, format_args!("a contact names grain {id}, which does not exist"))
    }
}

/// Most quantities that a packing may lack; a file that lacks more is something else.
const OF_A_PACKING: usize = 3;

fn missing(settings: &[Setting]) -> String {
    let about = match settings.len() {
        0..=OF_A_PACKING => "the file lacks",
        _ => "this does not look like a file of a packing: it lacks",
    };
    format!("{about} {}", list(settings))
}

fn list(settings: &[Setting]) -> String {
    let names = settings.iter().map(|s| s.described()).map(|(what, flag)| format!("{what} (give {flag})"));
    names.collect::<Vec<_>>().join(", ")
}
