//! Tolerances of the stiffness solve.

use std::ops::RangeInclusive;

/// Tolerances of a measurement. Above, a solve may end before it has found the softest motions of a network near isostaticity, and
/// then states too small an error.
pub const TOLERANCES: RangeInclusive<f64> = 1e-13..=1e-5;
