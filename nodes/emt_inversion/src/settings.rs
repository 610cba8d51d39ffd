//! What can be set.

use node_kit::{ParameterSpec, Parameters, Range};

/// The parameters of the node.
pub fn parameters() -> Vec<ParameterSpec> {
    let description = "relative one-sigma error of G12, G13 and Theta where the data bring no covariance, 1; 0 leaves \
                       the uncertainty of the estimates unknown";
    vec![
        ParameterSpec::new("modulus_error", Settings::default().modulus_error, description)
            .within(Range::Double { min: 0.0, max: 1.0 }),
    ]
}

/// The parameters, typed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Relative one-sigma error, independent for each of G12, G13 and Θ, taken where the data bring no covariance. 0
    /// leaves the uncertainty of the estimates unknown.
    pub modulus_error: f64,
}

/// One percent: what a good resonant or ultrasonic measurement of a modulus reaches, so that the one-sigma of an estimate
/// reads "if these moduli had come from an instrument".
impl Default for Settings {
    fn default() -> Self {
        Self { modulus_error: 0.01 }
    }
}

impl From<&Parameters> for Settings {
    fn from(parameters: &Parameters) -> Self {
        Self { modulus_error: parameters.get("modulus_error") }
    }
}
