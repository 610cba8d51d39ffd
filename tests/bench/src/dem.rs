//! `grainlab_bench dem`: speed of the particle engine.

mod stepping;

use super::packing;
use clap::ValueEnum;
use grainlab_console::{Failure, Format, Table, exact, say, three_digits};
use grainlab_dem::Simd;
use grainlab_node_kit::Exit;
use grainlab_page::median;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use stepping::{Case, Features, Loop, pressure};

const EXAMPLES: &str = "\
A packing at rest is stepped with its own friction, contact law and forces, and damping 0.3; only the stepping is timed. The
default packing has 2,000 grains of friction 0.1 near 100 kPa, 2.55 contacts per grain, and was made by LAMMPS; its time step
is 3e-8 s, as is that of a packing that states none. Packings are repeated along each axis for the larger sizes. A packing
whose coordination number changes by more than 2 % has no rate: exit 4. Every repetition runs all cases once; medians are
reported.

Examples:
  One core, one size, with the servo at every step:
    cargo run --release -p grainlab_bench -- dem --grains 2000 --threads 1 --features coulomb --servo
  Comparison of the instruction sets:
    cargo run --release -p grainlab_bench -- dem --grains 16000 --threads 1 --simd scalar,avx2,avx512 --format json";

/// The cases to time.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Packing to step: CSV with its sidecar, LAMMPS data or dump, or a recording; also as .gz
    #[arg(long, value_name = "FILE")]
    packing: Option<PathBuf>,
    /// Sizes: the number of grains of the packing times cubes; default 1, 2 and 4 copies along each axis
    #[arg(long, value_name = "N", value_delimiter = ',')]
    grains: Vec<u64>,
    /// Numbers of threads
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "1,2", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Vec<u32>,
    /// Parts of the contact law; default: all that fit the friction of the default packing, those of its friction for another
    #[arg(long, value_enum, value_delimiter = ',')]
    features: Vec<Features>,
    /// Evaluate the stress and control the strain rate after every step, at the pressure of the packing
    #[arg(long)]
    servo: bool,
    /// Solver steps per repetition, after a tenth as many for the warm-up; default: as many as make 2e7
    /// particle-steps
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    steps: Option<u32>,
    /// Instruction sets: best, scalar, avx2, avx512
    #[arg(long, value_name = "SET", value_delimiter = ',', default_value = "best", value_parser = instruction_set)]
    simd: Vec<Simd>,
    /// Repetitions per case
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    repetitions: u32,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// One case: medians over its repetitions.
#[derive(Debug, Serialize)]
struct Speed {
    grains: u64,
    threads: u32,
    features: Features,
    simd: String,
    servo: bool,
    steps: u32,
    repetitions: usize,
    /// By wall time.
    particle_steps_per_second: f64,
    /// By the CPU time of all threads.
    cpu_particle_steps_per_second: f64,
    /// By CPU time.
    ns_per_contact: f64,
    coordination: f64,
    /// Mean stress at the end, Pa.
    pressure: f64,
    /// Memory of the engine; null if the system does not report it.
    bytes_per_grain: Option<f64>,
}

fn instruction_set(text: &str) -> Result<Simd, String> {
    let set =
        if text == "best" { Simd::best() } else { text.parse().map_err(|e| format!("{e}; or best"))? };
    if set.is_available() {
        return Ok(set);
    }
    let there_are: Vec<String> = Simd::available().iter().map(Simd::to_string).collect();
    Err(format!("this processor has no {set}; it has {}", there_are.join(", ")))
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let packing = packing::load(args.packing.as_deref())?;
    let sizes = packing::copies(packing.grains(), &args.grains)?;
    say!("grainlab: {} grains, friction {}, {}", packing.grains(), packing.friction, packing.law);
    let features = match (&args.features[..], &args.packing) {
        ([], None) => {
            let all = Features::value_variants().iter().copied();
            all.filter(|features| features.fits(packing.friction)).collect()
        }
        ([], Some(_)) => vec![Features::of(packing.friction)],
        (given, _) => given.to_vec(),
    };
    let mut cases = Vec::new();
    for copies in sizes {
        let grains = packing.grains() as u64 * u64::from(copies).pow(3);
        let steps = args.steps.unwrap_or((2e7 / grains as f64).ceil() as u32);
        for simd in &args.simd {
            for threads in &args.threads {
                for features in &features {
                    let (simd, threads, features) = (*simd, *threads, *features);
                    cases.push(Case { copies, grains, threads, features, simd, servo: args.servo, steps });
                }
            }
        }
    }
    if let Some(unfit) = features.iter().find(|f| !f.fits(packing.friction)) {
        return Err(Failure::usage(format!(
            "--features {}: the packing has friction {}, which it keeps; its own features are {}",
            unfit.name(),
            packing.friction,
            Features::of(packing.friction).name()
        )));
    }
    let pressure = pressure(&packing)?;
    let mut loops: Vec<Vec<Loop>> = vec![Vec::new(); cases.len()];
    for repetition in 1..=args.repetitions {
        say!("grainlab: repetition {repetition} of {}", args.repetitions);
        for (case, done) in cases.iter().zip(&mut loops) {
            done.push(stepping::run(&packing, pressure, case)?);
        }
    }
    let rows: Vec<Speed> = cases.iter().zip(&loops).map(|(case, loops)| row(case, loops)).collect();
    let report = BTreeMap::from([("rows", &rows)]);
    args.format.print(
        &report,
        || table(&rows, exact).csv(),
        || table(&rows, |v| three_digits(v, 0)).text(),
    )?;
    Ok(Exit::Done)
}

fn row(case: &Case, loops: &[Loop]) -> Speed {
    let of = |part: &dyn Fn(&Loop) -> f64| median(loops.iter().map(part).collect());
    let work = case.grains as f64 * f64::from(case.steps);
    Speed {
        grains: case.grains,
        threads: case.threads,
        features: case.features,
        simd: case.simd.to_string(),
        servo: case.servo,
        steps: case.steps,
        repetitions: loops.len(),
        particle_steps_per_second: of(&|l| work / l.wall_seconds),
        cpu_particle_steps_per_second: of(&|l| work / l.cpu_seconds),
        ns_per_contact: of(&|l| 1e9 * l.cpu_seconds / (l.contacts * f64::from(case.steps))),
        coordination: of(&|l| 2.0 * l.contacts / case.grains as f64),
        pressure: of(&|l| l.pressure),
        // The first engine allocates fresh memory; later ones reuse memory freed by others.
        bytes_per_grain: loops
            .iter()
            .filter_map(|l| l.bytes)
            .reduce(f64::max)
            .map(|b| b / case.grains as f64),
    }
}

fn table(rows: &[Speed], number: impl Fn(Option<f64>) -> String) -> Table {
    let mut t = Table::new([
        "features",
        "grains",
        "threads",
        "simd",
        "servo",
        "particle_steps_per_second",
        "cpu_particle_steps_per_second",
        "ns_per_contact",
        "coordination",
        "bytes_per_grain",
    ]);
    for r in rows {
        let mut cells = vec![
            r.features.name(),
            r.grains.to_string(),
            r.threads.to_string(),
            r.simd.clone(),
            if r.servo { "yes" } else { "no" }.to_owned(),
        ];
        let rates = [r.particle_steps_per_second, r.cpu_particle_steps_per_second];
        cells.extend(rates.map(|v| number(Some(v))));
        cells.extend([Some(r.ns_per_contact), Some(r.coordination), r.bytes_per_grain].map(&number));
        t.row(cells);
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_instruction_set_is_known_by_name_and_the_best_is_one_of_those_there_are() {
        assert_eq!(instruction_set("scalar"), Ok(Simd::Scalar));
        assert!(Simd::available().contains(&instruction_set("best").unwrap()));
        assert!(instruction_set("mmx").unwrap_err().contains("avx512"));
    }
}
