//! Standing waves: the packing, repeated along the path, starts with the velocity of plane waves, and rings.
//!
//! With m periods in c copies of a packing of length L a wave has the Bloch wave number 2π m/(c L). Waves of different m know
//! nothing of each other while contacts answer in proportion, so that all of m < c/2 ring at once and apart, and the packing's
//! own residual motion is in none of them. The frequency of each gives a phase speed, and those of the longest waves the speed
//! in the limit of long ones ([`Curve::through`]). Waves near m = c/2 are left out: the packing repeats with half their length
//! and scatters them back.
//!
//! What rings is the packing itself, by the whole contact law. Between strains of 1e-12 and 1e-8 packings of 2,000 grains at 50
//! kPa answer in proportion; 1e-7 moves ρv² by up to 0.1 %, 1e-6 by 0.3 %, 1e-5 by 1 %, 1e-4 by 6 %, as feeble contacts open and
//! close.

mod resonance;
mod ringing;
mod tone;

use crate::curve::Curve;
use crate::error::AcousticsError;
use crate::instrument::Instrument;
use crate::measure::Warning;
use crate::ray::Ray;
use crate::sample::Sample;
use crate::standing::resonance::{Found, Resonance};
use crate::trace::Trace;
use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Packing, Vec3};
use rayon::prelude::*;

/// Repetitions of a packing that have room for two wavelengths, to extrapolate from.
pub const FEWEST_COPIES: u32 = 5;

/// How standing waves are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Repetitions of the packing along the path, 5 or more: the waves are the path over 1, 2 … 2/5 of them, four at most,
    /// none shorter than 20 mean diameters. Where lattice planes are so near to each other that the path would be shorter than
    /// 60 mean diameters there are more. Time and memory are in proportion.
    pub copies: u32,
    /// Periods of each wave that are evaluated, without the first quarter, when grains still move as the mean deformation has
    /// it: 1.5 to 100.
    pub periods: f64,
    /// Peak strain, of all waves together, above 0 and at most 0.01.
    pub amplitude: f64,
    /// Friction while it rings; `None`: that of the packing. Contacts at the Coulomb limit slide however small the wave is, and
    /// make it slower than the frozen network's by a few per cent; a high friction ("set very high") holds them.
    pub friction: Option<f64>,
    /// How the tangential force follows a change of normal stiffness.
    pub tangential: TangentialLaw,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            copies: 8,
            periods: 4.0,
            amplitude: 1e-9,
            friction: None,
            tangential: TangentialLaw::Incremental,
        }
    }
}

impl Settings {
    /// The settings themselves, if they are in range.
    pub fn validated(&self) -> Result<&Self, AcousticsError> {
        let fault = |name, value, requirement| Err(AcousticsError::Setting { name, value, requirement });
        if self.copies < FEWEST_COPIES {
            return fault("copies", self.copies.into(), "5 or more, for two wavelengths");
        }
        if !(1.5..=100.0).contains(&self.periods) {
            return fault("periods", self.periods, "between 1.5 and 100");
        }
        if !(self.amplitude > 0.0 && self.amplitude <= 1e-2) {
            return fault("amplitude", self.amplitude, "above 0 and at most 0.01");
        }
        Ok(self)
    }
}

/// The curves of every ray's motions, in that order, and the traces behind them: one each, with a channel a wavelength.
///
/// Each ray must name lattice planes. A motion that does not ring is left out with a warning; where none does, that is the
/// error. ω is that of the best damped tone; its standard deviation is that of the fit, what is left over taken as noise with
/// a memory, and what it differs by between the first half of the periods and all.
///
/// The standard deviation of a curve's speed also has what ρv² differs by from n·C·n of the unstressed frozen network for just
/// that motion: terms of the order of the pressure, and sin² of the angle between the motion sent and that of the packing's
/// own mode, which the longest wave's motion aside tells. And the longest wave's speed is taken to depart from any smooth law
/// by a fifth of its dispersion.
#[allow(clippy::type_complexity)]
pub fn curves(
    packing: &Packing,
    rays: &[Ray],
    settings: &Settings,
    instrument: &Instrument,
) -> Result<(Vec<Curve>, Vec<Trace>, Vec<Warning>), AcousticsError> {
    settings.validated()?;
    instrument.validated()?;
    let mut resonances = Vec::new();
    for (place, ray) in rays.iter().enumerate() {
        let indices = planes(packing, ray)?;
        for (nth, motion) in ray.motions.iter().enumerate() {
            if (motion.norm() - 1.0).abs() >= 1e-6 || motion.norm().is_nan() {
                let requirement = "a unit vector";
                return Err(AcousticsError::Setting { name: "motion", value: motion.norm(), requirement });
            }
            let place = [place as u64, nth as u64];
            resonances.push(Resonance { direction: ray.direction, motion: *motion, indices, place });
        }
    }
    let sample = Sample::new(packing, settings.friction, settings.tangential)?;
    let found: Vec<Result<Found, AcousticsError>> =
        resonances.par_iter().map(|r| r.measured(&sample, settings, instrument)).collect();
    let (mut curves, mut traces) = (Vec::new(), Vec::new());
    let mut warnings: Vec<Warning> =
        sample.unrest.map(|unbalanced| Warning::NotAtRest { unbalanced }).into_iter().collect();
    let mut silent = None;
    for found in found {
        match found {
            Ok(found) => {
                curves.push(found.curve);
                traces.push(found.trace);
                warnings.extend(found.warnings);
            }
            Err(error @ AcousticsError::NoSignal { .. }) => {
                silent = silent.or_else(|| Some(error.clone()));
                warnings.push(Warning::LeftOut(error));
            }
            Err(error) => return Err(error),
        }
    }
    match silent {
        Some(error) if curves.is_empty() => Err(error),
        _ => Ok((curves, traces, warnings)),
    }
}

/// The lattice planes across a ray.
pub(crate) fn planes(packing: &Packing, ray: &Ray) -> Result<[i32; 3], AcousticsError> {
    let across = |indices: &[i32; 3]| {
        let normal = Ray::normal(&packing.cell, *indices).unwrap_or_else(Vec3::zeros);
        (normal.dot(&ray.direction).abs() - 1.0).abs() < 1e-9
    };
    let no_plane = AcousticsError::NoLatticePlane { direction: ray.direction.into() };
    ray.indices.filter(across).ok_or(no_plane)
}
