//! The part of a run's state that is not in the packing: loading path, accumulated strain, present rate. It is stored as
//! JSON with names and a version, so that a recording is also a checkpoint.

use crate::error::ExperimentError;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use grainlab_core::Packing;
use grainlab_core::results::PackingReport;
use grainlab_engine::EngineProgram;
use grainlab_scene::Scene;
use serde::{Deserialize, Serialize};

const VERSION: u32 = 4;

/// Everything besides the packing that a run needs to continue bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RunState {
    pub(crate) version: u32,
    /// FNV-1a of the canonical text of the scene: a state can be resumed only in the scene that it came from.
    pub(crate) scene: u64,
    pub(crate) sequence: u64,
    pub(crate) packings: u64,
    /// Index of the phase.
    pub(crate) phase: usize,
    /// Simulated time at which the phase began, s.
    pub(crate) began: f64,
    /// Simulated time since which its end conditions hold, s.
    pub(crate) holding_since: Option<f64>,
    /// Simulated time, s: the stamp of the packing has whole nanoseconds.
    pub(crate) time: f64,
    /// Strain rate in force, 1/s.
    pub(crate) rate: [f64; 6],
    /// Deformation gradient since the start of the phase, by columns.
    pub(crate) phase_deformation: [[f64; 3]; 3],
    /// Integral over time of the largest component of the strain rate since the start of the phase.
    pub(crate) phase_strain: f64,
    /// State that the deformation of the packing counts from.
    pub(crate) strain_origin: StrainOrigin,
    /// The state is within a phase, not at the end of one.
    pub(crate) within_phase: bool,
    /// The engine that made the packing, if it is not ours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) engine: Option<SavedEngine>,
}

/// An engine and the state that the packing cannot hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SavedEngine {
    pub(crate) program: EngineProgram,
    /// Bytes of the state as base64.
    state: String,
}

impl SavedEngine {
    pub(crate) fn new(program: &EngineProgram, own_state: &[u8]) -> Self {
        Self { program: program.clone(), state: BASE64_STANDARD.encode(own_state) }
    }

    pub(crate) fn own_state(&self) -> Result<Vec<u8>, ExperimentError> {
        let damaged = |e| ExperimentError::Resume(format!("the state of {} is damaged: {e}", self.program));
        BASE64_STANDARD.decode(&self.state).map_err(damaged)
    }
}

/// The engine that made a packing with this run state; `None` if it is ours, or there is no run state.
pub fn engine_program(run_state: &[u8]) -> Option<EngineProgram> {
    Some(RunState::decode(run_state).ok()?.engine?.program)
}

impl RunState {
    pub(crate) const CURRENT: u32 = VERSION;

    pub(crate) fn encode(&self) -> Vec<u8> {
        // Numbers and names only: it cannot fail.
        serde_json::to_vec(self).unwrap_or_default()
    }

    pub(crate) fn decode(bytes: &[u8]) -> Result<Self, ExperimentError> {
        let resume = |m: String| Err(ExperimentError::Resume(m));
        if bytes.is_empty() {
            return resume("the packing carries no run state (it was not made by a simulation)".into());
        }
        #[derive(Deserialize)]
        struct Version {
            version: u32,
        }
        match serde_json::from_slice(bytes) {
            Ok(Version { version: VERSION }) => {}
            Ok(Version { version }) => {
                return resume(format!("run state version {version}, this program reads version {VERSION}"));
            }
            Err(_) if of_version_3(bytes).is_some() => {
                return resume(format!("run state version 3, this program reads version {VERSION}"));
            }
            Err(error) => return resume(format!("the run state is damaged: {error}")),
        }
        serde_json::from_slice(bytes)
            .map_err(|error| ExperimentError::Resume(format!("the run state is damaged: {error}")))
    }
}

/// Holds a packing against the scene that made it. A scene that starts from a packing takes grains and law from that.
///
/// # Errors
/// Another number of grains, another material or law, or a friction of no phase.
pub(crate) fn belongs(packing: &Packing, scene: &Scene) -> Result<(), ExperimentError> {
    if scene.start.is_some() {
        return Ok(());
    }
    let same = [
        ("number of grains", packing.grains() == scene.grains as usize),
        ("material", packing.material == scene.material),
        ("contact law", packing.law == scene.law),
        ("friction", scene.phases.iter().any(|p| p.friction == packing.friction)),
    ];
    match same.iter().find(|(_, same)| !same) {
        None => Ok(()),
        Some((what, _)) => Err(ExperimentError::Resume(format!(
            "the {what} of the packing is not that of the scene; begin a scene with a changed packing by its key start"
        ))),
    }
}

/// State that the strain of a packing counts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StrainOrigin {
    /// The state that a phase set as the reference.
    Reference,
    /// The first step of the run: no phase has set a reference.
    FirstStep,
    /// None: an earlier version recorded the packing before a reference was set, as not strained.
    Unknown,
}

/// Position of a packing on the loading path of its run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathPosition {
    /// Number of the phase, from 1; 0 for the packing that the run started from.
    pub phase: usize,
    /// The phase met its end conditions at this packing. A packing within a phase, recorded on the way or saved by an
    /// interruption, need not be at rest.
    pub end_of_phase: bool,
    /// State that the strain of the packing counts from.
    pub strain_origin: StrainOrigin,
}

impl PathPosition {
    /// The position in the run state of a packing; `None` if the packing has no run state.
    pub fn of(run_state: &[u8]) -> Option<Self> {
        let Ok(state) = RunState::decode(run_state) else { return of_version_3(run_state) };
        Some(Self::new(state.phase, state.within_phase, state.strain_origin))
    }

    /// `next` is the index of the phase that the run is in.
    fn new(next: usize, within_phase: bool, strain_origin: StrainOrigin) -> Self {
        Self { phase: next + usize::from(within_phase), end_of_phase: !within_phase, strain_origin }
    }

    /// A warning about a packing that was recorded within a phase.
    pub fn warning(&self) -> Option<String> {
        let phase = self.phase;
        (!self.end_of_phase).then(|| {
            format!("recorded within phase {phase}, which had not met its end conditions: the packing need not be at rest")
        })
    }

    /// Removes from the report of the packing what its strain does not tell: gamma/Delta of the strain from a state that no
    /// phase has set as the reference, and a strain that was not counted.
    pub fn judge_strain(&self, report: &mut PackingReport) {
        if self.strain_origin != StrainOrigin::Reference {
            report.strain_ratios.total = None;
        }
        if self.strain_origin == StrainOrigin::Unknown {
            report.strain = None;
        }
    }
}

/// The position in a run state of version 3, 26 words by position, so that older recordings are still analyzed.
fn of_version_3(bytes: &[u8]) -> Option<PathPosition> {
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
    Some(PathPosition::new(phase, bits & 2 != 0, strain_origin))
}
