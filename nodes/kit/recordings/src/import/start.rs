//! The packing that a scene starts from.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use grainlab_console::{Failure, memory};
use grainlab_core::{Contact, OTHER_LAW, Packing};
use grainlab_msgs::Exit;
use grainlab_scene::Draft;

use super::rounding::{ALL_DIGITS, Rounding};
use super::{Frames, ImportError, ImportOptions, Imported, Setting, each, text};
use crate::one_run::{OneRun, RunSign, SeveralRuns, state};
use crate::reader::Recording;

/// A packing to start from, with its exact place.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Packing in SI units.
    pub packing: Packing,
    /// The whole path of its file.
    pub path: PathBuf,
    /// The whole path of the file with its contact forces, if they are in one of their own.
    pub contact_forces: Option<PathBuf>,
    /// Solver step of the packing.
    pub step: u64,
    /// Warnings, one line each.
    pub notes: Vec<String>,
}

/// Reads the packing named by `file`: that of its step, or the last one. Data that the file lacks are taken from the scene.
///
/// # Errors
/// If a file cannot be read, lacks data that the scene has to give, or has no packing, or several, of the step; and if grains
/// overlap beyond every contact law.
pub fn start(draft: &Draft, file: &grainlab_scene::Start) -> Result<Start, Failure> {
    let path = whole(draft, "packing", &file.packing)?;
    let contact_forces = file.contact_forces.as_ref().map(|forces| whole(draft, "contact_forces", forces));
    let contact_forces = contact_forces.transpose()?;
    let failed = |key| {
        move |error: ImportError| {
            let failure = error.failure();
            Failure::new(failure.exit, format!("start.{key}: {failure}"))
        }
    };
    let given = ImportOptions {
        contact_forces: contact_forces.as_deref().map(text).transpose().map_err(failed("contact_forces"))?,
        contact_columns: file.contact_columns.clone(),
        default_law: draft.law(),
        frames: file.step.map_or(Frames::Last, Frames::Step),
        ..ImportOptions::default()
    };
    let found = match pick(&path, file.step, &given) {
        Err(error) => match missing(&error) {
            Some(missing) => pick(&path, file.step, &of_scene(draft, missing, given)),
            None => Err(error),
        },
        found => found,
    };
    let (found, sign) = found.map_err(|e| match missing(&e) {
        Some(_) => Failure::usage(format!(
            "start.packing: {e}; name shear_modulus, poisson_ratio and density under [material], and the friction of the \
             first phase"
        )),
        None => failed("packing")(e),
    })?;
    let Imported { packing, step, rounding, mut notes, .. } = match (found, file.step) {
        (Picked::One(found), Some(_)) => *found,
        (Picked::One(found), None) => {
            if let Some(sign) = several_runs(&path, sign) {
                let several = SeveralRuns { path, sign };
                return Err(Failure::usage(format!(
                    "start.packing: {several}; or name the packing by start.step, if only one run has it"
                )));
            }
            *found
        }
        (Picked::Several, step) => {
            return Err(Failure::usage(format!(
                "start.step: {} has several different packings of step {}: it is of several runs. Name the file of one of them",
                path.display(),
                step.unwrap_or_default()
            )));
        }
        (Picked::None, step) => {
            let (path, step) = (path.display(), step.unwrap_or_default());
            return Err(Failure::usage(format!("start.step: {path} has no packing of step {step}")));
        }
    };
    if let Some(fault) = packing.overlap_fault() {
        return Err(Failure::new(
            Exit::PhysicsInvalid,
            format!("start.packing: {}: {fault}", path.display()),
        ));
    }
    let difference = packing.law_difference();
    let explains = |rounding: &Rounding| difference <= rounding.of_forces(&packing);
    if difference > OTHER_LAW
        && let Some(blurred) = rounding.filter(explains).and_then(|rounding| rounding.noticeable(&packing))
    {
        return Err(Failure::failed(format!(
            "start.packing: {}: {blurred}. The run would begin with other forces than those of the file, which differ by {:.1} % on average \
             from the forces of the contact law at these positions; {ALL_DIGITS}",
            path.display(),
            100.0 * difference
        )));
    }
    let packing = copies(packing, file)?;
    notes.extend(draft.first_friction().and_then(|friction| cut(&packing, friction)));
    Ok(Start { packing, path, contact_forces, step, notes })
}

/// Memory that it takes to make and check the copies of a packing, over the memory of these.
const COPYING: f64 = 2.0;

fn copies(packing: Packing, file: &grainlab_scene::Start) -> Result<Packing, Failure> {
    let grains = file.grains_of_copies(packing.grains()).map_err(Failure::usage)?;
    if file.copies == 1 {
        return Ok(packing);
    }
    let bytes = packing.bytes() as f64 * grains as f64 / packing.grains() as f64;
    memory::require(COPYING * bytes, &format!("start.copies: a packing of {grains} grains takes"))?;
    let copied = packing.repeated(file.copies);
    copied.ok_or_else(|| Failure::usage("start.copies: the cell of the copies is invalid"))
}

fn whole(draft: &Draft, key: &'static str, file: &str) -> Result<PathBuf, Failure> {
    let folder = draft.source_of(key).map(Path::new).and_then(Path::parent).unwrap_or(Path::new(""));
    let path = folder.join(file);
    let failed = |e| Failure::failed(format!("start.{key}: {}: {e}", path.display()));
    path.canonicalize().map_err(failed)
}

enum Picked {
    None,
    One(Box<Imported>),
    /// Several different packings.
    Several,
}

/// The packing of this step, or the last one, and what shows that the packings before it are of several runs.
fn pick(
    path: &Path,
    step: Option<u64>,
    options: &ImportOptions,
) -> Result<(Picked, Option<RunSign>), ImportError> {
    let (mut found, mut run, mut sign) = (Picked::None, OneRun::default(), None);
    each(path, options, &mut |imported| {
        sign = sign.take().or_else(|| run.packing("", &imported.packing).err());
        match (&found, step) {
            (_, Some(step)) if step != imported.step => {}
            (Picked::One(first), Some(_)) => {
                // A restarted simulator may publish it again.
                if state(&first.packing) != state(&imported.packing) {
                    found = Picked::Several;
                    return ControlFlow::Break(());
                }
            }
            _ => found = Picked::One(Box::new(imported)),
        }
        ControlFlow::Continue(())
    })?;
    Ok((found, sign))
}

/// Sign that a recording is of several runs. The frames of other files may be in any order.
fn several_runs(path: &Path, sign: Option<RunSign>) -> Option<RunSign> {
    let recording = Recording::open(path).ok()?;
    sign.or_else(|| OneRun::scenes(&recording).err())
}

fn missing(error: &ImportError) -> Option<&[Setting]> {
    match error {
        ImportError::Missing(settings) => Some(settings),
        ImportError::In { source, .. } => missing(source),
        _ => None,
    }
}

fn of_scene(draft: &Draft, missing: &[Setting], forces: ImportOptions) -> ImportOptions {
    let given = |setting, value: Option<f64>| value.filter(|_| missing.contains(&setting));
    ImportOptions {
        shear_modulus: given(Setting::ShearModulus, draft.material("shear_modulus")),
        poisson_ratio: given(Setting::PoissonRatio, draft.material("poisson_ratio")),
        density: given(Setting::Density, draft.material("density")),
        friction: given(Setting::Friction, draft.first_friction()),
        ..forces
    }
}

/// A warning of contacts that the friction of the first phase cannot hold.
fn cut(packing: &Packing, friction: f64) -> Option<String> {
    let slides = |c: &&Contact| c.tangential_force.norm() > 1.001 * friction * c.normal_force;
    let count = packing.contacts.iter().filter(slides).count();
    (friction > 0.0 && count > 0).then(|| {
        format!(
            "{count} of {} contacts carry more tangential force than the friction {friction} of the first phase holds: they slide at \
             once, and the run does not begin at the stress of the packing",
            packing.contacts.len()
        )
    })
}
