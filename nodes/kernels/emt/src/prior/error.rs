//! Why a prior is invalid.

/// Why a prior is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PriorError {
    /// A number is not finite, or above 1e100.
    #[error("every number of it must be finite and below 1e100; leave a limit out to have none")]
    NotFinite,
    /// The standard deviation is not positive.
    #[error(
        "stddev = {stddev} must be more than 0: for a value known exactly give a small one, such as 1e-6"
    )]
    ZeroWidth {
        /// The value found.
        stddev: f64,
    },
    /// Both limits are the same.
    #[error("low and high are both {at}: a prior needs a width")]
    SameLimits {
        /// Value of both limits.
        at: f64,
    },
    /// The limits are in the wrong order.
    #[error("low = {low} is above high = {high}: exchange them")]
    Inverted {
        /// The lower limit, as given.
        low: f64,
        /// The upper limit, as given.
        high: f64,
    },
    /// No probability is left between the limits.
    #[error(
        "a normal density of mean {mean} and stddev {stddev} has no probability between {low} and {high}: widen it, or move \
         the limits"
    )]
    Empty {
        /// Mean of the density.
        mean: f64,
        /// The standard deviation.
        stddev: f64,
        /// The lower limit.
        low: f64,
        /// The upper limit.
        high: f64,
    },
    /// The text is not a prior file.
    #[error("{0}")]
    Text(String),
    /// The section of a quantity is invalid.
    #[error("[{quantity}]: {fault}")]
    Section {
        /// Name of the quantity.
        quantity: &'static str,
        /// Fault of the section.
        fault: String,
    },
}
