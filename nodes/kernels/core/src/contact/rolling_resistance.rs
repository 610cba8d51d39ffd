//! Coefficients of rolling resistance: a spring, a dashpot and a slider against the relative rolling of two grains.

use super::law_parameter::LawParameter;

/// Coefficients of rolling resistance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingResistance {
    /// Rolling stiffness k, N/m. Positive.
    pub stiffness: f64,
    /// Coefficient of the rolling dashpot γ, N s/m. Zero or positive.
    pub damping: f64,
    /// Rolling friction coefficient μ: largest rolling force over the normal force. Positive.
    pub friction: f64,
}

impl RollingResistance {
    /// No resistance to rolling.
    pub const NONE: Self = Self { stiffness: 0.0, damping: 0.0, friction: 0.0 };

    /// Parameters in scenes and messages, in the order of the fields.
    pub const PARAMETERS: [LawParameter; 3] = [
        LawParameter::new(
            "rolling_stiffness",
            "N/m",
            "rolling stiffness: rolling force over rolling displacement",
            None,
            LawParameter::POSITIVE,
        ),
        LawParameter::new(
            "rolling_damping",
            "N s/m",
            "coefficient of the rolling dashpot: rolling force over rolling velocity",
            Some(0.0),
            LawParameter::FROM_ZERO,
        ),
        LawParameter::new(
            "rolling_friction",
            "",
            "rolling friction coefficient: largest rolling force over the normal force",
            None,
            LawParameter::POSITIVE,
        ),
    ];

    /// Parameters, in the order of the list.
    pub fn parameters(&self) -> [f64; 3] {
        [self.stiffness, self.damping, self.friction]
    }

    /// The resistance with these parameters, in the order of the list.
    pub fn from_parameters([stiffness, damping, friction]: [f64; 3]) -> Self {
        Self { stiffness, damping, friction }
    }
}
