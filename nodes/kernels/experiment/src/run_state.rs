//! The part of a run's state that is not in the packing: loading path, accumulated strain, present rate. It
//! is stored as opaque bytes with a version, so that a recording is also a checkpoint.

use crate::error::ExperimentError;
use grainlab_core::Mat3;
use grainlab_core::results::PackingReport;
use grainlab_scene::PathState;

const VERSION: u64 = 3;

/// Everything besides the packing that a run needs to continue bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RunState {
    pub(crate) sequence: u64,
    pub(crate) packings: u64,
    pub(crate) path: PathState,
    pub(crate) time: f64,
    pub(crate) rate: [f64; 6],
    /// Deformation gradient since the start of the phase.
    pub(crate) phase_deformation: Mat3,
    /// Integral over time of the largest component of the strain rate since the start of the phase.
    pub(crate) phase_strain: f64,
    /// What the deformation of the packing counts from.
    pub(crate) strain_origin: StrainOrigin,
    /// The state is within a phase, not at the end of one.
    pub(crate) within_phase: bool,
    /// Fingerprint of the scene: a state can be resumed only in the scene that it came from.
    pub(crate) scene: u64,
}

impl RunState {
    pub(crate) fn encode(&self) -> Vec<u8> {
        let p = &self.path;
        let mut words: Vec<u64> = vec![
            VERSION,
            self.sequence,
            self.packings,
            p.phase as u64,
            p.began.to_bits(),
            u64::from(p.holding_since.is_some()),
            p.holding_since.unwrap_or(0.0).to_bits(),
            self.time.to_bits(),
            self.strain_origin.bits() | u64::from(self.within_phase) << 1,
            self.scene,
        ];
        words.extend(self.rate.iter().map(|r| r.to_bits()));
        words.extend(self.phase_deformation.iter().map(|r| r.to_bits()));
        words.push(self.phase_strain.to_bits());
        words.iter().flat_map(|w| w.to_le_bytes()).collect()
    }

    pub(crate) fn decode(bytes: &[u8]) -> Result<Self, ExperimentError> {
        let words: Vec<u64> = bytes
            .chunks_exact(8)
            .map(|c| u64::from_le_bytes([c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]]))
            .collect();
        let resume = |m: String| ExperimentError::Resume(m);
        match words.first() {
            None => {
                return Err(resume(
                    "the packing carries no run state (it was not made by a simulation)".into(),
                ));
            }
            Some(&VERSION) => {}
            Some(v) => {
                return Err(resume(format!("run state version {v}, this program reads version {VERSION}")));
            }
        }
        if words.len() != 26 || !bytes.len().is_multiple_of(8) {
            return Err(resume(format!("the run state has {} bytes, 208 expected", bytes.len())));
        }
        let real = |k: usize| f64::from_bits(words[k]);
        let rate: [f64; 6] = std::array::from_fn(|k| real(10 + k));
        let phase_deformation = Mat3::from_fn(|r, c| real(16 + 3 * c + r));
        if ![4, 6, 7, 25].iter().all(|k| real(*k).is_finite())
            || !rate.iter().chain(phase_deformation.iter()).all(|v| v.is_finite())
        {
            return Err(resume("the run state holds numbers that are not finite".into()));
        }
        let path = PathState {
            phase: words[3] as usize,
            began: real(4),
            holding_since: (words[5] != 0).then_some(real(6)),
        };
        let (sequence, packings, time, scene) = (words[1], words[2], real(7), words[9]);
        Ok(Self {
            sequence,
            packings,
            path,
            time,
            rate,
            phase_deformation,
            phase_strain: real(25),
            strain_origin: StrainOrigin::of(words[8]),
            within_phase: words[8] & 2 != 0,
            scene,
        })
    }
}

/// What the strain of a packing counts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrainOrigin {
    /// The state that a phase set as the reference.
    Reference,
    /// The first step of the run: no phase has set a reference.
    FirstStep,
    /// Nothing: an earlier version recorded the packing before a reference was set, as not strained.
    Unknown,
}

impl StrainOrigin {
    /// Bit 0: a reference is set; bit 2: without one, strain counts from the first step.
    fn bits(self) -> u64 {
        match self {
            Self::Reference => 1,
            Self::FirstStep => 4,
            Self::Unknown => 0,
        }
    }

    fn of(word: u64) -> Self {
        match (word & 1 != 0, word & 4 != 0) {
            (true, _) => Self::Reference,
            (false, true) => Self::FirstStep,
            (false, false) => Self::Unknown,
        }
    }
}

/// Position of a packing on the loading path of its run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathPosition {
    /// Number of the phase, from 1; 0 for the packing that the run started from.
    pub phase: usize,
    /// The phase met its end conditions at this packing. A packing within a phase, recorded on the way or saved by an
    /// interruption, need not be at rest.
    pub end_of_phase: bool,
    /// What the strain of the packing counts from.
    pub strain_origin: StrainOrigin,
}

impl PathPosition {
    /// The position in the run state of a packing; `None` if the packing has no run state of this version.
    pub fn of(run_state: &[u8]) -> Option<Self> {
        let state = RunState::decode(run_state).ok()?;
        let (next, end_of_phase) = (state.path.phase, !state.within_phase);
        let phase = if end_of_phase { next } else { next + 1 };
        Some(Self { phase, end_of_phase, strain_origin: state.strain_origin })
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
