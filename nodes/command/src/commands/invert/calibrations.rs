//! Calibrations by name.

use grainlab_console::Failure;
use grainlab_emt::Calibration;
use grainlab_recordings::input;
use std::path::Path;
use std::sync::Arc;

pub(super) const DEFAULT: &str = "default";

/// A calibration for all models: a built-in one, or a file; `None` for `default`, by which each model has its own.
pub(super) fn named(name: &str) -> Result<Option<Arc<Calibration>>, Failure> {
    if name == DEFAULT { Ok(None) } else { load(name).map(Arc::new).map(Some) }
}

/// A built-in calibration by its name, one from a file, or the text of a file.
fn load(name: &str) -> Result<Calibration, Failure> {
    if name.contains('\n') {
        return Calibration::parse(name).map_err(|e| Failure::usage(format!("calibration: {e}")));
    }
    if let Some(calibration) = Calibration::builtin(name) {
        return Ok(calibration.clone());
    }
    if !name.ends_with(".toml") {
        let known = [&[DEFAULT], &Calibration::BUILTIN[..]].concat().join(", ");
        return Err(Failure::usage(format!("no calibration {name:?}; there are: {known}, or a FILE.toml")));
    }
    let text =
        input::text(Path::new(name), input::SETTINGS).map_err(|e| Failure::failed(format!("{name}: {e}")))?;
    Calibration::parse(&text).map_err(|e| Failure::usage(format!("{name}: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_calibration_from_a_file_is_the_one_that_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        let written = Calibration::builtin("grainlab").unwrap().clone();
        std::fs::write(&path, written.to_toml().unwrap()).unwrap();
        assert_eq!(load(&path.to_string_lossy()).unwrap(), written);
        std::fs::write(&path, "name = 3").unwrap();
        assert!(load(&path.to_string_lossy()).unwrap_err().to_string().contains("mine.toml"));
    }
}
