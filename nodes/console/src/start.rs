//! The packing that a scene starts from.

use crate::failure::Failure;
use grainlab_core::Packing;
use grainlab_recordings::import::{ImportError, ImportOptions, Imported, Setting, each};
use grainlab_scene::{Draft, StartFile};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// A packing from a file, with its exact place.
pub(crate) struct Start {
    pub(crate) packing: Packing,
    /// The whole path.
    pub(crate) path: PathBuf,
    /// Its solver step.
    pub(crate) step: u64,
}

/// Reads the packing named by `file`: that of its step, or the last one. Data that the file lacks are taken
/// from the scene.
pub(crate) fn read(draft: &Draft, file: &StartFile) -> Result<Start, Failure> {
    let folder = file.from.as_deref().map(Path::new).and_then(Path::parent).unwrap_or(Path::new(""));
    let path = folder.join(&file.path);
    let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("start.packing: {e}"));
    let path = path.canonicalize().map_err(|e| failed(&format!("{}: {e}", path.display())))?;
    let found = match pick(&path, file.step, &ImportOptions::default()) {
        Err(error) => match missing(&error) {
            Some(missing) => pick(&path, file.step, &of_scene(draft, missing)),
            None => Err(error),
        },
        found => found,
    };
    let found = found.map_err(|e| match missing(&e) {
        Some(_) => Failure::usage(format!(
            "start.packing: {e}; name shear_modulus, poisson_ratio and density under [material], and the friction of the first phase"
        )),
        None => failed(&e),
    })?;
    let Some(found) = found else {
        let step = file.step.unwrap_or_default();
        return Err(Failure::usage(format!("start.step: {} has no packing of step {step}", path.display())));
    };
    found.notes.iter().for_each(|note| crate::say!("grainlab: {}: {note}", path.display()));
    Ok(Start { packing: found.packing, path, step: found.step })
}

/// The packing of this step, or the last one.
fn pick(path: &Path, step: Option<u64>, options: &ImportOptions) -> Result<Option<Imported>, ImportError> {
    let mut found = None;
    each(path, options, &mut |imported| {
        let wanted = step.is_none_or(|step| step == imported.step);
        if wanted {
            found = Some(imported);
        }
        if wanted && step.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    Ok(found)
}

fn missing(error: &ImportError) -> Option<&[Setting]> {
    match error {
        ImportError::Missing(settings) => Some(settings),
        ImportError::In { source, .. } => missing(source),
        _ => None,
    }
}

/// The values of the scene for data that the file lacks.
fn of_scene(draft: &Draft, missing: &[Setting]) -> ImportOptions {
    let given = |setting, value: Option<f64>| value.filter(|_| missing.contains(&setting));
    ImportOptions {
        shear_modulus: given(Setting::ShearModulus, draft.material("shear_modulus")),
        poisson_ratio: given(Setting::PoissonRatio, draft.material("poisson_ratio")),
        density: given(Setting::Density, draft.material("density")),
        friction: given(Setting::Friction, draft.first_friction()),
        ..ImportOptions::default()
    }
}
