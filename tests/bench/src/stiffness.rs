//! `grainlab_bench stiffness`: cost and error of all 21 elastic constants of a packing.

use crate::cpu_time::timed;
use crate::numbers::between;
use crate::output::Output;
use crate::packing::{copies, load, replicated};
use crate::row::{Family, Row};
use grainlab_console::{Failure, say};
use grainlab_core::results::NoStiffness;
use grainlab_core::{Packing, Stiffness};
use grainlab_micromechanics::PackingView;
use grainlab_micromechanics::network::{
    SpringNetwork, Springs, relaxed_stiffness, uniform_rotation_stiffness,
};
use grainlab_micromechanics::probe::{StrainProbe, strain_probe};
use grainlab_node_kit::Exit;
use std::path::PathBuf;

const EXAMPLES: &str = "\
The default packing has 2,000 grains and was made by LAMMPS. Methods: affine (every grain moves with the strain), mean_spin
(the same with a uniform spin of all grains), cg (conjugate gradients on the frozen network, by residual), probe
(the packing is strained with the whole contact law, by strain). Copies of a packing converge faster than a packing of that size; they count as other methods, and exponents of the time never mix the two. Contacts
under the probe neither slide nor scale their tangential force: the network is its linear limit, except for terms of the order
of the pressure and for the motion while the packing first comes to rest.

Examples:
  Every method on 2,000 grains, with a plot (some seconds):
    cargo run --release -p grainlab_bench -- stiffness --amplitudes 1e-4,1e-5,1e-6,1e-7,1e-8 --out stiffness
  Growth of the cost over several packings and over copies of the first (minutes):
    cargo run --release -p grainlab_bench -- stiffness --packing a --packing b --packing c --grains 16000,54000,128000 --out stiffness
  A frictionless packing near isostaticity, where many iterations are needed:
    cargo run --release -p grainlab_bench -- stiffness --packing recordings/runs/frictionless-1-1 --frictionless";

/// Residual of the reference solve: the smallest that a solve accepts.
const CONVERGED: f64 = 1e-13;

/// Largest number of grains for probes.
const PROBED: usize = 4000;

/// The packings to measure.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Packing to measure: CSV with its sidecar, LAMMPS data or dump, or a recording; also as .gz. May be
    /// repeated
    #[arg(long, value_name = "FILE")]
    packing: Vec<PathBuf>,
    /// Sizes of copies of the first packing: its number of grains times cubes
    #[arg(long, value_name = "N", value_delimiter = ',')]
    grains: Vec<u64>,
    #[command(flatten)]
    methods: Methods,
    #[command(flatten)]
    output: Output,
}

/// Methods and values to measure.
#[derive(Debug, clap::Args)]
pub(crate) struct Methods {
    /// Relative residuals at which the iterations stop
    #[arg(long, value_name = "REL", value_delimiter = ',', default_value = "1e-2,1e-4,1e-6,1e-8,1e-10,1e-12", value_parser = |text: &str| between(text, CONVERGED, 1e-2))]
    pub(crate) tolerances: Vec<f64>,
    /// Strains of explicit probes, which take far longer: of packings of at most 4,000 grains
    #[arg(long, value_name = "STRAIN", value_delimiter = ',', value_parser = |text: &str| between(text, 1e-12, 1e-2))]
    pub(crate) amplitudes: Vec<f64>,
    /// Contacts without tangential springs, as in a packing prepared without friction
    #[arg(long)]
    pub(crate) frictionless: bool,
    /// Repetitions of every case except probes
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) repetitions: u32,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let paths = args.packing.iter().map(|path| load(Some(path)));
    let mut packings = paths.collect::<Result<Vec<_>, _>>()?;
    if packings.is_empty() {
        packings.push(load(None)?);
    }
    let sizes = if args.grains.is_empty() { Vec::new() } else { copies(packings[0].grains(), &args.grains)? };
    args.output.ready()?;
    let mut found = Vec::new();
    for packing in &packings {
        found.extend(rows(packing, "", &args.methods)?);
    }
    for copies in sizes.into_iter().filter(|copies| *copies > 1) {
        found.extend(rows(&replicated(&packings[0], copies)?, ", copies", &args.methods)?);
    }
    args.output.finish("stiffness", found)
}

/// A stiffness, Pa, and the number of iterations of the solve or steps of the probe.
type Found = Result<(Stiffness, Option<u32>), String>;

/// Rows of one packing, in the order of increasing time. `kind` is added to the names of the methods.
pub(crate) fn rows(packing: &Packing, kind: &str, methods: &Methods) -> Result<Vec<Row>, Failure> {
    say!("grainlab: {} grains, {} contacts", packing.grains(), packing.contacts.len());
    let springs = if methods.frictionless { Springs::Normal } else { Springs::NormalAndTangential };
    let view = PackingView::new(packing).map_err(|e| Failure::new(Exit::PhysicsInvalid, e))?;
    let bench = Bench { view, springs };
    let solved = bench.solved(CONVERGED).map_err(|why| Failure::new(Exit::PhysicsInvalid, why))?;
    let (converged, against) = (solved.0, "frozen network by cg at 1e-13");
    let row = |method: &str, value: Option<f64>, repetitions: u32, work: &dyn Fn() -> Found| {
        let (seconds, found) = timed(repetitions, work)?;
        let (found, failure) = found.map_or_else(|why| (None, Some(why)), |found| (Some(found), None));
        let error = found.map(|f| (f.0.0 - converged.0).amax() / converged.0[(0, 0)]);
        let names = (format!("{method}{kind}"), value.map_or_else(String::new, |v| format!("{v:e}")));
        let mut row = Row::new(Family::Stiffness, names, (seconds, repetitions as usize), (error, against));
        row.details.insert("coordination", 2.0 * packing.contacts.len() as f64 / packing.grains() as f64);
        row.details.extend(found.and_then(|f| f.1).map(|n| ("iterations", f64::from(n))));
        Ok::<_, Failure>(Row { grains: Some(packing.grains()), failure, ..row })
    };
    let many = methods.repetitions;
    let mut rows = vec![row("affine", None, many, &|| bench.affine())?];
    rows.push(row("mean_spin", None, many, &|| bench.mean_spin())?);
    for tolerance in &methods.tolerances {
        rows.push(row("cg", Some(*tolerance), many, &|| bench.solved(*tolerance))?);
    }
    if packing.grains() <= PROBED {
        for amplitude in &methods.amplitudes {
            rows.push(row("probe", Some(*amplitude), 1, &|| bench.probed(*amplitude))?);
        }
    }
    Ok(rows)
}

struct Bench<'a> {
    view: PackingView<'a>,
    springs: Springs,
}

impl Bench<'_> {
    fn network(&self) -> Result<SpringNetwork, String> {
        SpringNetwork::new(&self.view, self.springs).map_err(|e| e.to_string())
    }

    fn affine(&self) -> Found {
        Ok((self.network()?.affine_stiffness(), None))
    }

    fn mean_spin(&self) -> Found {
        let network = self.network()?;
        Ok((uniform_rotation_stiffness(&network, &network.affine_stiffness()), None))
    }

    fn solved(&self, tolerance: f64) -> Found {
        let most = grainlab_micromechanics::Settings::default().max_iterations;
        let network = self.network()?;
        let found = relaxed_stiffness(&network, tolerance, most).map_err(|e| e.to_string())?;
        let found = found.ok_or_else(|| NoStiffness::Floppy { contacts: network.contacts() }.to_string())?;
        Ok((found.relaxed, Some(found.iterations)))
    }

    fn probed(&self, amplitude: f64) -> Found {
        let friction = Some(if self.springs == Springs::Normal { 0.0 } else { f64::INFINITY });
        let settings = StrainProbe { amplitude, friction, ..StrainProbe::default() };
        let found = strain_probe(self.view.packing, &settings).map_err(|e| e.to_string())?;
        Ok((found.stiffness, Some(found.steps())))
    }
}
