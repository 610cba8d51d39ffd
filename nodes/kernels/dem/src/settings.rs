//! What the engine is set to during a phase.

use grainlab_core::contact::TangentialLaw;

/// The parts of the contact law that a phase needs. The force kernel is compiled for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Features {
    /// No friction: no spins, no tangential springs.
    Frictionless,
    /// Tangential springs with the Coulomb limit.
    Sliding,
    /// Tangential springs that never slide (infinite friction).
    NoSlip,
}

/// How the time step is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeStep {
    /// This fraction of the stability bound, followed as contacts stiffen.
    FractionOfStable(f64),
    /// Exactly this, s. Too long a step ends in [`DemError::Unstable`](crate::DemError::Unstable).
    Fixed(f64),
}

/// What the engine is set to during a phase.
///
/// The default is frictionless and without any dissipation, at 0.8 of the stable time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngineSettings {
    /// Friction coefficient, 0 to infinity.
    pub friction: f64,
    /// Contact damping, as a fraction of critical.
    pub damping: f64,
    /// Drag on velocities relative to the affine motion, 1/s.
    pub drag: f64,
    /// Drag on spins, 1/s.
    pub spin_drag: f64,
    /// How the tangential force follows a change of normal stiffness.
    pub tangential: TangentialLaw,
    /// How the time step is chosen.
    pub time_step: TimeStep,
    /// Verlet skin, m. Zero is valid: the neighbours are then found in every step.
    pub skin: f64,
    /// Thermostat of a gas: velocities are scaled down where their root mean square exceeds this, m/s.
    pub thermostat_speed: Option<f64>,
}

impl Default for EngineSettings {
    fn default() -> Self {
        Self {
            friction: 0.0,
            damping: 0.0,
            drag: 0.0,
            spin_drag: 0.0,
            tangential: TangentialLaw::Rescaled,
            time_step: TimeStep::FractionOfStable(0.8),
            skin: 0.0,
            thermostat_speed: None,
        }
    }
}

impl EngineSettings {
    /// The parts of the contact law that these settings need.
    pub fn features(&self) -> Features {
        if self.friction == 0.0 {
            Features::Frictionless
        } else if self.friction.is_infinite() {
            Features::NoSlip
        } else {
            Features::Sliding
        }
    }
}
