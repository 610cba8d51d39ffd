//! Time of flight: a burst is sent through the packing, repeated along the path.
//!
//! A slab of grains across the path is pushed along the particle motion as a tone burst goes; slabs at several distances
//! tell the mean velocity of their grains. The slope of arrival against distance ([`arrival`]) is turned into the
//! phase speed at each frequency, whatever is picked, and [`Curve::through`] extrapolates those to long waves.
//!
//! The wave leaves the source both ways, and the path is closed: it is as long as it takes for what goes the other way
//! around to arrive when all is over. Receivers are whole periods of the packing apart, as far as that can be: there
//! they see the same wave, later.

pub mod arrival;
mod burst;
mod line;
mod meaning;
mod passage;
mod pick;
mod shot;
mod slab;
mod spectrum;
mod travel;

use crate::curve::Curve;
use crate::error::AcousticsError;
use crate::flight::arrival::Arrivals;
use crate::flight::travel::Travel;
use crate::instrument::Instrument;
use crate::measure::Warning;
use crate::ray::Ray;
use crate::sample::Sample;
use crate::standing::planes;
use crate::trace::Trace;
use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Packing, WaveMethod};
use rayon::prelude::*;

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
    /// Centre frequencies, Hz; `None`: those whose waves are some 20, 28 and 40 mean grain diameters long, by the speed that a
    /// first burst finds.
    pub frequencies: Option<Vec<f64>>,
    /// Periods of a burst, under a Hann window; 1 or more.
    pub cycles: f64,
    /// Repetitions of the packing along the path; `None`: as many as keep what goes around from what arrives.
    pub copies: Option<u32>,
    /// Thickness of source and receivers along the ray, mean grain diameters.
    pub thickness: f64,
    /// Receivers, 2 or more.
    pub receivers: u32,
    /// Distance of the first, wavelengths.
    pub nearest: f64,
    /// Distance of the last, wavelengths.
    pub furthest: f64,
    /// Peak strain. From 1e-10 to 1e-6 speeds through packings at 50 kPa are the same to 5e-4; above, contacts open.
    pub amplitude: f64,
    /// What is taken as the arrival.
    pub pick: Pick,
    /// Friction; `None`: that of the packing, whose contacts at the limit slide under any wave; infinite: none do.
    pub friction: Option<f64>,
    /// How the tangential force follows a change of normal stiffness.
    pub tangential: TangentialLaw,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            frequencies: None,
            cycles: 2.0,
            copies: None,
            thickness: 2.0,
            receivers: 5,
            nearest: 1.0,
            furthest: 3.0,
            amplitude: 1e-8,
            pick: Pick::default(),
            friction: None,
            tangential: TangentialLaw::Incremental,
        }
    }
}

impl Settings {
    /// The settings themselves, if they are in range.
    pub fn validated(&self) -> Result<&Self, AcousticsError> {
        let fault = |name, value, requirement| Err(AcousticsError::Setting { name, value, requirement });
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let numbers =
            [("thickness", self.thickness), ("nearest", self.nearest), ("amplitude", self.amplitude)];
        if let Some((name, value)) = numbers.into_iter().find(|(_, x)| !positive(*x)) {
            return fault(name, value, "more than 0 and finite");
        }
        if !(self.cycles.is_finite() && self.cycles >= 1.0) {
            return fault("cycles", self.cycles, "1 or more and finite");
        }
        if !(self.furthest.is_finite() && self.furthest > self.nearest) {
            return fault("furthest", self.furthest, "more than nearest and finite");
        }
        if self.amplitude > 1e-2 {
            return fault("amplitude", self.amplitude, "0.01 or less");
        }
        if self.receivers < 2 {
            return fault("receivers", self.receivers.into(), "2 or more");
        }
        if self.copies == Some(0) {
            return fault("copies", 0.0, "1 or more");
        }
        for (k, frequency) in self.frequencies.iter().flatten().enumerate() {
            if !positive(*frequency) {
                return fault("frequencies", *frequency, "more than 0 and finite");
            }
            if self.frequencies.iter().flatten().take(k).any(|f| f == frequency) {
                return fault("frequencies", *frequency, "each once");
            }
        }
        if self.frequencies.as_ref().is_some_and(Vec::is_empty) {
            return fault("frequencies", 0.0, "one or more");
        }
        Ok(self)
    }
}

/// The curves of every ray's motions, in that order, and the traces behind them.
///
/// A motion whose arrivals noise hides is left out with a [`Warning::LeftOut`]; if all are, that is the error. The same
/// bits for any number of threads.
#[allow(clippy::type_complexity)]
pub fn curves(
    packing: &Packing,
    rays: &[Ray],
    settings: &Settings,
    instrument: &Instrument,
) -> Result<(Vec<Curve>, Vec<Trace>, Vec<Warning>), AcousticsError> {
    settings.validated()?;
    instrument.validated()?;
    let mut travels = Vec::new();
    for (r, ray) in rays.iter().enumerate() {
        let indices = planes(packing, ray)?;
        for (m, motion) in ray.motions.iter().enumerate() {
            let length = motion.norm();
            if length.is_nan() || (length - 1.0).abs() > 1e-6 {
                let requirement = "a unit vector";
                return Err(AcousticsError::Setting { name: "motion", value: length, requirement });
            }
            let place = [r as u64, m as u64];
            travels.push(Travel { direction: ray.direction, motion: *motion, indices, place });
        }
    }
    let sample = Sample::new(packing, settings.friction, settings.tangential)?;
    let found: Vec<_> = travels.par_iter().map(|t| t.measured(&sample, settings, instrument)).collect();
    let (mut curves, mut traces) = (Vec::new(), Vec::new());
    let mut warnings: Vec<Warning> =
        sample.unrest.map(|unbalanced| Warning::NotAtRest { unbalanced }).into_iter().collect();
    let mut silent = None;
    for found in found {
        match found {
            Ok(mut found) => {
                curves.push(found.curve);
                traces.append(&mut found.traces);
                warnings.append(&mut found.warnings);
            }
            Err(hidden @ AcousticsError::NoSignal { .. }) => {
                silent = silent.or_else(|| Some(hidden.clone()));
                warnings.push(Warning::LeftOut(hidden));
            }
            Err(error) => return Err(error),
        }
    }
    match silent {
        Some(error) if curves.is_empty() => Err(error),
        _ => Ok((curves, traces, warnings)),
    }
}

/// The curve that the traces of one mode give, one or more frequencies of bursts of so many `cycles`. `seed` is that of the
/// noisy copies that tell the uncertainty; `diameter` (m, mean) tells how much one frequency alone may be off.
pub fn curve(
    traces: &[Trace],
    cycles: f64,
    pick: Pick,
    diameter: f64,
    seed: u64,
) -> Result<Curve, AcousticsError> {
    let arrivals: Vec<Arrivals> =
        traces.iter().map(|t| Arrivals::picked(t, cycles, pick, seed)).collect::<Result<_, _>>()?;
    meaning::curve(traces, &arrivals, cycles, pick, diameter)
}
