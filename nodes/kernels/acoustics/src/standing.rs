//! Standing waves: the packing, repeated along the path, starts with the velocity of plane waves, and rings.

use crate::curve::Curve;
use crate::error::AcousticsError;
use crate::instrument::Instrument;
use crate::measure::Warning;
use crate::ray::Ray;
use crate::trace::Trace;
use grains::Packing;
use scene::Tangential;

/// How standing waves are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Repetitions of the packing along the path, 3 or more; the waves are the path over 1, 2, 3 … copies/2.
    pub copies: u32,
    /// Periods of the longest wave that are fitted.
    pub periods: f64,
    /// Peak strain.
    pub amplitude: f64,
    /// Friction while it rings; `None`: that of the packing.
    pub friction: Option<f64>,
    /// How the tangential force follows a change of normal stiffness.
    pub tangential: Tangential,
}

impl Default for Settings {
    fn default() -> Self {
        Self { copies: 4, periods: 4.0, amplitude: 1e-8, friction: None, tangential: Tangential::Incremental }
    }
}

/// The curves of every ray's motions, in that order, and the traces behind them.
pub fn curves(
    packing: &Packing,
    rays: &[Ray],
    settings: &Settings,
    instrument: &Instrument,
) -> Result<(Vec<Curve>, Vec<Trace>, Vec<Warning>), AcousticsError> {
    let _ = (packing, rays, settings, instrument);
    Ok((Vec::new(), Vec::new(), Vec::new()))
}
