//! Calibrations by name.

use crate::failure::Failure;
use emt::Calibration;

/// The calibration that is taken where none is named.
pub(super) const DEFAULT: &str = "paper";

/// The calibration of this name.
pub(super) fn load(name: &str) -> Result<Calibration, Failure> {
    if name == Calibration::PAPER.name() {
        return Ok(Calibration::PAPER);
    }
    Err(Failure::usage(format!("no calibration {name:?}; there is: {}", Calibration::PAPER.name())))
}
