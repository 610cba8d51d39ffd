//! Errors of an import.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use grainlab_console::Failure;
use grainlab_core::PackingError;

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
    /// Data that were given do not fit the file, or it has a format that is not read.
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
    /// Returns the end of a command: exit code 2 for what another command line mends, else 1.
    pub fn failure(self) -> Failure {
        let text = self.to_string();
        if self.is_usage() { Failure::usage(text) } else { Failure::failed(text) }
    }

    fn is_usage(&self) -> bool {
        match self {
            Self::In { source, .. } => source.is_usage(),
            Self::Missing(_) | Self::Given(_) => true,
            _ => false,
        }
    }

    pub(super) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::In { path, source: Box::new(Self::Invalid(source.to_string())) }
    }

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

    pub(super) fn unsupported(line: usize, what: impl Display, reason: &str) -> Self {
        Self::line(line, format_args!("{what} is not supported: {reason}"))
    }

    pub(super) fn twice(id: u32, line: usize, before: usize) -> Self {
        Self::line(line, format_args!("grain {id} occurs twice, before in line {before}"))
    }

    pub(super) fn no_forces(overlapping: usize) -> Self {
        Self::Invalid(format!(
            "no contact carries a force, although {overlapping} pairs of grains overlap: the forces were written before they were \
             computed (in LAMMPS, dump after a run), or are of another state. Without forces in the file, they follow from the \
             overlaps by the contact law"
        ))
    }

    pub(super) fn count(what: &str, stated: usize, found: usize) -> Self {
        Self::Invalid(format!("it has {found} {what}, and states {stated}: it is cut, or of another state"))
    }

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
    let names = settings.iter().map(|s| s.described()).map(|(what, flag)| format!("{what} (give {flag})"));
    format!("{about} {}", names.collect::<Vec<_>>().join(", "))
}

/// A required property of a packing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Setting {
    /// The periodic cell.
    Cell,
    /// Shear modulus of the grain.
    ShearModulus,
    /// Poisson ratio of the grain.
    PoissonRatio,
    /// Density of the grain.
    Density,
    /// Coefficient of friction.
    Friction,
    /// Radius of the grains.
    Radius,
}

impl Setting {
    /// Name in messages to the user, and flag on the command line with its unit.
    pub fn described(self) -> (&'static str, &'static str) {
        match self {
            Self::Cell => ("the cell", "--cell LX,LY,LZ or nine numbers row by row, m"),
            Self::ShearModulus => ("the grain's shear modulus", "--shear-modulus PA"),
            Self::PoissonRatio => ("the grain's Poisson ratio", "--poisson NU"),
            Self::Density => ("the grain's density", "--density KG_PER_M3"),
            Self::Friction => ("the friction coefficient", "--friction MU"),
            Self::Radius => ("the radius of the grains", "--radius M"),
        }
    }
}
