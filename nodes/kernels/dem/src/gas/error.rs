//! Errors of gases.

/// Why a gas cannot begin or go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GasError {
    /// The grains do not fit at the solid fraction asked for.
    #[error(
        "could not place grain {placed} of {grains} at random at a solid fraction of {solid_fraction}; lower initial_solid_fraction"
    )]
    Placement {
        /// Grains placed so far.
        placed: u32,
        /// Grains asked for.
        grains: u32,
        /// Solid fraction asked for.
        solid_fraction: f64,
    },
    /// The state is not a gas of hard spheres.
    #[error("the event-driven gas cannot take up this state: {0}")]
    HardSpheres(String),
    /// The hard spheres are jammed.
    #[error(
        "the event-driven gas jammed at a solid fraction of {solid_fraction:.4}: {cause}; end the gas phase at a lower \
         solid fraction"
    )]
    Jammed {
        /// Solid fraction reached.
        solid_fraction: f64,
        /// Sign that it is jammed.
        cause: String,
    },
    /// The caller stopped the computation.
    #[error("the computation was stopped")]
    Stopped,
}
