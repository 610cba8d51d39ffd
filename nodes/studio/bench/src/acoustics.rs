//! `grainlab bench acoustics`: cost and error of the wave speeds of a packing, by method.

mod args;
mod curves;
mod judge;
mod measure;
mod noise;
mod plot;
mod report;

pub(crate) use args::{Args, Method};
pub(crate) use report::Row;

use super::folder;
use super::packing::load;
use grainlab_console::{Failure, json};
use grainlab_core::Packing;
use grainlab_node_kit::Exit;
use grainlab_page::plot::Theme;

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    if !args.noise.is_empty() {
        return noise::run(args);
    }
    if args.judge {
        return judge::run(args);
    }
    let mut packings = args.packing.iter().map(|path| load(Some(path))).collect::<Result<Vec<_>, _>>()?;
    if packings.is_empty() {
        packings.push(load(None)?);
    }
    folder::ready(args.out.as_deref())?;
    let mut rows = Vec::new();
    for packing in &packings {
        rows.extend(measure::rows(packing, args)?);
    }
    let report = report::report(rows);
    if let Some(folder) = &args.out {
        folder::write(folder, "acoustics.json", &json(&report)?)?;
        folder::write(folder, "acoustics.svg", &plot::figure(&report).svg(Theme::Light))?;
        folder::write(folder, "dispersion.svg", &curves::svg(&packings[0])?)?;
    }
    args.format.print(&report, || report::csv(&report), || report::text(&report, &plot::figure(&report)))?;
    Ok(Exit::Done)
}

/// Rows of one packing along three rays, by these methods.
pub(crate) fn measured(
    packing: &Packing,
    methods: &[Method],
    tolerances: &[f64],
) -> Result<Vec<Row>, Failure> {
    measure::rows(packing, &Args::of(methods, tolerances))
}
