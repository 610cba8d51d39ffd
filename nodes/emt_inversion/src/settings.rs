//! What can be set.

use emt::GammaSource;
use node_kit::{ParameterSpec, Parameters, Range};

/// The parameters of the node.
pub fn parameters() -> Vec<ParameterSpec> {
    let description = "relative one-sigma error of G12, G13 and Theta where the data bring no covariance, 1; 0 leaves \
                       the uncertainty of the estimates unknown";
    vec![
        ParameterSpec::new("modulus_error", Settings::default().modulus_error, description)
            .within(Range::Double { min: 0.0, max: 1.0 }),
        ParameterSpec::new(
            "gamma_over_delta",
            "total",
            "which measured strain ratio feeds the models; where it is not known, contact, else zero",
        )
        .within(Range::Choice(&["total", "elastic", "contact", "zero"])),
    ]
}

/// The parameters, typed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Relative one-sigma error, independent for each of G12, G13 and Θ, taken where the data bring no covariance. 0
    /// leaves the uncertainty of the estimates unknown.
    pub modulus_error: f64,
    /// Which of the measured strain ratios γ/Δ feeds the models. The paper takes the total one, which is mostly plastic
    /// history; the one fitted to the contacts is what its Eq. 10 stands for.
    pub gamma: GammaSource,
}

/// One percent: what a good resonant or ultrasonic measurement of a modulus reaches, so that the one-sigma of an estimate
/// reads "if these moduli had come from an instrument".
impl Default for Settings {
    fn default() -> Self {
        Self { modulus_error: 0.01, gamma: GammaSource::Total }
    }
}

impl From<&Parameters> for Settings {
    fn from(parameters: &Parameters) -> Self {
        let gamma = match parameters.get::<String>("gamma_over_delta").as_str() {
            "elastic" => GammaSource::Elastic,
            "contact" => GammaSource::Contact,
            "zero" => GammaSource::Zero,
            _ => GammaSource::Total,
        };
        Self { modulus_error: parameters.get("modulus_error"), gamma }
    }
}
