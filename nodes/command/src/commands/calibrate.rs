//! `grainlab calibrate`: constants of the models, learned from measured packings.
//!
//! - [`packings`]: from the rows of a table to samples

mod packings;

use grainlab_calibration::learn;
use grainlab_console::{Failure, print, say, write_whole};
use grainlab_node_kit::Exit;
use packings::Naming;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  The packings of the calibration grainlab:
    grainlab campaign nodes/scenes/campaigns/isotropic.toml
    grainlab campaign nodes/scenes/campaigns/anisotropic.toml
    C=recordings/campaigns
    grainlab calibrate --isotropic $C/isotropic/states.csv --anisotropic $C/anisotropic/states.csv \\
      --preparation scene --packing scene,set.friction,seed --out mine.toml
    grainlab invert --table states.csv --calibration mine.toml

With --other, the laws of the model relaxed are also learned from packings of other recipes, materials, stresses and sizes.

Tables have the columns of `grainlab analyze --format csv`: pressure_pa, phi, grains, k, z, eps, eps_stiffness, all six
moduli (g12_pa g13_pa theta_pa ti_c11_pa ti_c33_pa ti_c13_pa, or the stiffness), and, if known, g_total g_elastic g_contact,
axial_q_over_p and size_spread (else 0: isotropic stress, equal grains);
and columns that identify the preparation of each packing and the packing.";

/// Packings to learn from.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Isotropic packings of many coordination numbers and pressures, CSV; - is the standard input
    #[arg(long, value_name = "FILE.csv")]
    isotropic: PathBuf,
    /// Anisotropic packings, CSV; without them only Eqs. 21 and 22 are fitted, not the model relaxed
    #[arg(long, value_name = "FILE.csv")]
    anisotropic: Option<PathBuf>,
    /// Packings of other recipes, materials, stresses and sizes, CSV: only for the model relaxed
    #[arg(long, value_name = "FILE.csv", requires = "anisotropic")]
    other: Option<PathBuf>,
    /// Columns that identify the recipe of a packing: the laws are tested on each recipe with those learned from
    /// the others
    #[arg(long, value_name = "COLUMN,...", value_delimiter = ',', default_value = "preparation")]
    preparation: Vec<String>,
    /// Columns that identify the packing: states of one packing at several pressures are not independent
    #[arg(long, value_name = "COLUMN,...", value_delimiter = ',', default_value = "preparation,mu2,seed")]
    packing: Vec<String>,
    /// Name of the calibration, reported with every estimate [default: the name of the output file]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Write the calibration to this file (TOML); - is the standard output, as without this flag
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let naming = Naming { preparation: &args.preparation, packing: &args.packing };
    let isotropic = packings::read(&args.isotropic, &naming)?;
    packings::check_isotropic(&isotropic)
        .map_err(|e| Failure::usage(format!("{}: {e}", args.isotropic.display())))?;
    let read = |path: &Option<PathBuf>| path.as_ref().map(|path| packings::read(path, &naming)).transpose();
    let anisotropic = read(&args.anisotropic)?.unwrap_or_default();
    let other = read(&args.other)?.unwrap_or_default();
    let file_name = args.out.as_ref().and_then(|path| path.file_stem()).map(|n| n.to_string_lossy());
    let file_name = file_name.filter(|n| n != "-").map_or_else(|| "unnamed".to_owned(), |n| n.into_owned());
    let name = args.name.clone().unwrap_or(file_name);
    let invalid = |e| Failure::new(Exit::PhysicsInvalid, format!("no calibration: {e}"));
    let calibration = learn(&name, &isotropic, &anisotropic, &other).map_err(invalid)?;
    let toml = calibration.to_toml().map_err(Failure::failed)?;
    match &args.out {
        Some(path) if path.as_os_str() != "-" => {
            write_whole(path, toml).map_err(Failure::at(path))?;
            say!("grainlab: {} is written; use it with --calibration {0}", path.display());
        }
        _ => print(&toml)?,
    }
    Ok(Exit::Done)
}
