//! Parameters of the node.

use grainlab_node_kit::{ParameterSpec, Parameters, Range};

/// The parameters of the node.
pub fn parameters() -> Vec<ParameterSpec> {
    let most = i64::from(u8::MAX);
    vec![
        ParameterSpec::new(
            "min_readers",
            1_i64,
            "number of readers of strain_rate to wait for before the first answer, 1",
        )
        .within(Range::Integer { min: 0, max: most }),
    ]
}

/// The values of the parameters. None of them changes an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Number of readers of `strain_rate` to wait for before the first answer, so that a recorder does not miss it.
    pub min_readers: usize,
}

/// The declared defaults.
impl Default for Settings {
    fn default() -> Self {
        Self::from(&Parameters::defaults(&parameters()))
    }
}

impl From<&Parameters> for Settings {
    fn from(parameters: &Parameters) -> Self {
        Self { min_readers: parameters.get::<i64>("min_readers").unsigned_abs() as usize }
    }
}
