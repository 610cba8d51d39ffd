//! `grainlab bench stiffness`: what all 21 elastic constants of a packing cost, and how wrong they are.

mod measure;
mod plot;
mod report;

use super::folder;
use super::packing::{copies, load, repeated};
use crate::failure::Failure;
use crate::output::{Format, json, print};
use clap::ValueEnum;
use grainlab_core::{Mat3, Packing};
use grainlab_dem::{Engine, EngineSettings, TimeStep};
use grainlab_node_kit::Exit;
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Without --packing it is one of 2,000 grains made by LAMMPS. Copies of a packing converge more easily than a packing of
that size; their rows say so, and exponents never mix the two. A solve that fails has a row that says why.

Examples:
  Every method on 2,000 grains, with its picture (some seconds):
    grainlab bench stiffness --all --out stiffness
  How the cost grows, over packings of one's own and over copies of the first (minutes):
    grainlab bench stiffness --packing a --packing b --packing c --grains 16000,54000,128000 --out stiffness
  A frictionless packing near isostaticity, where iterations become many:
    grainlab bench stiffness --packing recordings/runs/frictionless-1-1 --frictionless";

/// Residual of the solve that others are measured by: the smallest that a solve is asked for.
const CONVERGED: f64 = 1e-13;

/// What to measure, and how.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Packing to measure: CSV with its sidecar, LAMMPS data or dump, or a recording; also as .gz. As often as there are
    /// packings
    #[arg(long, value_name = "FILE")]
    packing: Vec<PathBuf>,
    /// Sizes of copies of the first packing: cubes of its own number of grains
    #[arg(long, value_name = "N", value_delimiter = ',')]
    grains: Vec<u64>,
    /// Relative residuals at which the iterations stop
    #[arg(long, value_name = "REL", value_delimiter = ',', default_value = "1e-2,1e-4,1e-6,1e-8,1e-10,1e-12", value_parser = tolerance)]
    tolerances: Vec<f64>,
    /// Strains of explicit probes, which take far longer
    #[arg(long, value_name = "STRAIN", value_delimiter = ',', value_parser = amplitude)]
    amplitudes: Vec<f64>,
    /// Every method: probes of 1e-4 to 1e-8 too
    #[arg(long, conflicts_with = "amplitudes")]
    all: bool,
    /// Contacts without tangential springs, as of a packing made without friction
    #[arg(long)]
    frictionless: bool,
    /// Grains up to which packings are solved directly: time grows with the square of their number
    #[arg(long, value_name = "N", default_value_t = 4000)]
    direct_up_to: u64,
    /// Grains up to which packings are probed
    #[arg(long, value_name = "N", default_value_t = 4000)]
    probe_up_to: u64,
    /// Repetitions of every case but the probes
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repetitions: u32,
    /// Folder for stiffness.json and stiffness.svg
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

impl Args {
    fn amplitudes(&self) -> Vec<f64> {
        if self.all { vec![1e-4, 1e-5, 1e-6, 1e-7, 1e-8] } else { self.amplitudes.clone() }
    }
}

/// How a stiffness is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
enum Method {
    /// Every grain moves with the strain.
    Affine,
    /// The same, and all grains spin alike.
    MeanSpin,
    /// Conjugate gradients on the frozen network.
    Cg,
    /// A factorisation of the frozen network.
    Direct,
    /// The packing is strained with the whole contact law.
    Probe,
}

impl Method {
    fn name(self) -> &'static str {
        match self {
            Self::Affine => "affine",
            Self::MeanSpin => "mean_spin",
            Self::Cg => "cg",
            Self::Direct => "direct",
            Self::Probe => "probe",
        }
    }

    /// In a legend.
    fn explained(self) -> &'static str {
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

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let paths = args.packing.iter().map(|path| load(Some(path)));
    let mut packings = paths.collect::<Result<Vec<_>, _>>()?;
    if packings.is_empty() {
        packings.push(load(None)?);
    }
    let sizes = if args.grains.is_empty() { Vec::new() } else { copies(packings[0].grains(), &args.grains)? };
    folder::ready(args.out.as_deref())?;
    let mut rows = Vec::new();
    for packing in &packings {
        rows.extend(measure::rows(packing, false, args)?);
    }
    for copies in sizes.into_iter().filter(|copies| *copies > 1) {
        rows.extend(measure::rows(&replicated(&packings[0], copies)?, true, args)?);
    }
    let report = report::report(rows);
    if let Some(folder) = &args.out {
        folder::write(folder, "stiffness.json", &json(&report)?)?;
        folder::write(folder, "stiffness.svg", &plot::svg(&report))?;
    }
    print(&match args.format {
        Format::Json => json(&report)?,
        Format::Csv => report::csv(&report),
        Format::Table => report::text(&report),
    })?;
    Ok(Exit::Done)
}

/// Copies of the packing along each axis. Contacts are those of the overlaps.
fn replicated(packing: &Packing, copies: u32) -> Result<Packing, Failure> {
    let (cell, centres) =
        repeated(packing, copies).ok_or_else(|| Failure::failed("the repeated cell is none"))?;
    let largest = packing.radii.iter().copied().fold(0.0, f64::max);
    let setting = EngineSettings {
        friction: packing.friction,
        damping: 0.0,
        drag: 0.0,
        spin_drag: 0.0,
        tangential: grainlab_core::contact::TangentialLaw::Rescaled,
        time_step: TimeStep::Fixed(1e-9),
        skin: 0.01 * largest,
        thermostat_speed: None,
    };
    let radii = packing.radii.repeat((copies as usize).pow(3));
    let mut engine = Engine::new(cell, packing.material, radii, &centres, setting);
    engine.sort_spatially();
    engine.initialise().map_err(|e| Failure::new(Exit::PhysicsInvalid, e))?;
    Ok(engine.packing(Mat3::identity()))
}
