//! `grainlab calibrate`: constants of the models, learned from measured packings.
//!
//! - [`packings`]: from the rows of a table to samples

mod packings;

use grainlab_calibration::{check, learn};
use grainlab_console::{Failure, print, say, write_whole};
use grainlab_emt::CalibrationError;
use grainlab_node_kit::Exit;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  The packings of the calibration grainlab:
    grainlab campaign nodes/scenes/campaigns/isotropic.toml
    grainlab campaign nodes/scenes/campaigns/anisotropic.toml
    C=recordings/campaigns
    grainlab calibrate --isotropic $C/isotropic/states.csv --anisotropic $C/anisotropic/states.csv --out mine.toml
    grainlab invert --table states.csv --calibration mine.toml

With --other, the laws of the model relaxed are also learned from packings of other recipes, materials, stresses and sizes.

Tables are those of `grainlab campaign gather`, or have the columns of `grainlab analyze --format csv`: pressure_pa, phi, grains,
k, z, eps, eps_stiffness, all six moduli (g12_pa g13_pa theta_pa ti_c11_pa ti_c33_pa ti_c13_pa, or the stiffness), and, if known,
g_total g_elastic g_contact, axial_q_over_p and size_spread (else 0: isotropic stress, equal grains); and columns that identify the preparation of each packing and the packing.

Refused are: a packing given twice; isotropic packings with |eps| above 2.5 standard deviations of chance, 1.12/sqrt(contacts), or a
mean eps above 3 standard errors; anisotropic ones with eps that varies no more than that of the isotropic ones; fewer packings than
constants; and a slope of Eqs. 21 and 22 whose 95 % interval contains 0. States of one packing count as one. Where no |q/p| is
above 1e-5, and a settled servo leaves up to 5e-6, the laws are without q/p.";

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
    /// Packings of other recipes, materials, stresses and sizes, CSV: only for the model relaxed; repeatable
    #[arg(long, value_name = "FILE.csv", requires = "anisotropic")]
    other: Vec<PathBuf>,
    /// Columns that identify the recipe of a packing: the laws are tested on each recipe with those learned from
    /// the others [default: scene with a column member, else preparation]
    #[arg(long, value_name = "COLUMN,...", value_delimiter = ',')]
    preparation: Option<Vec<String>>,
    /// Columns that identify the packing: states of one packing at several pressures are not independent [default: member
    /// without its pressure, else preparation,mu2,seed]
    #[arg(long, value_name = "COLUMN,...", value_delimiter = ',')]
    packing: Option<Vec<String>>,
    /// Name of the calibration, reported with every estimate [default: the name of the output file]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Write the calibration to this file (TOML); - is the standard output, as without this flag
    #[arg(long, short, alias = "output", value_name = "FILE.toml")]
    out: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let split = |names: &str| names.split(',').map(str::to_owned).collect::<Vec<_>>();
    let named = |recipe: &str, packing: &str| {
        let recipe = args.preparation.clone().unwrap_or_else(|| split(recipe));
        [recipe, args.packing.clone().unwrap_or_else(|| split(packing))].concat()
    };
    let (gathered, stored) = (named("scene", "member"), named("preparation", "preparation,mu2,seed"));
    let recipe = args.preparation.as_ref().map_or(1, Vec::len);
    let read = |path: &PathBuf| packings::read(path, recipe, &[&gathered, &stored]);
    let isotropic = read(&args.isotropic)?;
    let anisotropic = args.anisotropic.as_ref().map(read).transpose()?.unwrap_or_default();
    let others = args.other.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let file_name = args.out.as_ref().and_then(|path| path.file_stem()).map(|n| n.to_string_lossy());
    let file_name = file_name.filter(|n| n != "-").map_or_else(|| "unnamed".to_owned(), |n| n.into_owned());
    let name = args.name.clone().unwrap_or(file_name);
    let exit = |e: &_| match e {
        CalibrationError::Packing { .. } => Exit::Usage,
        _ => Exit::PhysicsInvalid,
    };
    let invalid = |e| Failure::new(exit(&e), format!("no calibration: {e}"));
    let other = others.concat();
    check(&isotropic, &anisotropic, &other).map_err(invalid)?;
    let calibration = learn(&name, &isotropic, &anisotropic, &other).map_err(invalid)?;
    let toml = calibration.to_toml().map_err(Failure::failed)?;
    let mut files = packings::counted(&args.isotropic, &isotropic);
    let (values, covariance) = (calibration.isotropic().constants(), calibration.isotropic().covariance);
    let text = |i: usize| {
        let stddev = covariance.map_or(f64::NAN, |c| c[i][i].sqrt());
        format!("; {} = {:.4} +- {stddev:.4}", ["alpha", "beta", "rho", "zeta"][i], values[i])
    };
    say!("grainlab: Eqs. 21 and 22 from {files}{}", (0..4).map(text).collect::<String>());
    let more = args.anisotropic.iter().zip([&anisotropic]).chain(args.other.iter().zip(&others));
    files +=
        &more.map(|(path, samples)| format!("; {}", packings::counted(path, samples))).collect::<String>();
    if let Some(network) = &calibration.network {
        let none = network.dilatation.by_stress_ratio == [0.0; 3];
        let note = if none { "; without q/p, because none is above 1e-5" } else { "" };
        say!("grainlab: relaxed, of {} recipes, from {files}{note}", network.recipes);
    }
    match &args.out {
        Some(path) if path.as_os_str() != "-" => {
            write_whole(path, toml)?;
            say!("grainlab: {} is written; use it with --calibration {0}", path.display());
        }
        _ => print(&toml)?,
    }
    Ok(Exit::Done)
}
