//! Paths of packings that earlier versions recorded: they are in the run state alone.

use grainlab_core::{EngineProgram, PathPosition, StrainOrigin};
use serde::Deserialize;

/// The part of a run state of version 4 that tells the path.
#[derive(Deserialize)]
struct Version4 {
    phase: usize,
    within_phase: bool,
    strain_origin: Origin,
    #[serde(default)]
    engine: Option<Engine>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Origin {
    Reference,
    FirstStep,
    Unknown,
}

#[derive(Deserialize)]
struct Engine {
    program: Program,
}

#[derive(Deserialize)]
struct Program {
    name: String,
    version: String,
    ranks: u32,
}

/// Returns the path in the run state of a packing that an earlier version recorded; `None` without a run state.
pub(super) fn earlier_path(run_state: &[u8]) -> Option<PathPosition> {
    let Ok(state) = serde_json::from_slice::<Version4>(run_state) else { return version_3(run_state) };
    let strain_origin = match state.strain_origin {
        Origin::Reference => StrainOrigin::Reference,
        Origin::FirstStep => StrainOrigin::FirstStep,
        Origin::Unknown => StrainOrigin::Unknown,
    };
    let engine = state.engine.map(|Engine { program: Program { name, version, ranks } }| EngineProgram {
        name,
        version,
        ranks,
    });
    Some(PathPosition::new(state.phase, state.within_phase, strain_origin, engine))
}

/// Returns the path in a run state of version 3: 26 words by position.
fn version_3(bytes: &[u8]) -> Option<PathPosition> {
    let (words, rest) = bytes.as_chunks::<8>();
    let word = |k: usize| words.get(k).copied().map(u64::from_le_bytes);
    if (words.len(), rest.len(), word(0)) != (26, 0, Some(3)) {
        return None;
    }
    let (phase, bits) = (usize::try_from(word(3)?).ok()?, word(8)?);
    let strain_origin = match (bits & 1 != 0, bits & 4 != 0) {
        (true, _) => StrainOrigin::Reference,
        (false, true) => StrainOrigin::FirstStep,
        (false, false) => StrainOrigin::Unknown,
    };
    Some(PathPosition::new(phase, bits & 2 != 0, strain_origin, None))
}
