//! The packings, methods and values to measure.

use clap::ValueEnum;
use grainlab_console::Format;
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
The default packing has 2,000 grains and was made by LAMMPS. Copies of a packing converge faster than a packing of that
size; their rows are marked, and exponents never mix the two. The row of a failed solve has the reason.

Examples:
  Every method on 2,000 grains, with a plot (some seconds):
    grainlab bench stiffness --all --out stiffness
  Growth of the cost over several packings and over copies of the first (minutes):
    grainlab bench stiffness --packing a --packing b --packing c --grains 16000,54000,128000 --out stiffness
  A frictionless packing near isostaticity, where many iterations are needed:
    grainlab bench stiffness --packing recordings/runs/frictionless-1-1 --frictionless";

/// Residual of the reference solve: the smallest that a solve accepts.
pub(super) const CONVERGED: f64 = 1e-13;

/// The packings, methods and values to measure.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Packing to measure: CSV with its sidecar, LAMMPS data or dump, or a recording; also as .gz. May be
    /// repeated
    #[arg(long, value_name = "FILE")]
    pub(super) packing: Vec<PathBuf>,
    /// Sizes of copies of the first packing: its number of grains times cubes
    #[arg(long, value_name = "N", value_delimiter = ',')]
    pub(super) grains: Vec<u64>,
    /// Relative residuals at which the iterations stop
    #[arg(long, value_name = "REL", value_delimiter = ',', default_value = "1e-2,1e-4,1e-6,1e-8,1e-10,1e-12", value_parser = tolerance)]
    pub(super) tolerances: Vec<f64>,
    /// Strains of explicit probes, which take far longer
    #[arg(long, value_name = "STRAIN", value_delimiter = ',', value_parser = amplitude)]
    amplitudes: Vec<f64>,
    /// Every method: also probes of 1e-4 to 1e-8
    #[arg(long, conflicts_with = "amplitudes")]
    all: bool,
    /// Contacts without tangential springs, as in a packing prepared without friction
    #[arg(long)]
    pub(super) frictionless: bool,
    /// Largest number of grains for the direct solve: its time grows with the square of the number
    #[arg(long, value_name = "N", default_value_t = 4000)]
    pub(super) direct_up_to: u64,
    /// Largest number of grains for probes
    #[arg(long, value_name = "N", default_value_t = 4000)]
    pub(super) probe_up_to: u64,
    /// Repetitions of every case except probes
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(super) repetitions: u32,
    /// Folder for stiffness.json and stiffness.svg
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    pub(super) format: Format,
}

impl Args {
    /// Every method on a packing of any size.
    pub(super) fn of(tolerances: &[f64], amplitudes: &[f64], repetitions: u32) -> Self {
        Self {
            packing: Vec::new(),
            grains: Vec::new(),
            tolerances: tolerances.to_vec(),
            amplitudes: amplitudes.to_vec(),
            all: false,
            frictionless: false,
            direct_up_to: u64::MAX,
            probe_up_to: u64::MAX,
            repetitions,
            out: None,
            format: Format::Table,
        }
    }

    pub(super) fn amplitudes(&self) -> Vec<f64> {
        if self.all { vec![1e-4, 1e-5, 1e-6, 1e-7, 1e-8] } else { self.amplitudes.clone() }
    }
}

/// A method for the stiffness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Method {
    /// Every grain moves with the strain.
    Affine,
    /// The same with a uniform spin of all grains.
    MeanSpin,
    /// Conjugate gradients on the frozen network.
    Cg,
    /// A factorisation of the frozen network.
    Direct,
    /// The packing is strained with the whole contact law.
    Probe,
}

impl Method {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Affine => "affine",
            Self::MeanSpin => "mean_spin",
            Self::Cg => "cg",
            Self::Direct => "direct",
            Self::Probe => "probe",
        }
    }

    /// Name in a legend.
    pub(super) fn explained(self) -> &'static str {
        match self {
            Self::Affine => "affine motion",
            Self::MeanSpin => "and a mean spin",
            Self::Cg => "cg, at its residual",
            Self::Direct => "direct",
            Self::Probe => "probe, at its strain",
        }
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    between(text, CONVERGED, 1e-2)
}

fn amplitude(text: &str) -> Result<f64, String> {
    between(text, 1e-12, 1e-2)
}

fn between(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value = text.parse().ok().filter(|v| (least..=most).contains(v));
    value.ok_or_else(|| format!("a number from {least:e} to {most:e}"))
}
