//! `grainlab bench accuracy`: cost and error of each numerical setting.

pub(crate) mod front;
pub(crate) mod integration;
pub(crate) mod knobs;
pub(crate) mod measure;
mod plot;
pub(crate) mod report;
pub(crate) mod row;
mod runs;
mod statistics;
mod table;
mod verdict;

use super::folder;
use clap::ValueEnum;
use grainlab_console::{Failure, Format, json, say};
use grainlab_node_kit::Exit;
use grainlab_page::plot::Theme;
use grainlab_scene::Scene;
use knobs::{Knob, Servoed, Setting, converged};
use report::Report;
use row::Sample;
use runs::Job;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

const EXAMPLES: &str = "\
Each knob is varied alone, on a scene run in this process from gas to packing at several seeds. The error of a setting is
the mean over the seeds of its difference, in k, eps, phi, G12 and Theta, from a converged run with every knob at its most
accurate value. Packings diverge from any perturbation: an error below two standard errors is marked as not resolved.

Examples:
  All knobs on a path of 200 grains, with a plot of the Pareto front (about 15 minutes of two cores):
    grainlab bench accuracy --out accuracy
  Strain rate and damping on the demo, with more seeds:
    grainlab bench accuracy --scene demo --knobs strain_rate,damping --seeds 16";

/// The default scene.
const PRESS: &str = include_str!("accuracy/press.toml");

/// Runs with this many times the steps of the default count as failed: twice the number needed by the slowest
/// setting.
const PATIENCE: u64 = 8;

/// The settings to vary, and the number of seeds.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Scene to run: a built-in name or a file; default: a path of 200 grains to 50 kPa
    #[arg(long, value_name = "SCENE")]
    scene: Option<String>,
    /// Seeds per setting, counted up from that of the scene
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=10_000))]
    seeds: Option<u32>,
    /// Knobs to vary [default: all]
    #[arg(long, value_enum, value_name = "KNOB", value_delimiter = ',')]
    knobs: Vec<Knob>,
    /// Two seeds, one value per knob besides the default, and a less accurate reference, for a quick test
    #[arg(long)]
    quick: bool,
    /// Number of parallel runs; each is timed by the CPU time of its own thread
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
    /// Folder for accuracy.json and accuracy.svg
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// How to print the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// The setting that is varied, and the scene.
pub(crate) struct Plan<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) knobs: &'a [Knob],
    /// Number of seeds, 2 or more.
    pub(crate) seeds: u32,
    /// Fewer values per knob and a less accurate reference.
    pub(crate) quick: bool,
    pub(crate) threads: usize,
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let scene = scene(args)?;
    folder::ready(args.out.as_deref())?;
    let report = measured(&Plan {
        scene: &scene,
        knobs: if args.knobs.is_empty() { Knob::value_variants() } else { &args.knobs },
        seeds: args.seeds.unwrap_or(if args.quick { 2 } else { 8 }),
        quick: args.quick,
        threads: args.threads as usize,
    })?;
    if let Some(folder) = &args.out {
        folder::write(folder, "accuracy.json", &json(&report)?)?;
        folder::write(folder, "accuracy.svg", &plot::figure(&report).svg(Theme::Light))?;
    }
    args.format.print(&report, || table::csv(&report), || table::text(&report))?;
    Ok(Exit::Done)
}

/// Runs every setting of the plan, and compares it with the converged run.
pub(crate) fn measured(plan: &Plan<'_>) -> Result<Report, Failure> {
    let Plan { scene, quick, threads, .. } = *plan;
    let seeds = seeds(scene, plan.seeds);
    let unlimited = vec![u64::MAX; seeds.len()];
    let first = every_seed(&[(scene, &unlimited)], &seeds, threads, "default");
    let first = first.into_iter().next().unwrap_or_default();
    let limits: Vec<u64> =
        first.iter().map(|r| r.as_ref().map_or(u64::MAX, |o| PATIENCE * o.steps)).collect();
    let careful = converged(scene, quick);
    let settings = settings(plan.knobs, scene, servoed(&first), quick);
    // The default once more, so that it is timed together with the others.
    let mut jobs = vec![(&careful, &unlimited), (scene, &limits)];
    jobs.extend(settings.iter().filter(|s| !s.default).map(|s| (&s.scene, &limits)));
    let mut results = every_seed(&jobs, &seeds, threads, "settings").into_iter();
    let (reference, default) = (results.next().unwrap_or_default(), results.next().unwrap_or_default());
    let sample = |s: Setting| {
        let sample = if s.default { default.clone() } else { results.next().unwrap_or_default() };
        (s, sample)
    };
    let samples: Vec<(Setting, Sample)> = settings.into_iter().map(sample).collect();
    report::report(scene, seeds, (&careful, &reference), &default, &samples)
        .ok_or_else(|| no_reference(&reference, &default))
}

/// The path of 200 grains that is run by default.
pub(crate) fn press() -> Result<Scene, Failure> {
    Scene::parse(PRESS).map_err(Failure::failed)
}

/// Counted up from that of the scene.
fn seeds(scene: &Scene, count: u32) -> Vec<u64> {
    (0..u64::from(count)).map(|n| scene.seed.wrapping_add(n)).collect()
}

fn scene(args: &Args) -> Result<Scene, Failure> {
    match &args.scene {
        Some(name) => Ok(grainlab_recordings::scenes::load(name, &[], None)?.scene),
        None => press(),
    }
}

fn settings(knobs: &[Knob], scene: &Scene, servoed: Option<Servoed>, quick: bool) -> Vec<Setting> {
    let of = |knob: &Knob| {
        let settings = knob.settings(scene, servoed, quick);
        if settings.is_empty() {
            say!("grainlab: the scene has no setting for the knob {}", knob.name());
        }
        settings
    };
    knobs.iter().flat_map(of).collect()
}

fn servoed(sample: &Sample) -> Option<Servoed> {
    sample.iter().find_map(|r| r.as_ref().ok()?.servoed)
}

/// Runs each scene at every seed, with limits on the steps; returns the outcomes by scene. Seed by seed, so
/// that other load on the machine affects all scenes alike.
fn every_seed(scenes: &[(&Scene, &Vec<u64>)], seeds: &[u64], threads: usize, what: &str) -> Vec<Sample> {
    let job = |s: usize| {
        let (seed, at) = (seeds[s], s);
        scenes.iter().map(move |(scene, limits)| Job { scene, seed, limit: limits[at] })
    };
    let jobs: Vec<Job<'_>> = (0..seeds.len()).flat_map(job).collect();
    let (done, total) = (AtomicUsize::new(0), jobs.len());
    let tenth = |n: usize| n * 10 / total;
    let results = runs::all(&jobs, threads, || {
        let n = done.fetch_add(1, Ordering::Relaxed) + 1;
        if tenth(n) > tenth(n - 1) {
            say!("grainlab: {what}: {n} of {total} runs");
        }
    });
    let mut samples: Vec<Sample> = vec![Vec::new(); scenes.len()];
    for (run, outcome) in results.into_iter().enumerate() {
        samples[run % scenes.len()].push(outcome);
    }
    samples
}

/// Without a reference there is no result.
fn no_reference(reference: &Sample, default: &Sample) -> Failure {
    let first = |sample: &Sample| sample.iter().find_map(|r| r.as_ref().err().cloned());
    let reason = match (first(default), first(reference)) {
        (Some(reason), _) => format!("the unchanged scene: {reason}"),
        (None, Some(reason)) => format!("the converged run: {reason}"),
        (None, None) => "no run has a result".to_owned(),
    };
    Failure::new(
        Exit::PhysicsInvalid,
        format!("fewer than two seeds succeeded, so that there is no reference: {reason}"),
    )
}
