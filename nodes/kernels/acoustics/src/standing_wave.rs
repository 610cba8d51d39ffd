//! Standing waves: free vibration of a supercell that starts with the velocities of plane waves.
//!
//! A wave with m periods in c copies of a packing of length L has the Bloch wave number 2π m/(c L). While contacts
//! respond linearly, waves of different m are independent, so that all waves with m < c/2 are excited at once and
//! separated afterwards; the packing's own residual motion is in none of them. The frequency of each wave gives a phase
//! speed, and those of the longest waves the speed of long waves ([`crate::DispersionCurve::fit`]). Waves near m = c/2
//! are left out: their half wavelength is the period of the packing, which reflects them.
//!
//! The grains move with the complete contact law. At strains between 1e-12 and 1e-8 packings of 2,000 grains at 50 kPa
//! respond linearly. A strain of 1e-7 changes ρv² by up to 0.1 %, 1e-6 by 0.3 %, 1e-5 by 1 %, 1e-4 by 6 %, because weak
//! contacts open and close.

mod free_vibration;
mod measurement;
mod settings;
mod tone;

pub use settings::{MIN_COPIES, Settings};

use crate::curve::DispersionCurve;
use crate::error::AcousticsError;
use crate::instrument::Instrument;
use crate::ray::Ray;
use crate::sample::Sample;
use crate::trace::Trace;
use crate::warning::Warning;
use crate::wave_path::{measure_all, paths};
use grainlab_core::Packing;

/// The curves of all polarizations of all rays, in that order, and their traces: one per curve, with a channel per
/// wavelength.
///
/// Each ray must name lattice planes. A polarization without a tone is left out with a warning. If none has a
/// tone, the first error is returned. ω is that of the tone that fits best. Its standard deviation combines
/// that of the fit, with correlated residuals, and the difference between the first half of the periods and
/// all of them.
///
/// The standard deviation of a curve's speed includes the differences of ρv² from n·C·n of the unstressed frozen
/// network: terms of the order of the pressure; sin² of the angle between the polarization sent and that of the
/// packing's mode, from the transverse motion of the longest wave; an eighth of the dispersion of the longest wave,
/// for departures from a smooth dispersion law; and half of the mean scatter of all curves of the packing.
#[allow(clippy::type_complexity)]
pub fn curves(
    packing: &Packing,
    rays: &[Ray],
    settings: &Settings,
    instrument: &Instrument,
) -> Result<(Vec<DispersionCurve>, Vec<Trace>, Vec<Warning>), AcousticsError> {
    settings.validated()?;
    instrument.validated()?;
    let paths = paths(packing, rays)?;
    let sample = Sample::new(packing, settings.friction, settings.tangential)?;
    measure_all(&paths, &sample, |path| measurement::measure(path, &sample, settings, instrument))
}
