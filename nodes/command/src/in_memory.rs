//! Commands on data in memory, for programs that link them: what `grainlab analyze`, `probe`, `invert --table` and `bag export` give.

#[cfg(feature = "studio")]
pub use crate::commands::bag::export::export;
pub use crate::commands::invert::in_memory::{By, Inverted, InvertedRow, invert};
use crate::commands::packings::Found;
use crate::commands::{analyze, probe};
use grainlab_console::Failure;
use grainlab_micromechanics::Settings;
use grainlab_recordings::import::Imported;
use grainlab_results::{MeasuredPacking, Probed};
use rayon::prelude::*;

/// Results in the order of the packings, each with true if it lacks what was sought, or the reason why a packing has none.
pub type Results<R> = Vec<Result<(R, bool), String>>;

/// Structure, stress and stiffness of packings, on all cores.
pub fn analyze(settings: &Settings, packings: &[&Imported]) -> Results<MeasuredPacking> {
    all(packings, |packing| analyze::measure(settings, &packing.source, packing))
}

/// Wave speeds of packings, on all cores; `flags` are those of the command, by the names of the parameters of `acoustic_probe`.
///
/// # Errors
/// A flag that does not exist, has no effect, or is out of its range.
pub fn probe(flags: &[(String, String)], packings: &[&Imported]) -> Result<Results<Probed>, Failure> {
    let settings = probe::settings(flags)?;
    Ok(all(packings, |packing| probe::measure(&settings, &packing.source, packing)))
}

fn all<R: Send>(
    packings: &[&Imported],
    measure: impl Fn(&Imported) -> Result<Found<R>, String> + Sync,
) -> Results<R> {
    packings.par_iter().map(|packing| measure(packing).map(|found| (found.shown, found.is_without))).collect()
}
