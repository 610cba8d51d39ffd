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
    /// Data that were given do not fit the file, or it has a format that is not read.
    #[error("{0}")]
    Given(String),
    /// Contacts cannot be found; grains are named by id.
    #[error(transparent)]
    Contacts(#[from] SearchError),
    /// All normal forces pull.
    #[error(
        "{pulling} of {contacts} contacts pull although the grains overlap, and {law} contacts only press: the forces have the wrong \
         sign, because they act on the second grain of each contact. Reverse the signs of all forces; for a LAMMPS dump local, \
         exchange the columns of the two ids by --contact-columns (contact_columns in [start] of a scene)"
    )]
    Reversed {
        /// Number of contacts that pull.
        pulling: usize,
        /// Number of contacts.
        contacts: usize,
        /// Name of the contact law.
        law: &'static str,
    },
    /// The normal forces contradict the contact law, which the file does not state.
    #[error("{}", other_law(law, *ratio, *linear_stiffness, *lengths))]
    OtherLaw {
        /// Name of the contact law that was assumed.
        law: &'static str,
        /// Sum of the normal forces over the sum of the forces of the law.
        ratio: f64,
        /// k_n, N/m, if the forces belong to linear springs.
        linear_stiffness: Option<f64>,
        /// Unit of the lengths, other than m, in which the law gives the forces.
        lengths: Option<&'static str>,
    },
    /// No contact carries a force.
    #[error(
        "no contact carries a force, although {overlapping} pairs of grains overlap: the forces were written before they were computed \
         (in LAMMPS, dump after a run), or are of another state. Without forces in the file, they follow from the overlaps by the \
         contact law"
    )]
    NoForces {
        /// Number of pairs of grains that overlap.
        overlapping: usize,
    },
    /// Contacts carry a force although their grains do not overlap by position.
    #[error(
        "{count} of {contacts} contacts carry a force although their grains do not overlap by position; the strongest, of grains {} \
         and {}, has {force:.3e} N across a gap of {gap:.1e} m: {cause}", ids[0], ids[1]
    )]
    Apart {
        /// Number of such contacts.
        count: usize,
        /// Number of contacts.
        contacts: usize,
        /// Ids of the grains of the contact with the largest force.
        ids: [u32; 2],
        /// Its normal force, N.
        force: f64,
        /// Its gap, m.
        gap: f64,
        /// Why, and what to do.
        cause: String,
    },
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

    /// Contacts whose normals are opposite to the directions between the grains, the first of these two.
    pub(super) fn reversed_normals(line: usize, ids: (u32, u32), reversed: usize, contacts: usize) -> Self {
        let (i, j) = ids;
        Self::line(
            line,
            format_args!(
                "the normals of {reversed} of {contacts} contacts point the wrong way, the first of grains {i} and {j}: the angle to \
                 the direction that positions give is pi; reverse the signs of these normals"
            ),
        )
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

fn other_law(law: &str, ratio: f64, linear_stiffness: Option<f64>, lengths: Option<&str>) -> String {
    // Factors of units need as many digits before the point as after it.
    let times = if (0.01..1e4).contains(&ratio) { format!("{ratio:.3}") } else { format!("{ratio:.2e}") };
    let what = format!(
        "the file states no contact law, and its normal forces are {times} times those of {law} contacts with these overlaps and \
         this material"
    );
    if let Some(unit) = lengths {
        return format!(
            "{what}. They are those of {law} contacts if its lengths are in {unit}: convert positions, radii, overlaps and cell to m"
        );
    }
    let elsewhere = "in a scene, give the law under [contact]; beside a CSV, as contact_law in its JSON";
    match linear_stiffness {
        Some(k_n) => format!(
            "{what}. They are proportional to the overlap, as those of linear springs with k_n = {k_n:.4e} N/m: give \
             --contact-law linear:{k_n:.4e},RATIO, where RATIO is k_t/k_n ({elsewhere})"
        ),
        None => format!(
            "{what}: they belong to another contact law, or the shear modulus is not that of the grains. Give --contact-law, or \
             --shear-modulus; --contact-law {law} measures the packing as it is ({elsewhere})"
        ),
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
