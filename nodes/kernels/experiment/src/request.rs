//! Requests of a run to its servo, and outcomes of the strain rates that answer them.

use grainlab_core::{ComponentControl, ServoLaw, SymTensor};
use grainlab_dem::{EnergyBalance, Observables};

/// A request for a strain rate, with all data for the servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoRequest {
    /// Counts requests from 0.
    pub sequence: u64,
    /// Solver steps done.
    pub step: u64,
    /// Simulated time, s.
    pub time: f64,
    /// Index of the present phase.
    pub phase: u32,
    /// Observation of the contacts.
    pub observables: Observables,
    /// What is imposed on each component.
    pub controls: [ComponentControl; 6],
    /// Strain rate in force, Voigt order, 1/s.
    pub rate: [f64; 6],
    /// Largest magnitude of a component that the phase allows, 1/s.
    pub rate_limit: f64,
    /// Control law of the phase.
    pub law: ServoLaw,
    /// Simulated time until the next request, s.
    pub control_interval: f64,
    /// Logarithmic strain since the reference state; since the first step of the run until a phase sets one.
    pub strain: SymTensor,
}

impl ServoRequest {
    /// The part of the request that the law of the servo uses.
    pub fn servo_input(&self) -> grainlab_servo::ServoInput {
        grainlab_servo::ServoInput {
            stress: self.observables.stress.tensor,
            controls: self.controls,
            rate: self.rate,
            rate_limit: self.rate_limit,
            law: self.law,
            tangent: self.observables.tangent,
            control_interval: self.control_interval,
        }
    }
}

/// The result of one control period.
#[derive(Clone, Debug, PartialEq)]
pub struct StepOutcome {
    /// Name of the phase that ended, if one did.
    pub ended: Option<String>,
    /// The packing is due for publication.
    pub packing_due: bool,
    /// The path is done.
    pub finished: bool,
    /// Energy balance since the start of the phase, if the scene asks for it.
    pub energy: Option<EnergyBalance>,
}
