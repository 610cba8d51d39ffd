//! Flags of `grainlab invert`, and the state that they give.

use super::calibrations;
use super::case;
use super::contact::Contact;
use super::evidence;
use super::inputs;
use super::speed_table::SpeedLine;
use super::speeds;
use super::state::State;
use crate::commands::packings::import::in_range;
use grainlab_console::{Failure, Format};
use grainlab_emt::{Conditions, Measured, Modulus, Probe};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  The first state of the paper's Table III (k = 5.73, k_hat = 5.63, eps = 0.016), with 1 % error on each modulus:
    grainlab invert --g12 121.7e6 --g13 127.4e6 --theta 144.4e6 --pressure 50e3 --gamma-over-delta -0.0623 --error 0.01
  Wave speeds of a laboratory over pressure, of grains whose contacts are not known:
    printf 'pressure_pa,mode,speed,speed_sigma\n1e5,p,420,4\n1e5,s,255,3\n1e6,p,740,7\n1e6,s,455,5\n4e6,p,,\n' |
      grainlab invert --speeds - --density 1640 --grain-shear-modulus 44e9 --poisson 0.08 --plot series.html
  The same of smooth spheres, at one pressure, by angle to the axis in degrees and mode:
    printf 'angle_deg,mode,speed,speed_sigma\n0,p,439,4\n90,p,426,4\n45,p,430,4\n0,sv,268,3\n90,sh,265,3\n' |
      grainlab invert --speeds - --contact hertz --density 1498 --pressure 50e3 --stress-ratio 0 --size-spread 0
  Prior knowledge, and draws that ArviZ, corner and pandas read:
    grainlab invert --print-prior > prior.toml
    grainlab invert --g12 104.2e6 --g13 112.4e6 --theta 136e6 --pressure 50e3 --stress-ratio 0 --size-spread 0 --error 0.01 \\
      --probe sticking --model relaxed --prior prior.toml --draws draws.json
  Probabilities of models that state an error of the same moduli:
    grainlab invert --g12 104.2e6 --g13 112.4e6 --theta 136e6 --pressure 50e3 --error 0.01 --probe sticking --calibration grainlab --evidence
  Many states, or the output of an analysis:
    grainlab invert --table states.csv --format csv
    grainlab analyze recordings/runs/* --format csv | grainlab invert --table - --gamma contact --format csv
  Errors of the models on packings with counted structure:
    grainlab invert --table tests/golden/ensembles/held_out.csv --judge --calibration grainlab --gamma all --by mu2

A table has a header line and one state per line, of cells between commas, tabs, or semicolons with decimal commas; lines that begin with # are
comments, empty cells are unknown. Other columns
are ignored, but one whose name is almost that of an input, or begins with it, is refused, unless it begins with _. The pressure and
at least one modulus are required; k, z and eps are for --judge:
  sample, or source and step         kept with the result
  c11_pa c12_pa ... c66_pa           all 36, or one half: a stiffness, projected on the medium isotropic about
  reference_axis_x _y _z             this axis, to which all other columns refer, too; default e3, the only one with single entries
{COLUMNS}An invalid row, or one without an estimate of a model, is reported with its line number and has the status unknown in the
results; the other rows are processed. The exit code is that of the worst row.

A file of --speeds has a row per speed: speed (m/s; empty: predicted), speed_sigma, pressure_pa, density (kg/m3) or grain_density and
phi, mode (p, s, sv, sh) with direction (along, across or degrees from the axis) or angle_deg, or direction_x to _z and
polarization_x to _z; and, if known, sample, diameter (m), roughness (root mean square, m), roughness_sigma, frequency (Hz), pressure_sigma_pa,
density_sigma and speed_shared_sigma (m/s, an error that all rows of a mode and direction share, as of the distance; speed_sigma is then the rest).
p_pa, p_kpa, pressure_kpa and density_g_cm3 may replace pressure_pa and density; along is the axis of the sample, vertical in most. Rows of one sample share its contacts and its preparation; all samples of a file are of the grains of
--grain-shear-modulus and --poisson, and under isotropic stress. The sigmas of pressure and density are those of a factor that all rows share, as of a scale;
an offset of all pressures looks like another contact law: shift the pressures to see its effect.
Unknown columns are refused. With --contact hertz, a file without pressure_pa is given to the models of smooth spheres.

A --plan has pressures (Pa) and error (of each speed, relative), [[speeds]] with mode, and angles in degrees to the axis if they are known
(each with its own pressures and error, if they differ), and, if wanted, diameter and roughness (m), further_pressures at which one more
speed could be measured, and [want] with a sigma of z, eps, eps_stiffness, stiffness_ratio or level. Samples are drawn from the prior:
    error = 0.01
    pressures = [1e5, 4e5]
    speeds = [{mode = \"p\", angles = [0, 90]}, {mode = \"s\", angles = [0], error = 0.02}]
    want = {z = 0.2}

The status of other answers is ok, extrapolated (outside the range of the model, or not all of its unknowns; of a sample at several pressures,
each row of CSV has the status of its pressure), contradictory (the data contradict each other or the model, or z changes by more than two of its
errors without a row that the others contradict) or unknown (no answer, or one that no packing of spheres has); the column reason has the notes
of an estimate. The exit code is 4 where the recommended answer is contradictory or unknown, or a model refuses the moduli, and 2 where an
input is missing or invalid.";

/// The data to invert. All quantities in SI units.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES.replace("{COLUMNS}", &inputs::reference()), allow_negative_numbers = true)]
pub(crate) struct Args {
    /// Shear modulus in the plane of isotropy, Pa
    #[arg(long, value_name = "PA", conflicts_with = "table")]
    pub(super) g12: Option<f64>,
    /// Shear modulus along the axis, Pa
    #[arg(long, value_name = "PA", conflicts_with = "table")]
    pub(super) g13: Option<f64>,
    /// Bulk modulus C_iijj/9 (Voigt), Pa
    #[arg(long, value_name = "PA", conflicts_with = "table")]
    pub(super) theta: Option<f64>,
    /// Confining pressure, Pa, positive in compression
    #[arg(long, value_name = "PA", required_unless_present_any = ["table", "print_prior", "speeds", "plan"], conflicts_with = "table")]
    pub(super) pressure: Option<f64>,
    /// Standard deviation of the pressure, Pa
    #[arg(long, value_name = "PA", requires = "pressure", default_value_t = 0.0)]
    pub(super) pressure_sigma: f64,
    /// Ratio of deviatoric to volumetric strain about the axis [default: unknown, taken as 0]
    #[arg(long, value_name = "G", conflicts_with = "table")]
    pub(super) gamma_over_delta: Option<f64>,
    /// Longitudinal modulus across the axis, Pa
    #[arg(long, value_name = "PA", conflicts_with = "table")]
    pub(super) c11: Option<f64>,
    /// Longitudinal modulus along the axis, Pa
    #[arg(long, value_name = "PA", conflicts_with = "table")]
    pub(super) c33: Option<f64>,
    /// Off-diagonal modulus C13, Pa; may be negative
    #[arg(long, value_name = "PA", conflicts_with = "table")]
    pub(super) c13: Option<f64>,
    /// Shear modulus of the grains, Pa [default: that of the calibration]
    #[arg(long, value_name = "PA")]
    pub(super) grain_shear_modulus: Option<f64>,
    /// Standard deviation of the shear modulus of the grains, Pa
    #[arg(long, value_name = "PA", default_value_t = 0.0)]
    pub(super) grain_shear_modulus_sigma: f64,
    /// Poisson ratio of the grains [default: that of the calibration]
    #[arg(long, value_name = "NU")]
    pub(super) poisson: Option<f64>,
    /// Standard deviation of the Poisson ratio of the grains
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0)]
    pub(super) poisson_sigma: f64,
    /// Wave speeds from a CSV file instead of moduli, one per row, at one pressure or many, as described below; - is the
    /// standard input
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["table", "g12", "g13", "theta", "c11", "c33", "c13"])]
    pub(super) speeds: Option<PathBuf>,
    /// Expected errors of z, eps and contacts by speeds that are planned, as described below, the speed that would help most, and the
    /// errors that are wanted; takes a minute or more
    #[arg(long, value_name = "PLAN.toml", conflicts_with_all = ["table", "speeds", "g12", "g13", "theta", "c11", "c33", "c13", "pressure"])]
    pub(super) plan: Option<PathBuf>,
    /// Contact law of the grains: free for --speeds, hertz for moduli [default: these]
    #[arg(long, value_enum, value_name = "LAW")]
    pub(super) contact: Option<Contact>,
    /// Density of the mass that moves with the waves, kg/m3
    #[arg(long, value_name = "RHO", requires = "speeds")]
    pub(super) density: Option<f64>,
    /// Standard deviation of the density, kg/m3
    #[arg(long, value_name = "SIGMA", default_value_t = 0.0)]
    pub(super) density_sigma: f64,
    /// Solid fraction of the sample; emt and hertz-mindlin use it
    #[arg(long, value_name = "PHI", conflicts_with = "table")]
    pub(super) phi: Option<f64>,
    /// Axial stress less the lateral one over pressure [default: unknown: 0 +- 0.15, cut at +- 0.3, in relaxed; isotropic in
    /// the other models]
    #[arg(long, value_name = "Q/P", conflicts_with = "table", allow_hyphen_values = true)]
    pub(super) stress_ratio: Option<f64>,
    /// Standard deviation of the stress ratio
    #[arg(long, value_name = "SIGMA", requires = "stress_ratio", default_value_t = 0.0)]
    pub(super) stress_ratio_sigma: f64,
    /// Standard deviation of the radii over their mean [default: unknown: any from 0 to 0.3 in relaxed; equal grains in
    /// the other models]
    #[arg(long, value_name = "SPREAD", conflicts_with = "table")]
    pub(super) size_spread: Option<f64>,
    /// Number of grains of the sample [default: unknown, any from 100 to 20,000 in the errors of relaxed]
    #[arg(long, value_name = "N", conflicts_with = "table", value_parser = clap::value_parser!(u32).range(1..))]
    pub(super) grains: Option<u32>,
    /// Whether contacts slid while the moduli were measured: sticking if none did, as in a small strain at high friction; unknown
    /// widens z, k and eps of relaxed and free-contact [default: unknown; sticking for speeds, and for tables of grainlab analyze, which have
    /// ti_c11_pa and eps_stiffness, but for its method probe]
    #[arg(long, value_name = "PROBE", conflicts_with_all = ["speeds", "plan"])]
    pub(super) probe: Option<Probe>,
    /// Relative one-sigma error of each modulus without its own error, and of each speed without speed_sigma: 0.01 is one percent
    /// [default: unknown; 0.01 for speeds whose contacts are not known]
    #[arg(long, value_name = "REL")]
    pub(super) error: Option<f64>,
    /// States from a CSV file, as described below; - is the standard input
    #[arg(long, value_name = "FILE.csv")]
    pub(super) table: Option<PathBuf>,
    /// The gamma/Delta of a table for the models that use one: that of its column gamma_over_delta, of g_total, g_elastic or
    /// g_contact, 0, or each but the first [default: given, else total, else contact, else zero]
    #[arg(long, value_name = "WHICH", value_parser = case::GAMMAS, requires = "table")]
    pub(super) gamma: Option<String>,
    /// Only these models, comma-separated [default: all but free-contact]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub(super) model: Vec<String>,
    /// Source of the constants of the models: a name, a file, or several; default is the paper's for the
    /// paper's models, grainlab for the others
    #[arg(long, value_name = "NAME|FILE.toml", value_delimiter = ',', default_value = calibrations::DEFAULT)]
    pub(super) calibration: Vec<String>,
    /// Compare the estimates with the truth in the columns k, z, eps and eps_stiffness of the table, for each
    /// model and gamma/Delta: bias, scatter, rms error, and the fraction of the 95 % intervals that contain
    /// the truth. A row without an estimate is counted there, and is no error
    #[arg(long, requires = "table")]
    pub(super) judge: bool,
    /// Group the rows with the same cells in these columns; numbers that are not whole are equal if they
    /// agree to three digits
    #[arg(long, value_name = "COLUMN", value_delimiter = ',', requires = "judge")]
    pub(super) by: Vec<String>,
    /// Plot the contact anisotropy inferred by each model against that of the table (--judge), into this file (SVG); or a page of
    /// a series of --speeds (HTML)
    #[cfg(feature = "studio")]
    #[arg(long, value_name = "FILE")]
    pub(super) plot: Option<PathBuf>,
    /// Priors of k, k_hat, z, eps and eps_stiffness, or of some of them, in the form of --print-prior; a quantity without one has
    /// that of --print-prior. For --speeds with another contact than hertz that of --print-prior --contact free
    #[arg(long, value_name = "FILE.toml")]
    pub(super) prior: Option<PathBuf>,
    /// Print the prior of a model (default: relaxed) as a file for --prior, and do nothing else
    #[arg(long, conflicts_with_all = ["table", "draws", "evidence", "explain"])]
    pub(super) print_prior: bool,
    /// Write independent draws from the posterior of one model: .csv, or .json for ArviZ (0.x: arviz.from_json(FILE);
    /// 1: grainlab.to_arviz(json.load(open(FILE))), by grainlab's Python package); with ln likelihood (of each modulus given the others),
    /// ln prior, predicted and observed moduli
    #[arg(long, value_name = "FILE", conflicts_with = "table")]
    pub(super) draws: Option<PathBuf>,
    /// Number of draws of each chain
    #[arg(long, value_name = "N", requires = "draws", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(4..=1_000_000))]
    pub(super) draws_per_chain: u32,
    /// Number of chains: parts of the draws, all independent
    #[arg(long, value_name = "N", requires = "draws", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(super) chains: u32,
    /// Print the marginal likelihood of each model that states an error of the moduli, and the probability of each among those
    /// of the same moduli
    #[arg(long, conflicts_with = "table")]
    pub(super) evidence: bool,
    /// Prior odds of models [default: 1 each]
    #[arg(long, value_name = "MODEL=ODDS", value_delimiter = ',', requires = "evidence")]
    pub(super) prior_odds: Vec<evidence::Odds>,
    /// Seed of draws: the same one gives the same numbers
    #[arg(long, value_name = "SEED", conflicts_with = "table", default_value_t = 0)]
    pub(super) seed: u64,
    /// Print the contribution of each datum to the uncertainty of each unknown, the parts of the uncertainty due to the data and
    /// to the model, and the probability of the moduli under the posterior of each model that states one
    #[arg(long, conflicts_with = "table")]
    pub(super) explain: bool,
    /// Print every model, not the recommended one alone; so do several --model
    #[arg(long, conflicts_with = "table")]
    pub(super) verbose: bool,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub(super) format: Format,
}

/// Refuses the flags that are given.
pub(super) fn refuse(flags: &[(&str, bool)], why: &str) -> Result<(), Failure> {
    match flags.iter().find(|(_, given)| *given) {
        Some((flag, _)) => Err(Failure::usage(format!("{flag} {why}"))),
        None => Ok(()),
    }
}

impl Args {
    /// The names of the models: for a prior, the recommended one.
    pub(super) fn models(&self) -> Vec<String> {
        let of_prior = self.print_prior && self.model.is_empty();
        if of_prior { vec!["relaxed".to_owned()] } else { self.model.clone() }
    }

    pub(super) fn defaults(&self) -> Result<State, Failure> {
        let positive = |v: f64| v > 0.0 && v.is_finite();
        in_range("grain-shear-modulus", self.grain_shear_modulus, "more than 0 and finite", positive)?;
        in_range("poisson", self.poisson, "0 to 0.5", |v| (0.0..=0.5).contains(&v))?;
        in_range("error", self.error, "0 to 1", |v| (0.0..=1.0).contains(&v))?;
        for (flag, stddev) in [
            ("pressure-sigma", self.pressure_sigma),
            ("grain-shear-modulus-sigma", self.grain_shear_modulus_sigma),
            ("poisson-sigma", self.poisson_sigma),
            ("stress-ratio-sigma", self.stress_ratio_sigma),
            ("density-sigma", self.density_sigma),
        ] {
            in_range(flag, Some(stddev), "0 or more and finite", |v| v >= 0.0 && v.is_finite())?;
        }
        in_range("poisson-sigma", Some(self.poisson_sigma), "at most 0.5", |v| v <= 0.5)?;
        let has_density = self.density.is_some() || self.density_sigma != 0.0;
        if self.speeds.is_none() && self.table.is_none() && has_density {
            return Err(Failure::usage("--density has no effect without --speeds: moduli are given in Pa"));
        }
        Ok(State {
            relative_error: self.error,
            probe: self.probe,
            grain_shear_modulus: self.grain_shear_modulus,
            poisson: self.poisson,
            conditions: Conditions {
                shear_modulus_stddev: self.grain_shear_modulus_sigma,
                poisson_ratio_stddev: self.poisson_sigma,
                contact_law: self
                    .contact
                    .filter(|c| *c == Contact::Hertz)
                    .and_then(|_| "hertz_mindlin".parse().ok()),
                ..Conditions::default()
            },
            ..State::default()
        })
    }

    pub(super) fn state(
        &self,
        mut state: State,
        speeds: Option<(String, Vec<SpeedLine>)>,
    ) -> Result<State, Failure> {
        let pressure = self.pressure.ok_or_else(|| Failure::usage("--pressure is needed, or --table"))?;
        state.conditions.pressure = Measured { value: pressure, stddev: self.pressure_sigma };
        let given = [self.g12, self.g13, self.theta, self.c11, self.c33, self.c13];
        for (modulus, value) in Modulus::ALL.into_iter().zip(given) {
            value.into_iter().for_each(|value| state.set_modulus(modulus, value));
        }
        state.gamma = self.gamma_over_delta.map(Measured::exact);
        state.conditions.solid_fraction = self.phi.map(Measured::exact);
        state.conditions.stress_ratio =
            self.stress_ratio.map(|value| Measured { value, stddev: self.stress_ratio_sigma });
        state.conditions.size_spread = self.size_spread;
        state.grains = self.grains.map(f64::from);
        if let Some((name, lines)) = speeds {
            self.refuse_flags_in_columns(&lines)?;
            speeds::add(&mut state, &name, &lines, (self.density, self.density_sigma))?;
        }
        Ok(state)
    }

    /// Refuses the pressure and the density of the flags where every row has its own.
    pub(super) fn refuse_flags_in_columns(&self, lines: &[SpeedLine]) -> Result<(), Failure> {
        let has_pressure = lines.iter().all(|l| l.pressure_pa.is_some());
        let has_density = lines.iter().all(|l| l.density().is_some());
        let in_columns = [
            ("--pressure", has_pressure && self.pressure.is_some()),
            ("--density", has_density && self.density.is_some()),
        ];
        refuse(&in_columns, "is in a column of every row")
    }

    /// Refuses flags that samples whose contacts are not known do not use.
    pub(super) fn check_series(&self) -> Result<(), Failure> {
        self.defaults()?;
        let of_models = [
            ("--model", !self.model.is_empty()),
            ("--gamma-over-delta", self.gamma_over_delta.is_some()),
            ("--stress-ratio", self.stress_ratio.is_some_and(|q| q != 0.0)),
            ("--draws", self.draws.is_some()),
            ("--evidence", self.evidence),
            ("--explain", self.explain),
            ("--judge", self.judge),
            ("--gamma", self.gamma.is_some()),
            ("--seed", self.seed != 0),
            ("--poisson-sigma", self.poisson_sigma != 0.0),
            ("--calibration", self.calibration != [calibrations::DEFAULT]),
        ];
        refuse(
            &of_models,
            "is for smooth spheres at one pressure: give --contact hertz, and no column pressure_pa",
        )?;
        refuse(&[("--phi", self.phi.is_some())], "is a column of --speeds")
    }
}
