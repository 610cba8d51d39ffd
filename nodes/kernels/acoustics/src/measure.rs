//! One measurement of one packing.

use crate::curve::Curve;
use crate::dispersion::Turn;
use crate::error::{AcousticsError, in_brackets};
use crate::instrument::Instrument;
use crate::noise::{Noise, seed_at};
use crate::participation::{Carrier, Participation};
use crate::survey::{Modes, Survey};
use crate::trace::Trace;
use crate::{dispersion, flight, standing};
use grainlab_core::{MeasuredWave, Packing, Vec3, WaveMethod, WaveSpeed};

/// A speed that is less certain than this share of itself says little about a medium.
const NOISY: f64 = 0.1;

/// Place of the noise of speeds among that of all else.
const SPEEDS: u64 = u64::MAX;

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
        "the packing answers not in proportion along {}, motion {}: {opened} contacts opened, {closed} \
         closed at a strain of {amplitude:e}, the trace changes by {change:.1e} of itself at half of that; send less",
        in_brackets(direction),
        in_brackets(motion)
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
    /// A speed that is hardly known.
    #[error(
        "the wave along {}, motion {}, tells its speed to {relative:.1e} of itself only; average more shots if it is noise, send \
         less if contacts open",
        in_brackets(direction),
        in_brackets(motion)
    )]
    Noisy {
        /// Direction of propagation.
        direction: [f64; 3],
        /// Particle motion.
        motion: [f64; 3],
        /// Relative standard deviation of the speed.
        relative: f64,
    },
    /// The packing's own motion is mixed with the waves.
    #[error(
        "the packing did not come to rest (unbalanced force ratio {unbalanced:.1e}): its own motion is mixed with the waves; relax \
         it further, or send more"
    )]
    NotAtRest {
        /// Mean net force of the grains that carry force, over the mean contact force.
        unbalanced: f64,
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
    /// Its standard deviation: what it differs by between motions, and between the frequencies that were sent.
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
///
/// Dispersion is of the frozen network; the other two move the grains. A speed that only one ray's wave does not give is left
/// out with a warning, unless none is left.
pub fn measure(packing: &Packing, settings: &Settings) -> Result<Measurement, AcousticsError> {
    check(settings)?;
    let carrier = Carrier::new(packing)?;
    let axis = settings.axis.map(|a| a.normalize());
    let about = axis.unwrap_or_else(Vec3::z);
    let survey = if axis.is_some() { settings.survey } else { Survey::Everywhere };
    // Every packing meets noise of its own.
    let seed = seed_at(settings.instrument.seed, &[packing.step]);
    let instrument = &Instrument { seed, ..settings.instrument };
    let lattice = || survey.lattice_rays(&packing.cell, &about, settings.modes);
    let (curves, traces, mut warnings) = match &settings.way {
        Way::Dispersion(way) => {
            dispersion::check(way)?;
            let rays = survey.rays(&about, settings.modes);
            let diameter = dispersion::mean_diameter(packing);
            let turn = if axis.is_some() { Turn::InPlane } else { Turn::Freely };
            let (curves, warnings) = dispersion::all_curves(&carrier, diameter, &rays, turn, way)?;
            (curves, Vec::new(), warnings)
        }
        Way::Standing(way) => standing::curves(packing, &lattice(), way, instrument)?,
        Way::Flight(way) => flight::curves(packing, &lattice(), way, instrument)?,
    };
    let (method, amplitude) = match &settings.way {
        Way::Dispersion(_) => (WaveMethod::Dispersion, 0.0),
        Way::Standing(way) => (WaveMethod::StandingWave, way.amplitude),
        Way::Flight(way) => (way.pick.method(), way.amplitude),
    };
    let wave = |curve: &Curve| MeasuredWave {
        wave: WaveSpeed {
            direction: curve.direction,
            polarization: curve.motion,
            speed: curve.speed,
            stddev: Some(curve.stddev),
        },
        method,
        // Extrapolated to long waves.
        frequency: None,
        strain_amplitude: amplitude,
    };
    let waves: Vec<MeasuredWave> = curves.iter().map(wave).collect();
    let mut waves = with_speed_noise(&waves, instrument.speed_noise, instrument.seed);
    warnings.extend(waves.iter().filter(|w| !is_speed(w)).map(|w| {
        let (direction, motion) = (w.wave.direction.into(), w.wave.polarization.into());
        let reason = "the noise of speeds is as large as the speed".to_owned();
        Warning::LeftOut(AcousticsError::NoSignal { what: "speed", direction, motion, reason })
    }));
    waves.retain(is_speed);
    warnings.extend(noisy(&waves));
    let [least, most] = frequencies(&curves);
    let participation = carrier.participation(least);
    let density = participation.mean();
    let density_stddev = participation.spread().hypot(density - carrier.participation(most).mean());
    // Less is rounding.
    let density_stddev = if density_stddev > 1e-9 * density { density_stddev } else { 0.0 };
    Ok(Measurement { waves, participation, density, density_stddev, axis, curves, traces, warnings })
}

/// The same speeds with an independent relative error `noise` (standard deviation) more, which their uncertainty includes: the
/// same for the same seed.
pub fn with_speed_noise(waves: &[MeasuredWave], noise: f64, seed: u64) -> Vec<MeasuredWave> {
    let mut waves = waves.to_vec();
    for (index, MeasuredWave { wave, .. }) in waves.iter_mut().enumerate().filter(|_| noise > 0.0) {
        let error = noise * wave.speed;
        wave.speed += error * Noise::at(seed, &[SPEEDS, index as u64]).next();
        wave.stddev = wave.stddev.map(|stddev| stddev.hypot(error));
    }
    waves
}

fn check(settings: &Settings) -> Result<(), AcousticsError> {
    let range = |name, value: f64, valid: bool, requirement| {
        if valid { Ok(()) } else { Err(AcousticsError::Setting { name, value, requirement }) }
    };
    if let Some(axis) = settings.axis {
        let length = axis.norm();
        range("|axis|", length, length.is_finite() && length > 0.0, "a direction: finite and not zero")?;
    }
    settings.instrument.validated().map(|_| ())
}

/// Lowest and highest angular frequency that anything was measured at, rad/s.
fn frequencies(curves: &[Curve]) -> [f64; 2] {
    let all = || curves.iter().flat_map(|c| &c.points).map(|p| p.speed * p.wavenumber);
    [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)]
}

fn is_speed(measured: &MeasuredWave) -> bool {
    measured.wave.speed > 0.0
}

/// Speeds that noise leaves next to nothing of.
fn noisy(waves: &[MeasuredWave]) -> Vec<Warning> {
    let of = |m: &MeasuredWave| {
        let relative = m.wave.stddev? / m.wave.speed;
        (relative > NOISY).then(|| Warning::Noisy {
            direction: m.wave.direction.into(),
            motion: m.wave.polarization.into(),
            relative,
        })
    };
    waves.iter().filter_map(of).collect()
}
