//! Settings of the engine during a phase.

use crate::error::EngineError;
use grainlab_core::contact::{SpringDashpotSlider, TangentialLaw};

/// The parts of the contact law that a phase needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Features {
    /// No friction: no spins, no tangential springs.
    Frictionless,
    /// Tangential springs with the Coulomb limit.
    Sliding,
    /// Tangential springs that never slide (infinite friction).
    NoSlip,
}

/// Choice of the time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeStep {
    /// This fraction of the stability bound, followed as contacts stiffen.
    FractionOfStable(f64),
    /// Exactly this, s. Too long a step ends in [`EngineError::Unstable`].
    Fixed(f64),
}

/// Settings of the engine during a phase.
///
/// The default is frictionless and without any dissipation, at 0.8 of the stable time step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EngineSettings {
    /// Friction coefficient, 0 to infinity.
    pub friction: f64,
    /// Contact damping, as a fraction of critical.
    pub damping: f64,
    /// Drag on velocities relative to the affine motion, 1/s.
    pub drag: f64,
    /// Drag on spins, 1/s.
    pub spin_drag: f64,
    /// Response of the tangential force to a change of normal stiffness.
    pub tangential: TangentialLaw,
    /// Choice of the time step.
    pub time_step: TimeStep,
    /// Verlet skin, m. Zero is valid: the neighbours are then found in every step.
    pub skin: f64,
    /// Thermostat of a gas: velocities are scaled down where their root mean square exceeds this, m/s.
    pub thermostat_speed: Option<f64>,
}

impl Default for TimeStep {
    fn default() -> Self {
        Self::FractionOfStable(0.8)
    }
}

impl EngineSettings {
    /// Checks that every setting is in its range.
    ///
    /// # Errors
    /// The first setting that is not, by name.
    pub fn check(&self) -> Result<(), EngineError> {
        let not_negative = |name, value: f64| {
            let sound = value >= 0.0 && value.is_finite();
            if sound { Ok(()) } else { Err(EngineError::Setting { name, value, requirement: "0 or more" }) }
        };
        // Infinite friction is one without sliding.
        not_negative("friction", if self.friction == f64::INFINITY { 0.0 } else { self.friction })?;
        not_negative("damping", self.damping)?;
        not_negative("drag", self.drag)?;
        not_negative("spin_drag", self.spin_drag)?;
        not_negative("skin", self.skin)?;
        not_negative("thermostat_speed", self.thermostat_speed.unwrap_or(0.0))?;
        let (TimeStep::FractionOfStable(step) | TimeStep::Fixed(step)) = self.time_step;
        if step > 0.0 && step.is_finite() {
            return Ok(());
        }
        Err(EngineError::Setting { name: "time_step", value: step, requirement: "more than 0" })
    }

    /// Returns the contact law with these springs.
    pub fn law<S>(&self, springs: S) -> SpringDashpotSlider<S> {
        let &Self { friction, damping, tangential, .. } = self;
        SpringDashpotSlider { springs, friction, damping, kept: tangential.kept() }
    }

    /// Returns the parts of the contact law that these settings need.
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
