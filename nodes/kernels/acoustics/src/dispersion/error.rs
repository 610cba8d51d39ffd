//! Why acoustic modes were not found.

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub(crate) enum SolveError {
    /// A motion without stiffness, other than those of a few grains.
    #[error("some grains move without resistance, and carry the wave in part; use another method")]
    Floppy,
    #[error(
        "relative residual {residual:.1e} after {iterations} iterations; raise max_iterations or tolerance"
    )]
    NotConverged {
        /// Residual over the load.
        residual: f64,
        iterations: u32,
    },
    #[error(
        "the square of the frequency still changed by {change:e} of itself after {rounds} rounds, among softer motions of \
         single grains; use longer waves"
    )]
    Unsettled {
        /// Relative change of ω² in the last round.
        change: f64,
        rounds: u32,
    },
}
