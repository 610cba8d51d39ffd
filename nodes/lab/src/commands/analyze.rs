//! `grainlab analyze`: measures packings from files, without DDS.

use crate::failure::{Failure, worse};
use crate::output::{Format, json, print};
use crate::results::state::{self, State};
use crate::results::state_text;
use grains::{Mat3, Vec3};
use node_kit::Exit;
use rayon::prelude::*;
use recordings::Recording;
use recordings::import::{ImportError, ImportOptions, Imported, load};
use std::path::{Path, PathBuf};
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  Every packing of a recorded run:
    grainlab analyze recordings/runs/demo-1-1
  A LAMMPS dump (id type x y z radius ...), with what the file does not say:
    grainlab analyze settle.dump --shear-modulus 29e9 --poisson 0.2 --density 2500 --friction 0.3 --format json
  The same stiffness by straining the packing itself, to see what the linear response leaves out:
    grainlab analyze recordings/runs/demo-1-1 --method probe";

/// Forward and backward stiffness of a probe may differ by this share without a warning: half of it is the error of either,
/// and the difference of both is of a smaller order.
const ONE_SIDED: f64 = 0.01;

/// Files to measure, and what they do not say. A flag goes before what a file or its sidecar says.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Recordings (directory or .mcap), CSV with its JSON sidecar, LAMMPS dump or data files; each also as .gz
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Shear modulus of the grains, Pa
    #[arg(long, value_name = "PA")]
    shear_modulus: Option<f64>,
    /// Poisson ratio of the grains
    #[arg(long, value_name = "NU")]
    poisson: Option<f64>,
    /// Density of the grains, kg/m3
    #[arg(long, value_name = "KG_PER_M3")]
    density: Option<f64>,
    /// Friction coefficient; inf is allowed
    #[arg(long, value_name = "MU")]
    friction: Option<f64>,
    /// Radius of every grain, m, for files that have none
    #[arg(long, value_name = "M")]
    radius: Option<f64>,
    /// Periodic cell, m: three edge lengths, or nine numbers row by row with the edge vectors as columns
    #[arg(long, value_name = "LX,LY,LZ", value_delimiter = ',', allow_negative_numbers = true)]
    cell: Vec<f64>,
    /// Topic of recordings to read
    #[arg(long, value_name = "NAME", default_value = "packing")]
    topic: String,
    /// LAMMPS `dump local` with the contact forces of a single-frame dump
    #[arg(long, value_name = "FILE")]
    contact_forces: Option<PathBuf>,
    /// Axis of eps and of the ratios gamma/Delta; stiffnesses stay in the frame of the cell
    #[arg(
        long,
        value_name = "X,Y,Z",
        value_delimiter = ',',
        num_args = 1,
        default_value = "0,0,1",
        allow_negative_numbers = true
    )]
    axis: Vec<f64>,
    /// Relative residual at which the stiffness solve stops
    #[arg(long, value_name = "REL", default_value_t = micro::Settings::default().tolerance)]
    tolerance: f64,
    /// How the stiffness is found
    #[arg(long, value_enum, default_value_t)]
    method: Method,
    /// Strain of the probe, forward and backward; far below overlap/diameter
    #[arg(long, value_name = "STRAIN", default_value_t = micro::Probe::default().amplitude)]
    amplitude: f64,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// Linear response of the frozen contact network
    #[default]
    Network,
    /// Explicit: strain the packing a little, relax, read the stress
    Probe,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let (options, settings) = (options(args)?, settings(args)?);
    // Files in parallel, then all packings in parallel; results stay in the order given.
    let loaded: Vec<Loading> = args.files.par_iter().map(|path| read(path, &options)).collect();
    let mut exit = Exit::Done;
    let mut packings = Vec::new();
    for file in &loaded {
        file.complaints.iter().for_each(|line| crate::output::say!("grainlab: {line}"));
        exit = worse(exit, file.exit);
        packings.extend(file.packings.iter().map(|p| (file.path, p)));
    }
    let measured: Vec<Result<State, String>> =
        packings.par_iter().map(|(path, imported)| measure(path, imported, &settings)).collect();
    let mut states = Vec::new();
    for result in measured {
        match result {
            Ok(state) => states.push(state),
            Err(message) => {
                crate::output::say!("grainlab: {message}");
                exit = worse(exit, Exit::PhysicsInvalid);
            }
        }
    }
    if !states.is_empty() && states.iter().all(|s| s.stiffness_pa.is_none()) {
        exit = worse(exit, Exit::PhysicsInvalid);
    }
    let text = match args.format {
        Format::Json => json(&states)?,
        Format::Csv => state::csv(&states),
        Format::Table => {
            states.iter().map(|s| format!("{}, step {}\n{}", s.source, s.step, state_text::text(s))).collect()
        }
    };
    print(&text)?;
    Ok(exit)
}

/// Refuses a flag whose value is out of range, by its name.
fn in_range(
    flag: &str,
    value: Option<f64>,
    requirement: &str,
    accept: fn(f64) -> bool,
) -> Result<(), Failure> {
    match value.filter(|v| !accept(*v)) {
        Some(v) => Err(Failure::usage(format!("--{flag} {v} is out of range: {requirement}"))),
        None => Ok(()),
    }
}

fn options(args: &Args) -> Result<ImportOptions, Failure> {
    let positive = |v: f64| v > 0.0 && v.is_finite();
    in_range("shear-modulus", args.shear_modulus, "a modulus in Pa, more than 0", positive)?;
    in_range("poisson", args.poisson, "from 0 to 0.5", |v| (0.0..=0.5).contains(&v))?;
    in_range("density", args.density, "a density in kg/m3, more than 0", positive)?;
    in_range("friction", args.friction, "0 or more", |v| v >= 0.0)?;
    in_range("radius", args.radius, "a length in m, more than 0", positive)?;
    let cell = match args.cell.as_slice() {
        [] => None,
        [x, y, z] => Some(Mat3::from_diagonal(&Vec3::new(*x, *y, *z))),
        nine if nine.len() == 9 => Some(Mat3::from_row_slice(nine)),
        other => return Err(Failure::usage(format!("--cell has {} numbers; it takes 3 or 9", other.len()))),
    };
    let contact_forces = match &args.contact_forces {
        Some(path) => {
            let text = std::fs::read_to_string(path);
            Some(text.map_err(|e| Failure::failed(format!("{}: {e}", path.display())))?)
        }
        None => None,
    };
    Ok(ImportOptions {
        cell,
        shear_modulus: args.shear_modulus,
        poisson_ratio: args.poisson,
        density: args.density,
        friction: args.friction,
        radius: args.radius,
        topic: Some(args.topic.clone()),
        contact_forces,
    })
}

fn settings(args: &Args) -> Result<micro::Settings, Failure> {
    let axis = <[f64; 3]>::try_from(args.axis.as_slice()).ok().map(Vec3::from);
    let axis = axis.filter(|v| v.norm() > 0.0 && v.norm().is_finite());
    let axis = axis.ok_or_else(|| Failure::usage("--axis takes three numbers that are not all zero"))?;
    if !(1e-13..=1e-2).contains(&args.tolerance) {
        return Err(Failure::usage(format!("--tolerance {} is out of range: 1e-13 to 1e-2", args.tolerance)));
    }
    let amplitude = args.amplitude;
    in_range("amplitude", Some(amplitude), "a strain, more than 0 and at most 0.01", |a| {
        a > 0.0 && a <= 0.01
    })?;
    let probe = (args.method == Method::Probe).then(|| micro::Probe { amplitude, ..micro::Probe::default() });
    Ok(micro::Settings { axis, tolerance: args.tolerance, probe, ..micro::Settings::default() })
}

/// What reading one file came to.
struct Loading<'a> {
    path: &'a Path,
    packings: Vec<Imported>,
    complaints: Vec<String>,
    exit: Exit,
}

fn read<'a>(path: &'a Path, options: &ImportOptions) -> Loading<'a> {
    let lines = |warnings: &[recordings::Warning]| warnings.iter().map(ToString::to_string).collect();
    match load(path, options) {
        Ok(loaded) => {
            let exit = if loaded.warnings.is_empty() { Exit::Done } else { Exit::DataLoss };
            Loading { path, packings: loaded.packings, complaints: lines(&loaded.warnings), exit }
        }
        Err(error) => {
            let mut exit = match without_path(&error) {
                ImportError::Missing(_) | ImportError::Cell(_) => Exit::Usage,
                _ => Exit::Failure,
            };
            let mut complaints = Vec::new();
            // A recording that is cut off before its first packing has lost data; that is why there is none.
            if let Ok(recording) = Recording::open(path) {
                complaints = lines(&recording.warnings());
                exit = if complaints.is_empty() { exit } else { Exit::DataLoss };
            }
            complaints.push(error.to_string());
            Loading { path, packings: Vec::new(), complaints, exit }
        }
    }
}

fn without_path(error: &ImportError) -> &ImportError {
    match error {
        ImportError::In { source, .. } => without_path(source),
        other => other,
    }
}

fn measure(path: &Path, imported: &Imported, settings: &micro::Settings) -> Result<State, String> {
    let began = Instant::now();
    let packing = &imported.packing;
    let found = micro::analyse(packing, settings)
        .map_err(|e| format!("{}, step {}: {e}", path.display(), packing.step))?;
    let moduli = found.moduli.as_ref();
    let mut state = State::new(path.display().to_string(), packing, &found.fabric, moduli.ok());
    state.step = imported.step;
    state.seconds = Some(began.elapsed().as_secs_f64());
    state.warnings.clone_from(&imported.notes);
    state.warnings.extend(moduli.err().map(ToString::to_string));
    state.warnings.extend(found.probe.as_ref().and_then(one_sided));
    Ok(state)
}

/// What a probe says about a response that depends on the direction of the strain.
fn one_sided(probe: &micro::ProbeResult) -> Option<String> {
    let changed: u32 = probe.columns.iter().map(|c| c.opened + c.closed).sum();
    let worst = probe.columns.iter().filter_map(|c| c.forward_backward).fold(0.0, f64::max);
    (worst > ONE_SIDED).then(|| {
        format!(
            "the probe's forward and backward strain give stiffnesses that differ by {:.1} %, {changed} contacts opened \
             or closed: lower --amplitude",
            100.0 * worst
        )
    })
}
