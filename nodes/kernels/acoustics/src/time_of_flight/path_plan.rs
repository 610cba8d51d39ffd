//! Positions of the receivers, and length of the path.

use super::burst::Burst;
use super::wave_path::WavePath;
use crate::error::AcousticsError;
use crate::sample::Sample;
use crate::supercell::lattice::{primitive, spacing};
use std::f64::consts::TAU;

/// Receivers of a measurement: their number, and the distances of the first and the last one, wavelengths.
pub(crate) const RECEIVERS: (u32, f64, f64) = (5, 1.0, 3.0);

/// Speed of the wave in the opposite direction over the expected one, as a margin.
const FASTER: f64 = 1.05;

/// Duration of the recording after the start of the burst arrives at the furthest receiver, burst durations.
const RECORDED: f64 = 1.25;

/// Relative delay of a burst of wave number q against long waves, over (q × mean diameter)²: packings have dispersion
/// coefficients of up to 0.7 diameters², and the delay of a burst is one and a half times that.
const SLOWER: f64 = 1.0;

/// Receivers and path of a burst. Receivers are whole periods of the packing apart where no two would coincide.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PathPlan {
    /// Distances of the receivers from the source, m.
    pub(crate) receivers: Vec<f64>,
    pub(crate) copies: u32,
    /// Duration of the recording, s.
    pub(crate) duration: f64,
}

impl PathPlan {
    /// For receivers as in [`RECEIVERS`], `copies` of the packing (`None`: as many as are needed) and a burst with the wave speed `speed`,
    /// m/s.
    pub(crate) fn new(
        path: &WavePath,
        sample: &Sample,
        receivers: (u32, f64, f64),
        copies: Option<u32>,
        burst: &Burst,
        speed: f64,
    ) -> Result<Self, AcousticsError> {
        // Planes (2 0 0) are every second plane of (1 0 0).
        let period = spacing(&sample.packing.cell, &primitive(path.indices).unwrap_or_default());
        let wavelength = speed / burst.frequency;
        let receivers = places(receivers, wavelength, period);
        let furthest = receivers.last().copied().unwrap_or(0.0);
        let slower = 1.0 + SLOWER * (TAU * sample.diameter / wavelength).powi(2);
        let duration = slower * furthest / speed + RECORDED * burst.duration();
        // The wave in the opposite direction must not reach the furthest receiver during the recording.
        let needed = furthest + FASTER * speed * duration;
        let enough = (needed / period).ceil().max(1.0);
        let copies = copies.unwrap_or(enough as u32);
        if f64::from(copies) < enough {
            return Err(AcousticsError::PathTooShort {
                copies,
                path: f64::from(copies) * period,
                needed,
                enough: enough as u32,
            });
        }
        Ok(Self { receivers, copies, duration })
    }
}

fn places((receivers, nearest, furthest): (u32, f64, f64), wavelength: f64, period: f64) -> Vec<f64> {
    let step = (furthest - nearest) * wavelength / f64::from(receivers - 1);
    let even = (0..receivers).map(|k| f64::from(k) * step);
    let whole = |x: f64| if step >= period { (x / period).round() * period } else { x };
    even.map(|x| nearest * wavelength + whole(x)).collect()
}
