//! Positions of the receivers, and length of the path.

use super::burst::Burst;
use super::settings::Settings;
use crate::error::AcousticsError;
use std::f64::consts::TAU;

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
    /// Number of repetitions of the packing.
    pub(crate) copies: u32,
    /// Duration of the recording, s.
    pub(crate) duration: f64,
}

impl PathPlan {
    /// For a burst with the wave speed `speed`, m/s, in a packing of mean `diameter` and `period` along the path, m.
    pub(crate) fn new(
        settings: &Settings,
        burst: &Burst,
        speed: f64,
        diameter: f64,
        period: f64,
    ) -> Result<Self, AcousticsError> {
        let wavelength = speed / burst.frequency;
        let receivers = places(settings, wavelength, period);
        let furthest = receivers.last().copied().unwrap_or(0.0);
        let slower = 1.0 + SLOWER * (TAU * diameter / wavelength).powi(2);
        let duration = slower * furthest / speed + RECORDED * burst.duration();
        // The wave in the opposite direction must not reach the furthest receiver during the recording.
        let needed = furthest + FASTER * speed * duration;
        let enough = (needed / period).ceil().max(1.0);
        let copies = settings.copies.unwrap_or(enough as u32);
        if f64::from(copies) < enough {
            return Err(AcousticsError::PathTooShort {
                copies,
                path: f64::from(copies) * period,
                needed,
                why: "the wave in the opposite direction must not reach the furthest receiver during the recording",
                enough: enough as u32,
            });
        }
        Ok(Self { receivers, copies, duration })
    }
}

fn places(settings: &Settings, wavelength: f64, period: f64) -> Vec<f64> {
    let nearest = settings.nearest * wavelength;
    let step = (settings.furthest - settings.nearest) * wavelength / f64::from(settings.receivers - 1);
    let even = (0..settings.receivers).map(|k| f64::from(k) * step);
    let whole = |x: f64| if step >= period { (x / period).round() * period } else { x };
    even.map(|x| nearest + whole(x)).collect()
}
