//! `grainlab_bench acoustics`: cost and error of the wave speeds of packings, by method.

mod measure;
mod noise;

pub(crate) use measure::{Method, Plan, rows};

use crate::numbers::between;
use crate::output::Output;
use crate::packing::load_all;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use std::path::PathBuf;

const EXAMPLES: &str = "\
The default packing has 2,000 grains and was made by LAMMPS; its file has no tangential forces, so that prepared packings
are a better test. One row a method and value has the speeds of all packings:

- error, stated: of rho v^2, relative to p Gamma p of the frozen network, root mean squares; stated is the standard deviation
  of the result, including the density. It is zero for an exact measurement of a frozen network, from which moving grains
  differ slightly.
- speed_stated, covered, sigmas_rms, sigmas_mean, sigmas_worst: the speed less that of the frozen network in the same
  direction and polarization, with the mass that moves with the wave, over the standard deviation stated, and its median;
  covered is the share within 1.96 of it, .95 for errors that are normally distributed.
- moduli: largest relative error of C33, C11, C44, C66 and C13 by Christoffel, against the transversely isotropic projection
  of the stiffness: three rays alone do not give its average over azimuths.

Examples:
  Every method on the packings of a run along three rays, with plots (some minutes):
    cargo run --release -p grainlab_bench -- acoustics --packing recordings/runs/s2-1-1 --out acoustics
  A full set of speeds by dispersion:
    cargo run --release -p grainlab_bench -- acoustics --survey complete --method dispersion
  Whether stated errors hold, over the packings of many runs:
    cargo run --release -p grainlab_bench -- acoustics --method dispersion --tolerances 1e-5 --packing recordings/runs/s2-1-1
  Microstructure from speeds with errors of 0 to 3 %, and from moduli of the network:
    cargo run --release -p grainlab_bench -- acoustics --survey complete --noise 0,0.001,0.003,0.01,0.03 --packing recordings/runs/s2-1-1";

/// The packings to measure.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Packings to measure: CSV with its sidecar, LAMMPS data or dump, or every packing of a recording;
    /// also as .gz. May be repeated
    #[arg(long, value_name = "FILE")]
    packing: Vec<PathBuf>,
    #[command(flatten)]
    plan: Plan,
    /// Instead: infer z and eps from speeds by dispersion with these relative errors, and compare them with
    /// the counted ones
    #[arg(long, value_name = "REL", value_delimiter = ',', value_parser = |text: &str| between(text, 0.0, 0.5), conflicts_with = "method")]
    noise: Vec<f64>,
    /// Draws of the noise per packing
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    draws: u32,
    #[command(flatten)]
    output: Output,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let packings = load_all(&args.packing)?;
    args.output.ready()?;
    let found = if args.noise.is_empty() {
        rows(&packings, &args.plan)?
    } else {
        noise::rows(&packings, args.plan.survey, &args.noise, args.draws)?
    };
    args.output.finish("acoustics", found)
}
