//! Why a request is invalid.

/// Why a request is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ServoError {
    /// A component of a six-component quantity is not finite.
    #[error("{field}[{component}] = {value} is not finite; the simulation that sent it is unstable")]
    ComponentNotFinite {
        /// Name of the quantity.
        field: &'static str,
        /// Name of the component: xx, yy, zz, yz, xz or xy.
        component: &'static str,
        /// Value of the quantity.
        value: f64,
    },
    /// A number that must be positive and finite is not.
    #[error("{field} = {value:e} {unit} must be positive and finite")]
    NotPositive {
        /// Name of the quantity.
        field: &'static str,
        /// Value of the quantity.
        value: f64,
        /// Unit of the quantity.
        unit: &'static str,
    },
    /// The leak of the integral law is outside [0, 1].
    #[error("leak = {value} is outside [0, 1]; 0 is exactly Eq. 1, 1 resets the rate each control period")]
    Leak {
        /// Value of the quantity.
        value: f64,
    },
    /// The gain over the critical gain is not between 0 and 1.
    #[error(
        "share = {value} of the critical gain is outside (0, 1): from 1 on the stress error grows every control period"
    )]
    Share {
        /// Value of the quantity.
        value: f64,
    },
    /// The gain of Eq. 1 is not below the critical one.
    #[error(
        "gain = {gain:e} 1/(Pa s) is not below {critical:e} 1/(Pa s), where Eq. 1 becomes unstable with the present \
         contacts and a control interval of {control_interval:e} s: reduce the gain, shorten control_period, or use \
         law = \"normalised\""
    )]
    Gain {
        /// Gain of Eq. 1, 1/(Pa s).
        gain: f64,
        /// The critical gain, 1/(Pa s).
        critical: f64,
        /// Simulated time between requests, s.
        control_interval: f64,
    },
    /// A tangent stiffness is negative.
    #[error(
        "tangent[{component}] = {value:e} Pa is negative: send the affine stiffness of the contacts, or 0 for none"
    )]
    NegativeTangent {
        /// Name of the component.
        component: &'static str,
        /// The value found, Pa.
        value: f64,
    },
    /// A law that needs the tangent stiffness of the contacts, from an engine that does not measure it.
    #[error("the engine does not measure the tangent stiffness: use law = \"integral\", which needs none")]
    NoTangent,
    /// The stiffness-scaled law would overshoot by more than the error it corrects.
    #[error(
        "control_interval = {control_interval:e} s is not below twice response_time = {response_time:e} s, so the \
         stiffness-scaled law would diverge: lengthen response_time or shorten control_period"
    )]
    Unstable {
        /// Simulated time between requests, s.
        control_interval: f64,
        /// Response time of the law, s.
        response_time: f64,
    },
}
