//! `grainlab view`: packings in three dimensions, as a page or as a picture; a running laboratory as a page.

use super::packings::import;
use super::run::ros_arguments;
use grainlab_console::{Failure, count, has_name_of, print, worse, write_whole};
use grainlab_node_kit::Exit;
use grainlab_recordings::import::{ImportError, Imported, each};
use grainlab_report::default_page;
use grainlab_viewer::{Film, Ground, Parts, Picture, Quantity, Size, Slice, View, page};
use std::ffi::OsStr;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const EXAMPLES: &str = "\
Examples:
  grainlab view recordings/runs/demo-1-1 --open          in a browser
  grainlab view packing.data -o packing.html
  grainlab view recordings/runs/s2-1-1 --png s2.png --color force --size 1600x1200
  grainlab view recordings/runs/s2-1-1 --png cut.png --slice x=0.4 --force-chains
  grainlab view --live --open                            the run on the bus, and the next one when it ends
  grainlab view --live --port 0 --ros-args -r __ns:=/left

The PNG is in parallel projection, with a scale bar and the directions of x, y and z. The cell is periodic: each grain is drawn
once, whole, where its centre is, and its contacts through the faces are counted.

The page of --live is served on 127.0.0.1 until Ctrl-C. Without ROS_DOMAIN_ID it finds the run that was launched on this host.
It belongs to no run, and no process waits for it.";

/// Packings to show, or a running laboratory.
#[derive(Debug, clap::Args)]
#[command(after_help = format!("{EXAMPLES}\n\n{}", import::FORMATS), allow_negative_numbers = true)]
pub(crate) struct Args {
    /// Recording (directory or .mcap), CSV with its JSON sidecar, LAMMPS dump or data file, YADE text export; text also as .gz
    #[arg(value_name = "FILE", required_unless_present = "live")]
    file: Option<PathBuf>,
    /// Follow the running laboratory in a browser: stress, targets, curves, processes, packings
    #[arg(long, conflicts_with_all = ["file", "output", "png"])]
    live: bool,
    /// Port of the page on 127.0.0.1, 0 for any free one [default: 8808, or any if that is taken]
    #[arg(long, value_name = "PORT", requires = "live", conflicts_with = "file")]
    port: Option<u16>,
    /// ROS 2 arguments of --live: -r __ns:=/left, --log-level
    #[arg(long, value_name = "ARGUMENTS", num_args = 0.., allow_hyphen_values = true, requires = "live", conflicts_with = "file")]
    ros_args: Option<Vec<String>>,
    /// File of the page [default: NAME.view.html beside the file, or view.html in the directory of a run]
    #[arg(short, long, alias = "out", value_name = "FILE")]
    output: Option<PathBuf>,
    /// Show the page in a browser
    #[arg(long, conflicts_with = "png")]
    open: bool,
    /// Draw one state into this PNG file instead, without a browser
    #[arg(long, value_name = "FILE", conflicts_with = "output")]
    png: Option<PathBuf>,
    /// Size of the PNG, pixels; texts that do not fit are left out
    #[arg(long, value_name = "WxH", default_value = "1200x900", requires = "png")]
    size: String,
    /// State of the PNG, counted from 1 in order of time; negative from the end
    #[arg(long, value_name = "N", default_value_t = -1, requires = "png")]
    state: i64,
    /// Colours of the PNG: contacts of each grain that are not with rattlers, mean normal force of its contacts, or whether it
    /// carries force [default: coordination]
    #[arg(long, value_name = "QUANTITY", value_parser = Quantity::ALL.map(Quantity::name), requires = "png")]
    color: Option<String>,
    /// Cut of the PNG along a face of the cell, at a position from 0 to 1: what is nearer is left out [default position: 0.5]
    #[arg(long, value_name = "x|y|z[=POSITION]", requires = "png")]
    slice: Option<Slice>,
    /// Contacts as force chains in the PNG, between small grains
    #[arg(long, requires = "png")]
    force_chains: bool,
    /// Light letters on a dark ground in the PNG
    #[arg(long, requires = "png")]
    dark: bool,
    #[command(flatten)]
    import: import::Args,
}

pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    match (&args.file, &args.png) {
        (None, _) => live(args),
        (Some(file), Some(png)) => picture(args, file, png),
        (Some(file), None) => html(args, file),
    }
}

fn live(args: &Args) -> Result<Exit, Failure> {
    let words =
        args.ros_args.iter().flat_map(|rest| std::iter::once("--ros-args".to_owned()).chain(rest.clone()));
    let ros = ros_arguments(&words.collect::<Vec<_>>())?;
    let options = grainlab_live::Options { port: args.port, ros };
    grainlab_live::run(&options, |url| if args.open { open(url.as_ref()) } else { Ok(()) })
}

/// Shows a page in a browser.
fn open(page: &OsStr) -> Result<(), Failure> {
    let quiet = Stdio::null;
    let opened = Command::new("xdg-open").arg(page).stdin(quiet()).stdout(quiet()).stderr(quiet()).spawn();
    let failed = |e| Failure::failed(format!("xdg-open: {e}; open {} in a browser", page.display()));
    opened.map(|_| ()).map_err(failed)
}

/// Passes on the packings of the file; the exit is the worst of its warnings and of packings that overlap too deeply.
fn packings(
    args: &Args,
    file: &Path,
    mut take: impl FnMut(Imported) -> ControlFlow<()>,
) -> Result<Exit, Failure> {
    let options = args.import.options()?;
    let mut exit = Exit::Done;
    let mut seen = |imported: Imported| {
        exit = worse(exit, imported.exit());
        if let Some(fault) = imported.packing.overlap_fault() {
            grainlab_console::say!("grainlab: {}, step {}: {fault}", file.display(), imported.step);
        }
        take(imported)
    };
    let warnings = each(file, &options, &mut seen).map_err(ImportError::failure)?;
    warnings.iter().for_each(|w| grainlab_console::say!("grainlab: {w}"));
    Ok(worse(exit, if warnings.is_empty() { Exit::Done } else { Exit::DataLoss }))
}

fn view(imported: &Imported) -> View {
    let packing = &imported.packing;
    // A recording is known by its scene.
    let source = imported.source.strip_prefix("recording, ").unwrap_or(&imported.source);
    let (name, state) = source.split_once(", ").unwrap_or((source, ""));
    let state = if state.is_empty() { String::new() } else { format!(", {state}") };
    let (grains, phi) = (count(packing.grains(), "grain"), packing.solid_fraction());
    View::new(packing, format!("{name}, {grains}{state}, phi {phi:.4}"))
}

fn html(args: &Args, file: &Path) -> Result<Exit, Failure> {
    args.output.as_ref().map_or(Ok(()), |path| has_name_of("-o", path, "html"))?;
    let mut film = Film::default();
    let exit = packings(args, file, |imported| {
        film.push(view(&imported));
        ControlFlow::Continue(())
    })?;
    let states = film.states();
    let last = states.last().ok_or_else(|| Failure::failed(format!("{}: no packing", file.display())))?;
    let name = name(file);
    let shown = match film.count() - states.len() {
        0 => count(states.len(), "state"),
        left_out => format!(
            "{} of {}; {left_out} left out for the size of the page",
            states.len(),
            count(film.count(), "state")
        ),
    };
    let grains = last.part.clone().unwrap_or_else(|| count(last.grains(), "grain"));
    let about = format!("{grains}, {shown}. Positions are rounded to 1/65536 of the cell.");
    let text = page(&name, &about, &name, &states).map_err(Failure::failed)?;
    let path = args.output.clone().map_or_else(|| default_page(beside(file)), Ok)?;
    write_whole(&path, &text)?;
    print(&format!("{}\n", path.display()))?;
    if args.open {
        open(path.as_ref())?;
    }
    Ok(exit)
}

fn picture(args: &Args, file: &Path, png: &Path) -> Result<Exit, Failure> {
    has_name_of("--png", png, "png")?;
    let size: Size = args.size.parse().map_err(|e| Failure::usage(format!("--size: {e}")))?;
    if args.state == 0 {
        return Err(Failure::usage("--state 0: states are counted from 1, or from -1 at the end"));
    }
    // Only as many of those at the end as are needed are kept.
    let mut kept = std::collections::VecDeque::new();
    let mut count = 0;
    let exit = packings(args, file, |imported| {
        count += 1;
        if args.state > 0 && count == args.state {
            kept.push_back(view(&imported));
            return ControlFlow::Break(());
        }
        if args.state < 0 {
            kept.push_back(view(&imported));
            if kept.len() as u64 > args.state.unsigned_abs() {
                kept.pop_front();
            }
        }
        ControlFlow::Continue(())
    })?;
    let is_there = args.state > 0 || kept.len() as u64 == args.state.unsigned_abs();
    let view = kept.pop_front().filter(|_| is_there).ok_or_else(|| {
        Failure::failed(format!("{}: no state {}: there are {count}", file.display(), args.state))
    })?;
    let named = |quantity: &Quantity| args.color.as_deref() == Some(quantity.name());
    let colour = Quantity::ALL.into_iter().find(named).unwrap_or_default();
    let ground = if args.dark { Ground::Dark } else { Ground::Light };
    let parts = Parts { slice: args.slice, chains: args.force_chains };
    let bytes = Picture::of(&view, colour, size, ground, &parts).png().map_err(Failure::failed)?;
    write_whole(png, bytes)?;
    print(&format!("{}\n", png.display()))?;
    Ok(exit)
}

fn name(file: &Path) -> String {
    let resolved = file.canonicalize().unwrap_or_else(|_| file.to_owned());
    let name = resolved.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = name.strip_suffix(".gz").unwrap_or(&name);
    stem.rsplit_once('.').map_or(stem, |(stem, _)| stem).to_owned()
}

/// The page beside a file, or in the directory of a run.
fn beside(file: &Path) -> PathBuf {
    if file.is_dir() {
        file.join("view.html")
    } else {
        file.with_file_name(format!("{}.view.html", name(file)))
    }
}
