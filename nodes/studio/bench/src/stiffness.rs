//! `grainlab bench stiffness`: cost and error of all 21 elastic constants of a packing.

mod args;
mod measure;
mod plot;
mod report;

pub(crate) use args::{Args, Method};
pub(crate) use report::Row;

use super::folder;
use super::packing::{copies, load, repeated};
use grainlab_console::{Failure, json};
use grainlab_core::{Mat3, Packing};
use grainlab_dem::{Engine, EngineSettings, TimeStep};
use grainlab_node_kit::Exit;
use grainlab_page::plot::Theme;

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let paths = args.packing.iter().map(|path| load(Some(path)));
    let mut packings = paths.collect::<Result<Vec<_>, _>>()?;
    if packings.is_empty() {
        packings.push(load(None)?);
    }
    let sizes = if args.grains.is_empty() { Vec::new() } else { copies(packings[0].grains(), &args.grains)? };
    folder::ready(args.out.as_deref())?;
    let mut rows = Vec::new();
    for packing in &packings {
        rows.extend(measure::rows(packing, false, args)?);
    }
    for copies in sizes.into_iter().filter(|copies| *copies > 1) {
        rows.extend(measure::rows(&replicated(&packings[0], copies)?, true, args)?);
    }
    let report = report::report(rows);
    if let Some(folder) = &args.out {
        folder::write(folder, "stiffness.json", &json(&report)?)?;
        folder::write(folder, "stiffness.svg", &plot::figure(&report).svg(Theme::Light))?;
    }
    args.format.print(&report, || report::csv(&report), || report::text(&report, &plot::figure(&report)))?;
    Ok(Exit::Done)
}

/// Rows of one packing: affine motion, conjugate gradients at each tolerance, a factorisation, probes at each strain.
pub(crate) fn measured(
    packing: &Packing,
    tolerances: &[f64],
    amplitudes: &[f64],
    repetitions: u32,
) -> Result<Vec<Row>, Failure> {
    measure::rows(packing, false, &Args::of(tolerances, amplitudes, repetitions))
}

/// Copies of the packing along each axis. Contacts are computed from the overlaps.
fn replicated(packing: &Packing, copies: u32) -> Result<Packing, Failure> {
    let (cell, centres) =
        repeated(packing, copies).ok_or_else(|| Failure::failed("the cell of the copies is invalid"))?;
    let largest = packing.radii.iter().copied().fold(0.0, f64::max);
    let setting = EngineSettings {
        friction: packing.friction,
        damping: 0.0,
        drag: 0.0,
        spin_drag: 0.0,
        tangential: grainlab_core::contact::TangentialLaw::Rescaled,
        time_step: TimeStep::Fixed(1e-9),
        skin: 0.01 * largest,
        thermostat_speed: None,
    };
    let radii = packing.radii.repeat((copies as usize).pow(3));
    let mut engine = Engine::new(cell, packing.material, radii, &centres, setting)
        .map_err(|e| Failure::new(Exit::PhysicsInvalid, e))?;
    engine.sort_spatially();
    engine.initialise().map_err(|e| Failure::new(Exit::PhysicsInvalid, e))?;
    Ok(engine.packing(Mat3::identity()))
}
