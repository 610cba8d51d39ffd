//! The position of a packing on the loading path of its run.

use crate::notes::Note;
use std::fmt;

/// The position of a packing on the loading path of its run, and the engine that made the packing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathPosition {
    /// Number of the phase, from 1; 0 for the packing that the run started from.
    pub phase: usize,
    /// True if the phase met its end conditions at this packing. A packing within a phase, recorded on the way or saved by an
    /// interruption, need not be at rest.
    pub end_of_phase: bool,
    /// The state that the strain of the packing counts from.
    pub strain_origin: StrainOrigin,
    /// The engine that made the packing, if it is not ours.
    pub engine: Option<EngineProgram>,
}

/// The state that the strain of a packing counts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrainOrigin {
    /// The state that a phase set as the reference.
    Reference,
    /// The first step of the run: no phase has set a reference.
    FirstStep,
    /// None: an earlier version recorded the packing before a reference was set, as not strained.
    Unknown,
}

/// The program of an engine that is not ours.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EngineProgram {
    /// Name, as a run names its engine.
    pub name: String,
    /// Version, as the program states it.
    pub version: String,
    /// Number of its processes.
    pub ranks: u32,
}

impl fmt::Display for EngineProgram {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, version, ranks } = self;
        write!(f, "{name} {version}, {ranks} {}", if *ranks == 1 { "rank" } else { "ranks" })
    }
}

impl PathPosition {
    /// Returns the position of a run in the phase with the index `next`, counted from 0, or at the end of the phase before it.
    pub fn new(
        next: usize,
        within_phase: bool,
        strain_origin: StrainOrigin,
        engine: Option<EngineProgram>,
    ) -> Self {
        let phase = next + usize::from(within_phase);
        Self { phase, end_of_phase: !within_phase, strain_origin, engine }
    }

    /// Returns a note on a packing that was recorded within a phase.
    pub fn note(&self) -> Option<Note> {
        (!self.end_of_phase).then(|| Note::within_phase(self.phase as f64))
    }
}
