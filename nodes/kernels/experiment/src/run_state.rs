//! The part of a run's state that is not in the packing: loading path, accumulated strain, present rate. It is stored as
//! JSON with names and a version, so that a recording is also a checkpoint.

use crate::error::ExperimentError;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use grainlab_core::{EngineProgram, Packing, StrainOrigin};
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
    #[serde(with = "Origin")]
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
    #[serde(with = "Program")]
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

#[derive(Serialize, Deserialize)]
#[serde(remote = "EngineProgram")]
struct Program {
    name: String,
    version: String,
    ranks: u32,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "StrainOrigin", rename_all = "snake_case")]
enum Origin {
    Reference,
    FirstStep,
    Unknown,
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
            // Version 3 has 26 words, the first of which is the version.
            Err(_) if bytes.len() == 26 * 8 && bytes.starts_with(&3u64.to_le_bytes()) => {
                return resume(format!("run state version 3, this program reads version {VERSION}"));
            }
            Err(error) => return resume(format!("the run state is damaged: {error}")),
        }
        serde_json::from_slice(bytes)
            .map_err(|error| ExperimentError::Resume(format!("the run state is damaged: {error}")))
    }
}

/// Accepts every packing where the scene starts from one: it takes grains and law from that packing.
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
