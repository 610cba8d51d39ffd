//! Why wave speeds give no moduli.

/// Why wave speeds give no moduli.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ChristoffelError {
    /// The list of speeds is empty.
    #[error("there are no wave speeds: give at least one")]
    NoSpeeds,
    /// The axis of symmetry is not known.
    #[error("the symmetry axis is not known: give it, or find it first")]
    AxisUnknown,
    /// A vector that is not a unit vector.
    #[error("{vector} has the length {length}, and must be a unit vector")]
    NotUnit {
        /// Name of the vector, with its index in the list of speeds.
        vector: String,
        /// The length found.
        length: f64,
    },
    /// A speed, the density or one of their standard deviations is not positive and finite.
    #[error("{what} = {value} {requirement}")]
    Number {
        /// Name of the number, with its index in the list of speeds.
        what: String,
        /// The value found.
        value: f64,
        /// Unit of the value, and requirement.
        requirement: &'static str,
    },
    /// A polarization between the modes of its direction.
    #[error(
        "speeds[{index}].polarization is {degrees:.0} degrees from the nearest mode of its direction, more than the 30 \
         within which a mode is identified: give the particle motion of one mode"
    )]
    Ambiguous {
        /// Index in the list of speeds.
        index: usize,
        /// Angle between the given polarization and that of the nearest mode, degrees.
        degrees: f64,
    },
    /// No stable medium has these speeds.
    #[error(
        "the speeds give {moduli}, which no stable medium has: check for a speed of another mode, axis or state"
    )]
    Unstable {
        /// The moduli, as text.
        moduli: String,
    },
    /// The search for the medium did not converge.
    #[error("no medium was found for these speeds: check for a speed of another mode, axis or state")]
    NoMedium,
}

impl ChristoffelError {
    /// True if the data are missing or invalid, rather than inconsistent with the theory.
    pub fn is_input_error(&self) -> bool {
        !matches!(self, ChristoffelError::Unstable { .. } | ChristoffelError::NoMedium)
    }
}
