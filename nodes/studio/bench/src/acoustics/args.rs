//! The packings, methods and values to measure.

use clap::ValueEnum;
use grainlab_acoustics::Survey;
use grainlab_console::Format;
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
The default packing has 2,000 grains and was made by LAMMPS; its file has no tangential forces, so that prepared packings
are a better test.

Examples:
  Every method on one packing along three rays, with plots (some minutes):
    grainlab bench acoustics --packing recordings/runs/s2-1-1 --out acoustics
  A full set of speeds by dispersion:
    grainlab bench acoustics --survey complete --method dispersion
  Whether stated errors hold, over the packings of many runs:
    grainlab bench acoustics --judge --method dispersion --packing recordings/runs/s2-1-1
  Microstructure from speeds with errors of 0 to 3 %, and from moduli of the network (every packing of every file):
    grainlab bench acoustics --survey complete --noise 0,0.001,0.003,0.01,0.03 --packing recordings/runs/s2-1-1";

/// The packings, methods and values to measure.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Packing to measure: CSV with its sidecar, LAMMPS data or dump, or a recording (its first packing);
    /// also as .gz. May be repeated
    #[arg(long, value_name = "FILE")]
    pub(super) packing: Vec<PathBuf>,
    /// Methods [default: all]
    #[arg(long, value_name = "METHOD", value_delimiter = ',')]
    method: Vec<Method>,
    /// Rays: three (9 speeds) or complete (27; 39 where the packing is repeated along its path)
    #[arg(long, value_enum, default_value_t)]
    pub(super) survey: Rays,
    /// Tolerances of the squared frequencies of a dispersion
    #[arg(long, value_name = "REL", value_delimiter = ',', default_value = "1e-2,1e-4,1e-6,1e-8", value_parser = tolerance)]
    pub(super) tolerances: Vec<f64>,
    /// Instead: infer the microstructure from speeds by dispersion with these relative errors, and compare it
    /// with the counted one
    #[arg(long, value_name = "REL", value_delimiter = ',', value_parser = noise, conflicts_with_all = ["method", "out"])]
    pub(super) noise: Vec<f64>,
    /// Instead: compare the errors of all speeds of every packing of every file with those stated, one row a method,
    /// with the default settings
    #[arg(long, conflicts_with_all = ["noise", "out", "draws", "tolerances"])]
    pub(super) judge: bool,
    /// Draws of the noise per packing
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(super) draws: u32,
    /// Folder for acoustics.json, acoustics.svg (time against error) and dispersion.svg
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    pub(super) format: Format,
}

impl Args {
    /// These methods along three rays.
    pub(super) fn of(methods: &[Method], tolerances: &[f64]) -> Self {
        Self {
            packing: Vec::new(),
            method: methods.to_vec(),
            survey: Rays::Three,
            tolerances: tolerances.to_vec(),
            noise: Vec::new(),
            judge: false,
            draws: 1,
            out: None,
            format: Format::Table,
        }
    }

    pub(super) fn methods(&self) -> &[Method] {
        if self.method.is_empty() { Method::value_variants() } else { &self.method }
    }
}

/// A set of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Rays {
    /// Along the axis, across it, and between.
    #[default]
    Three,
    /// With all azimuths for a transversely isotropic average.
    Complete,
}

impl From<Rays> for Survey {
    fn from(rays: Rays) -> Self {
        match rays {
            Rays::Three => Survey::Minimal,
            Rays::Complete => Survey::AzimuthalAverage,
        }
    }
}

/// A method of measuring speeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
#[value(rename_all = "snake_case")]
pub(crate) enum Method {
    /// Modes of the frozen network.
    Dispersion,
    /// Onset of a burst.
    FirstArrival,
    /// Delay of largest correlation of a burst.
    CrossCorrelation,
    /// Delay of the peak of a burst.
    Peak,
}

impl Method {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Dispersion => "dispersion",
            Self::FirstArrival => "first_arrival",
            Self::CrossCorrelation => "cross_correlation",
            Self::Peak => "peak",
        }
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|v| (1e-12..=1e-2).contains(v));
    value.ok_or_else(|| "a number from 1e-12 to 1e-2".to_owned())
}

fn noise(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|v| (0.0..=0.5).contains(v));
    value.ok_or_else(|| "a number from 0 to 0.5".to_owned())
}
