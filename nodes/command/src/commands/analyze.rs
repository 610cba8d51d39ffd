//! `grainlab analyze`: measures packings from files, without DDS.
//!
//! - [`measure`]: one packing; files are read by [`super::packings`]

mod measure;

use super::packings::files;
use super::packings::import::{self, in_range};
use grainlab_console::{Failure, print};
use grainlab_core::Vec3;
use grainlab_core::results::QUANTITIES;
use grainlab_micromechanics::TOLERANCES;
use grainlab_micromechanics::network::Springs;
use grainlab_micromechanics::probe::StrainProbe;
use grainlab_msgs::topics;
use grainlab_node_kit::Exit;
use grainlab_recordings::import::yade;
use grainlab_results::quantities::help;
pub(crate) use measure::measure;

const EXAMPLES: &str = "\
Examples:
  Every packing of a recorded run, or of all runs:
    grainlab analyze recordings/runs/demo-1-1
    grainlab analyze recordings/runs/* --format csv > all.csv
  A LAMMPS dump (id type x y z radius ...), with the properties that the file lacks:
    grainlab analyze settle.dump --shear-modulus 29e9 --poisson 0.2 --density 2500 --friction 0.3 --format json
  A packing in YADE, with contact forces (run the script within YADE; its first lines explain how):
    grainlab analyze --yade-script > grainlab_export.py
    grainlab analyze packing.csv
  A recording of the messages that the analyzer node would publish:
    grainlab analyze recordings/runs/demo-1-1 --record measured
  The stiffness by straining the packing, which includes the nonlinear response:
    grainlab analyze recordings/runs/demo-1-1 --method probe";

/// Files to measure, and data that they lack. A flag takes precedence over a file and its sidecar.
#[derive(Debug, clap::Args)]
#[command(
    after_help = format!("{EXAMPLES}\n\n{}", import::FORMATS),
    after_long_help = format!("{EXAMPLES}\n\n{}\n\nQuantities, as keys of JSON and columns of CSV:\n{}", import::FORMATS, help(QUANTITIES)),
    allow_negative_numbers = true
)]
pub(crate) struct Args {
    #[command(flatten)]
    packings: files::Args,
    /// Print a script for YADE that exports a packing with its contacts and forces
    #[arg(long, exclusive = true)]
    yade_script: bool,
    /// Axis of eps, of the ratios gamma/Delta, of G12, G13 and the ti_ moduli; the 36 entries of a stiffness stay in the
    /// frame of the cell
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', num_args = 1, default_value = "0,0,1")]
    axis: Vec<f64>,
    /// Relative residual at which the stiffness solve stops [default: 1e-9; 1e-5 from 50,000 grains]; the error that it leaves is stated
    #[arg(long, value_name = "REL")]
    tolerance: Option<f64>,
    /// Method of the stiffness
    #[arg(long, value_enum, default_value_t)]
    method: Method,
    /// Springs of the contacts
    #[arg(long, value_enum, default_value_t)]
    springs: ContactSprings,
    /// Short for --springs normal: the response of grains without friction
    #[arg(long, conflicts_with = "springs")]
    smooth: bool,
    /// Strain of --method probe, forward and backward; far below overlap/diameter [default: 1e-7]
    #[arg(long, value_name = "STRAIN")]
    amplitude: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
enum Method {
    /// Linear response of the frozen contact network
    #[default]
    Network,
    /// Linear response of smooth grains, with the prestress term: normal forces rotate with their branches. The stiffness is that of
    /// the Cauchy stress, as --method probe measures it, made symmetric, which matters under a deviatoric stress
    Prestressed,
    /// Explicit: strain the packing slightly, relax it, evaluate the stress
    Probe,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
enum ContactSprings {
    /// Those that the contacts carry: no tangential ones in a packing without friction
    #[default]
    Carried,
    /// Normal and tangential ones, whatever the friction
    Both,
    /// Normal ones alone
    Normal,
}

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    if args.yade_script {
        print(yade::EXPORTER)?;
        return Ok(Exit::Done);
    }
    let settings = settings(args)?;
    args.without_effect()?;
    let measure = |source: &str, imported: &_| measure(&settings, source, imported);
    args.packings.measured("analyze", &[topics::PACKING_REPORT], measure)
}

impl Args {
    /// Refuses flags that would change nothing.
    fn without_effect(&self) -> Result<(), Failure> {
        let probed = self.method == Method::Probe;
        for (flag, given, needs) in [
            ("--amplitude", self.amplitude.is_some() && !probed, "--method probe"),
            ("--tolerance", self.tolerance.is_some() && probed, "another --method"),
        ] {
            if given {
                return Err(Failure::usage(format!("{flag} has no effect without {needs}")));
            }
        }
        Ok(())
    }
}

fn settings(args: &Args) -> Result<grainlab_micromechanics::Settings, Failure> {
    let axis = <[f64; 3]>::try_from(args.axis.as_slice()).ok().map(Vec3::from);
    let axis = axis.map(|v| v / v.amax()).filter(|v| v.norm().is_finite());
    let axis = axis.ok_or_else(|| Failure::usage("--axis takes three finite numbers, not all of them 0"))?;
    let settings = grainlab_micromechanics::Settings::default();
    in_range("tolerance", args.tolerance, "from 1e-13 to 1e-5", |t| TOLERANCES.contains(&t))?;
    let amplitude = args.amplitude.unwrap_or(StrainProbe::default().amplitude);
    in_range("amplitude", Some(amplitude), "a strain, more than 0 and at most 0.01", |a| {
        a > 0.0 && a <= 0.01
    })?;
    let springs = match (args.method, args.springs) {
        (Method::Prestressed, ContactSprings::Both) => {
            let message =
                "--method prestressed is of smooth grains, and --springs both adds tangential springs";
            return Err(Failure::usage(message));
        }
        (Method::Prestressed, _) => Springs::PrestressedNormal,
        _ if args.smooth => Springs::Normal,
        (_, ContactSprings::Carried) => Springs::Carried,
        (_, ContactSprings::Both) => Springs::NormalAndTangential,
        (_, ContactSprings::Normal) => Springs::Normal,
    };
    let probe =
        (args.method == Method::Probe).then(|| StrainProbe { amplitude, ..measure::explicit(springs) });
    Ok(grainlab_micromechanics::Settings { axis, tolerance: args.tolerance, springs, probe, ..settings })
}
