//! `grainlab probe`: sends waves through packings from files, without DDS.
//!
//! - [`flags`]: the parameters of the node acoustic_probe as flags; [`measure`]: one packing

mod flags;
mod measure;

use super::packings::{files, import};
use flags::Flags;
use grainlab_console::Failure;
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use grainlab_results::ACOUSTIC;
use grainlab_results::quantities::help;
pub(crate) use measure::measure;

const EXAMPLES: &str = "\
Examples:
  Wave speeds of every packing of a recorded run, and their moduli, compared with those of the contact network:
    grainlab probe recordings/runs/demo-1-1
  A packing of LAMMPS with an instrument error of 0.3 %:
    grainlab probe packing.data --shear-modulus 29e9 --poisson 0.2 --friction 0.3 --speed-noise 0.003
  Bursts through the packing, with picked arrivals and recorded traces:
    grainlab probe packing.csv --method cross_correlation --signal-to-noise 20 --shots 64 --record traces
  The inversion of the speeds, compared with the counted structure:
    grainlab probe recordings/runs/* --format csv | grainlab invert --table - --judge --model relaxed";

/// Files to send waves through, and data that they lack.
#[derive(Debug, clap::Args)]
#[command(
    after_help = format!("{EXAMPLES}\n\n{}", import::FORMATS),
    after_long_help = format!("{EXAMPLES}\n\n{}\n\nQuantities, as keys of JSON and columns of CSV:\n{}", import::FORMATS, help(ACOUSTIC)),
    allow_negative_numbers = true
)]
pub(crate) struct Args {
    #[command(flatten)]
    packings: files::Args,
    #[command(flatten)]
    flags: Flags,
}

pub(crate) fn settings(given: &[(String, String)]) -> Result<grainlab_acoustic_probe::Settings, Failure> {
    Flags::of(given)?.settings()
}

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let settings = args.flags.settings()?;
    let measure = |source: &str, imported: &_| measure(&settings, source, imported);
    args.packings.measured("probe", &[topics::WAVE_SPEEDS, topics::WAVEFORM], measure)
}
