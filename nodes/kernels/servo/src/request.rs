//! A request of the lockstep.

use crate::input::ServoInput;
use grainlab_core::SymTensor;

/// One request for a strain rate: the input of the servo, and the state of the run that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoRequest {
    /// Counts requests from 0.
    pub sequence: u64,
    /// Solver steps done.
    pub step: u64,
    /// Number of the phase in the loading path, from 1.
    pub phase: u32,
    /// Simulated time, s.
    pub time: f64,
    /// Everything that the control law uses.
    pub input: ServoInput,
    /// Largest |σ_ij − σ_ji| before the symmetric part was taken, Pa. 0 or more.
    pub asymmetry: f64,
    /// Logarithmic strain, positive in extension, since the reference state; since the first step of the run until a phase
    /// sets one.
    pub strain: SymTensor,
    /// Solid fraction φ. More than 0.
    pub solid_fraction: f64,
    /// Coordination number k = 2 contacts/grains. 0 or more.
    pub coordination: f64,
    /// Mean net force of non-rattlers over mean contact force, 1 without contacts.
    pub unbalanced: f64,
}
