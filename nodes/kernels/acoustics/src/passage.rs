//! Where the receivers of a burst are, and how long the path must be.

use crate::burst::Burst;
use crate::error::AcousticsError;
use crate::flight::Settings;
use std::f64::consts::TAU;

/// Waves may be this much faster than expected: what comes the other way around still comes late.
const FASTER: f64 = 1.05;

/// Burst lengths for which the furthest receiver listens on after the burst's first moment has come.
const LISTEN: f64 = 1.25;

/// How much slower than long waves a burst of wave number q may be, times (q × mean diameter)²: packings have bends of up to
/// 0.7 diameters², and a burst has one and a half times that.
const SLOWER: f64 = 1.0;

/// Where a burst is heard, on which path. Receivers are whole periods of the packing apart where no two would fall together.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Passage {
    /// Places of the receivers, from the source, m.
    pub(crate) receivers: Vec<f64>,
    /// Repetitions of the packing.
    pub(crate) copies: u32,
    /// Time for which the receivers listen, s.
    pub(crate) duration: f64,
}

impl Passage {
    /// Of a burst whose waves go at `speed` (m/s) through a packing of that mean `diameter` and `period` along the path, m.
    pub(crate) fn planned(
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
        let duration = slower * furthest / speed + LISTEN * burst.duration();
        // The other way around to the furthest receiver, while it listens.
        let needed = furthest + FASTER * speed * duration;
        let enough = (needed / period).ceil().max(1.0);
        let copies = settings.copies.unwrap_or(enough as u32);
        if f64::from(copies) < enough {
            return Err(AcousticsError::PathTooShort {
                copies,
                path: f64::from(copies) * period,
                needed,
                why: "what leaves the source the other way must not come around while the furthest receiver listens",
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
