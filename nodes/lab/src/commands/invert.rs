//! `grainlab invert`: moduli in, microstructure out.

mod inputs;
mod table;

use crate::failure::{Failure, worse};
use crate::output::{Format, Table, exact, json, print};
use crate::results::inference::{self, Inference};
use emt::{Calibration, EmtError, Model};
use inputs::Inputs;
use node_kit::Exit;
use serde::Serialize;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  The first state of the paper's Table III (k = 5.73, k_hat = 5.63, eps = 0.016), with 1 % error on each modulus:
    grainlab invert --g12 121.7e6 --g13 127.4e6 --theta 144.4e6 --pressure 50e3 --gamma-over-delta -0.0623 --error 0.01
  Many states at once:
    grainlab invert --table states.csv --format csv";

/// What to invert. All quantities in SI units.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub(crate) struct Args {
    /// Shear modulus in the plane of isotropy, Pa
    #[arg(long, value_name = "PA", required_unless_present = "table", conflicts_with = "table")]
    g12: Option<f64>,
    /// Shear modulus along the axis, Pa
    #[arg(long, value_name = "PA", required_unless_present = "table", conflicts_with = "table")]
    g13: Option<f64>,
    /// Bulk modulus C_iijj/9 (Voigt), Pa
    #[arg(long, value_name = "PA", required_unless_present = "table", conflicts_with = "table")]
    theta: Option<f64>,
    /// Confining pressure, Pa, positive in compression
    #[arg(long, value_name = "PA", required_unless_present = "table", conflicts_with = "table")]
    pressure: Option<f64>,
    /// Ratio of deviatoric to volumetric strain about the axis [default: unknown, taken as 0]
    #[arg(long, value_name = "G", conflicts_with = "table")]
    gamma_over_delta: Option<f64>,
    /// Longitudinal modulus across the axis, Pa: checks the others, with --c33
    #[arg(long, value_name = "PA", requires = "c33", conflicts_with = "table")]
    c11: Option<f64>,
    /// Longitudinal modulus along the axis, Pa: checks the others, with --c11
    #[arg(long, value_name = "PA", requires = "c11", conflicts_with = "table")]
    c33: Option<f64>,
    /// Shear modulus of the grains, Pa: warns where the calibration is for others
    #[arg(long, value_name = "PA")]
    grain_shear_modulus: Option<f64>,
    /// Poisson ratio of the grains: warns where the calibration is for others
    #[arg(long, value_name = "NU")]
    poisson: Option<f64>,
    /// Solid fraction, kept with the result (the paper's models do not use it)
    #[arg(long, value_name = "PHI", conflicts_with = "table")]
    phi: Option<f64>,
    /// Relative one-sigma error of each of G12, G13 and Theta: 0.01 is one percent [default: unknown]
    #[arg(long, value_name = "REL")]
    error: Option<f64>,
    /// States from a CSV file with columns p_kpa, g12_pa, g13_pa, theta_pa, and optionally sample, gamma_over_delta and
    /// theta_printed_pa (which the model ratio-as-printed then takes for theta); other columns are ignored
    #[arg(long, value_name = "FILE.csv")]
    table: Option<PathBuf>,
    /// One model alone [default: all of them]
    #[arg(long, value_name = "NAME")]
    model: Option<String>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// One state and what the models say of it.
#[derive(Debug, Serialize)]
struct Inverted {
    inputs: Inputs,
    results: Vec<Inference>,
    #[serde(skip)]
    exit: Exit,
}

/// Runs the command.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let models = models(args.model.as_deref())?;
    let states = match &args.table {
        Some(path) => table::read(path, args)?,
        None => vec![Inputs::of_args(args)?],
    };
    let inverted: Vec<Inverted> = states.into_iter().map(|inputs| invert(inputs, &models)).collect();
    let text = match args.format {
        Format::Json if args.table.is_none() => json(&inverted[0])?,
        Format::Json => json(&inverted)?,
        Format::Csv => csv(&inverted),
        Format::Table => people(&inverted),
    };
    print(&text)?;
    Ok(inverted.iter().fold(Exit::Done, |exit, i| worse(exit, i.exit)))
}

fn models(name: Option<&str>) -> Result<Vec<&'static dyn Model>, Failure> {
    let Some(name) = name else { return Ok(emt::models().to_vec()) };
    let known = || emt::models().iter().map(|m| m.name()).collect::<Vec<_>>().join(", ");
    let model = emt::model(name);
    model.map(|m| vec![m]).ok_or_else(|| Failure::usage(format!("no model {name:?}; there are: {}", known())))
}

fn invert(inputs: Inputs, models: &[&'static dyn Model]) -> Inverted {
    let calibration = Calibration::PAPER;
    let mut exit = Exit::Done;
    let results = models.iter().map(|model| {
        let outcome = model.infer(&inputs.observation(model.name()), &calibration);
        if let Err(error) = &outcome {
            exit = worse(exit, exit_of(error));
            crate::output::say!("grainlab: {}: {error}", model.name());
        }
        let mut result = Inference::of(model.name(), calibration.name(), &outcome);
        result.warnings.extend(inputs.warnings());
        result
    });
    let results = results.collect();
    Inverted { inputs, results, exit }
}

/// Numbers that are no moduli are wrong usage; moduli that no packing has are invalid physics.
fn exit_of(error: &EmtError) -> Exit {
    if error.is_of_input() { Exit::Usage } else { Exit::PhysicsInvalid }
}

fn csv(inverted: &[Inverted]) -> String {
    let mut t = Table::new(["sample", "pressure_pa"].into_iter().chain(Inference::EXACT_COLUMNS));
    for i in inverted {
        for r in &i.results {
            let label = [i.inputs.sample.clone().unwrap_or_default(), exact(Some(i.inputs.pressure_pa))];
            t.row(label.into_iter().chain(r.exact_cells()));
        }
    }
    t.csv()
}

fn people(inverted: &[Inverted]) -> String {
    if let [only] = inverted {
        return inference::table(&only.results);
    }
    let mut t = Table::new(["sample", "p/kPa"].into_iter().chain(Inference::COLUMNS));
    let mut warnings = String::new();
    for i in inverted {
        let label =
            || [i.inputs.sample.clone().unwrap_or_default(), format!("{}", i.inputs.pressure_pa / 1e3)];
        i.results.iter().for_each(|r| t.row(label().into_iter().chain(r.cells())));
        let lines = inference::warning_lines(&i.results);
        if !lines.is_empty() {
            warnings += &format!("{} at {} kPa:\n{lines}", label()[0], label()[1]);
        }
    }
    t.text() + &warnings
}
