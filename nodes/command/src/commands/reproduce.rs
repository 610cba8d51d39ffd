//! `grainlab reproduce`: the tables and figures of the paper.

use super::campaign::{self, gather};
use grainlab_campaign::{Campaign, Engine, Folder, Options};
use grainlab_console::{Failure, Format, Table, fixed, print, worse};
use grainlab_node_kit::Exit;
use grainlab_reproduce::paper::{DISTANCE, Observed, States, distance};
use grainlab_reproduce::{Provenance, Reproduction, Size, campaign_text, pressure_of_phase, sample_of_scene};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const QUICK: u32 = 500;

const EXAMPLES: &str = "\
Prepares S1 to S4 of La Ragione & Magnanimo (2012) at 50, 100, 250 and 500 kPa, each sample a recorded run, and writes
index.html, reproduction.json and reproduction.csv into the folder: Tables I to III and Figures 1 to 4 compared with the paper's, and
every model judged. Started again after an interruption, it continues, to the same bytes.

Examples:
  grainlab reproduce                  one seed
  grainlab reproduce --seeds 5        with standard errors
  grainlab reproduce --quick          500 grains, within a minute
  grainlab campaign nodes/scenes/campaigns/search.toml && grainlab reproduce --distance recordings/campaigns/search";

/// The reproduction to make.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Args {
    /// Seeds of each sample
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    seeds: u32,
    /// The first seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    first_seed: u64,
    /// Grains of each packing [default: 2000, as in the paper]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(100..))]
    grains: Option<u32>,
    /// Packings of 500 grains
    #[arg(long, conflicts_with = "grains")]
    quick: bool,
    /// Folder of the runs and of the page [default: recordings/campaigns/paper-GRAINS]
    #[arg(long, short, alias = "output", value_name = "DIR")]
    out: Option<PathBuf>,
    /// Instead, judge a campaign over s1 to s4: how far the means of each set of values are from Tables I and II, term by
    /// term
    #[arg(long, value_name = "DIR", conflicts_with_all = ["seeds", "first_seed", "grains", "quick", "out"])]
    distance: Option<PathBuf>,
    #[command(flatten)]
    options: Options,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    if let Some(folder) = &args.distance {
        return judge(folder, args.format);
    }
    let grains = args.grains.unwrap_or(if args.quick { QUICK } else { 2000 });
    let size = Size { grains, seeds: args.seeds, first_seed: args.first_seed };
    let mut campaign = Campaign::parse(&campaign_text(size), Path::new(""))?;
    let root =
        args.out.clone().unwrap_or_else(|| PathBuf::from(format!("recordings/campaigns/paper-{grains}")));
    campaign.processes = args.options.processes;
    let (folder, _lock) = campaign::begin(&campaign, &root, &args.options)?;
    let exit = args.options.run(&campaign, &folder)?;
    if args.options.engine == Engine::Print || exit == Exit::Interrupted {
        return Ok(exit);
    }
    let (states, gathered) = gather::states(&campaign, &folder)?;
    gather::write(&campaign, &folder, &states)?;
    let observed = States::new(states.into_iter().filter_map(observed).collect());
    if observed.all().is_empty() {
        return Ok(worse(exit, gathered));
    }
    let reproduction = Reproduction::new(observed, provenance(args, grains, &root));
    let (text, csv) = (reproduction.json()?, reproduction.csv());
    folder.write("reproduction.json", &text)?;
    folder.write("reproduction.csv", &csv)?;
    let page = folder.write("index.html", reproduction.html())?;
    print(&match args.format {
        Format::Json => text,
        Format::Csv => csv,
        Format::Table => reproduction.text() + &format!("Page: {}\n", page.display()),
    })?;
    Ok(worse(exit, gathered))
}

/// A state of the paper; `None` if it is another one.
fn observed(state: gather::State<'_>) -> Option<Observed> {
    Some(Observed {
        sample: sample_of_scene(&state.member.scene)?,
        pressure: pressure_of_phase(&state.phase)?,
        seed: state.member.seed,
        report: state.found.packing.report,
    })
}

fn judge(folder: &Path, format: Format) -> Result<Exit, Failure> {
    let (folder, campaign) = Folder::open(folder)?;
    let (states, exit) = gather::states(&campaign, &folder)?;
    let mut groups: BTreeMap<String, Vec<Observed>> = BTreeMap::new();
    for state in states {
        let settings = state.member.sets().join(" ");
        groups.entry(settings).or_default().extend(observed(state));
    }
    let judged = groups.into_iter().map(|(settings, all)| (settings, distance(&States::new(all))));
    let mut judged: Vec<(String, Option<[f64; 7]>)> = judged.collect();
    let total = |terms: &Option<[f64; 7]>| terms.map_or(f64::INFINITY, |t| t[0]);
    judged.sort_by(|a, b| total(&a.1).total_cmp(&total(&b.1)));
    let mut table = Table::new(std::iter::once("settings").chain(DISTANCE));
    for (settings, terms) in judged {
        let cells = (0..7).map(|n| fixed(terms.map(|t| t[n]), 3));
        table.row(std::iter::once(settings).chain(cells));
    }
    print(&if format == Format::Table { table.text() } else { table.csv() })?;
    Ok(exit)
}

/// Command and version, equal for every place where the command was typed.
fn provenance(args: &Args, grains: u32, root: &Path) -> Provenance {
    let mut command = "grainlab reproduce".to_owned();
    if args.seeds != 1 {
        command += &format!(" --seeds {}", args.seeds);
    }
    if args.first_seed != 1 {
        command += &format!(" --first-seed {}", args.first_seed);
    }
    match (args.quick, args.grains) {
        (true, _) => command += " --quick",
        (false, Some(grains)) => command += &format!(" --grains {grains}"),
        (false, None) => {}
    }
    if let Some(out) = &args.out {
        command += &format!(" --out {}", out.display());
    }
    let seeds = (args.first_seed..).take(args.seeds as usize).collect();
    let version = env!("CARGO_PKG_VERSION").to_owned();
    Provenance { version, command, folder: root.display().to_string(), grains, seeds }
}
