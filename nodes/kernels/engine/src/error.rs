//! Errors of engines.

use grainlab_core::PackingError;
use grainlab_core::contact::UnknownLaw;

/// Why an engine cannot start or go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EngineError {
    /// A grain moved too far in one step, or its state is not finite.
    #[error(
        "unstable at step {step}: grain {grain} moves at {speed:e} m/s, more than a tenth of its radius in one step of \
         {time_step:e} s{cause}; lower the time step (in a scene: numerics.time_step_safety) or the strain rates"
    )]
    Unstable {
        /// Number of the solver step.
        step: u64,
        /// Persistent id of the grain.
        grain: u32,
        /// Speed of the grain, m/s; not finite if the state is lost.
        speed: f64,
        /// Time step, s.
        time_step: f64,
        /// The contact that pushed it, if one stands out.
        cause: String,
    },
    /// Two grains overlap far beyond the validity of Hertz's law.
    #[error(
        "at step {step} grains {first} and {second} overlap by {overlap:e} m, more than a tenth of a diameter; \
         lower the strain rates, the stress targets or the gas speed, or check the packing that the run starts from"
    )]
    Overlap {
        /// Number of the solver step.
        step: u64,
        /// Persistent id of the first grain.
        first: u32,
        /// Persistent id of the second grain.
        second: u32,
        /// Full overlap, m.
        overlap: f64,
    },
    /// The cell degenerated.
    #[error("the cell lost its volume at step {step}: the strain path leads nowhere")]
    Cell {
        /// Number of the solver step.
        step: u64,
    },
    /// A grain moved too many cell lengths for image numbers.
    #[error(
        "grain {grain} is, or would touch an image, more than 100 cells away: it travelled too far (shorten the gas phase or \
         lower its speed), or the cell is sheared too far"
    )]
    Image {
        /// Persistent id of the grain.
        grain: u32,
    },
    /// The flag of [`Compute::stopping_on`](crate::Compute::stopping_on) was set.
    #[error("the computation was stopped")]
    Stopped,
    /// Grains, positions or contacts that are no packing.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// Parameters of a contact law out of their range.
    #[error(transparent)]
    Law(#[from] UnknownLaw),
    /// An engine without grains.
    #[error("there are no grains")]
    NoGrains,
    /// A setting out of its range.
    #[error("{name} is {value:e}; it must be {requirement}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// The value found.
        value: f64,
        /// Range that is required.
        requirement: &'static str,
    },
    /// The strain rate is not finite.
    #[error("strain rate component {component} is {value}; it must be finite")]
    Rate {
        /// Voigt component name.
        component: &'static str,
        /// The value found.
        value: f64,
    },
    /// An engine of another program refuses its input, or cannot go on from its state.
    #[error("{engine}: {reason}")]
    Failed {
        /// Name of the engine.
        engine: String,
        /// Why, and what to do.
        reason: String,
    },
    /// The program of another engine ended, or does not answer. A new one can go on from the last packing.
    #[error("{engine}: {reason}")]
    Lost {
        /// Name of the engine.
        engine: String,
        /// Fault, with the last lines of the program.
        reason: String,
    },
}
