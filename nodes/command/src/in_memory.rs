//! Commands on data in memory, for programs that link them: what `grainlab analyze`, `probe`, `invert --table` and `bag export` give.

#[cfg(feature = "studio")]
pub use crate::commands::bag::export::export;
use crate::commands::invert::in_memory::INTERRUPTED;
pub use crate::commands::invert::in_memory::{By, Inverted, InvertedRow, invert};
use crate::commands::packings::Found;
use crate::commands::{analyze, probe};
use grainlab_console::Failure;
use grainlab_micromechanics::Settings;
use grainlab_recordings::import::Imported;
use grainlab_results::{MeasuredPacking, Probed};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Results in the order of the packings, each with true if it lacks what was sought, or the reason why a packing has none.
pub type Results<R> = Vec<Result<(R, bool), String>>;

/// Structure, stress and stiffness of packings, on all cores. Packings that are not begun when `stop` is set have no result.
pub fn analyze(settings: &Settings, packings: &[&Imported], stop: &AtomicBool) -> Results<MeasuredPacking> {
    all(packings, stop, |packing| analyze::measure(settings, &packing.source, packing))
}

/// Returns the wave speeds of packings, computed on all cores. `flags` are the flags of the command, by the names of the parameters of
/// `acoustic_probe`. Packings that are not begun when `stop` is set have no result.
///
/// # Errors
/// A flag that does not exist, has no effect, or is out of its range.
pub fn probe(
    flags: &[(String, String)],
    packings: &[&Imported],
    stop: &AtomicBool,
) -> Result<Results<Probed>, Failure> {
    let settings = probe::settings(flags)?;
    Ok(all(packings, stop, |packing| probe::measure(&settings, &packing.source, packing)))
}

fn all<R: Send>(
    packings: &[&Imported],
    stop: &AtomicBool,
    measure: impl Fn(&Imported) -> Result<Found<R>, String> + Sync,
) -> Results<R> {
    let one = |packing: &&Imported| match stop.load(Ordering::Relaxed) {
        true => Err(INTERRUPTED.to_owned()),
        false => measure(packing).map(|found| (found.shown, found.is_without)),
    };
    packings.par_iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_node_kit::Exit;
    use grainlab_recordings::import::{ImportOptions, load};
    use std::path::Path;

    #[test]
    fn what_is_not_begun_when_the_work_is_stopped_has_no_result() {
        let path =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/packings/smooth_500.csv.gz");
        let loaded = load(&path, &ImportOptions::default()).unwrap();
        let packings: Vec<&Imported> = loaded.packings.iter().collect();
        let stop = AtomicBool::new(true);
        let analyzed = analyze(&Settings::default(), &packings, &stop);
        assert_eq!(analyzed.into_iter().map(|found| found.err().unwrap()).collect::<Vec<_>>(), [INTERRUPTED]);
        let probed = probe(&[], &packings, &stop).unwrap();
        assert_eq!(probed.into_iter().map(|found| found.err().unwrap()).collect::<Vec<_>>(), [INTERRUPTED]);
        let by =
            By { model: "relaxed", calibration: "grainlab", prior: None, error: Some(0.01), draws: None };
        let table = b"pressure_pa,g12_pa,g13_pa,theta_pa\n5e4,1.042e8,1.124e8,1.36e8\n".to_vec();
        assert_eq!(invert(table.clone(), &by, &stop).unwrap_err().exit, Exit::Interrupted);
        assert_eq!(invert(table, &by, &AtomicBool::new(false)).unwrap().rows.len(), 1);
    }
}
