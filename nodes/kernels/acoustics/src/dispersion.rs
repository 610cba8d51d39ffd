//! Acoustic modes of the frozen contact network at Bloch wave vectors.
//!
//! The packing is repeated to infinity, so that waves of any length and direction fit. At each wave vector q the three
//! acoustic modes are computed; ω²/q² is proportional to 1 − b q² and extrapolated to long waves
//! ([`crate::DispersionCurve::fit`]). Amplitudes are infinitesimal: contacts neither open nor slide.

mod alignment;
mod bloch;
mod error;
mod extrapolation;
#[cfg(test)]
mod lattice_sample;
mod modes;
mod settings;
mod solve;
mod subspace;
mod waves;

pub(crate) use alignment::Alignment;
pub use settings::Settings;

use crate::backbone::Backbone;
use crate::curve::{DispersionCurve, DispersionPoint};
use crate::error::AcousticsError;
use crate::ray::Ray;
use crate::warning::Warning;
use alignment::{aligned, completed};
use bloch::Bloch;
use error::SolveError;
use extrapolation::Extrapolation;
use grainlab_core::{Mat3, Packing, Vec3};
use modes::modes;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Wavelength in mean diameters below which loosely held grains do not follow a wave, which increases ω² by
/// up to this fraction.
const SOFT_BELOW: f64 = 100.0;
const SOFT: f64 = 1e-3;

/// Wavelength in mean diameters from which all motions of 50 packings of 2,000 grains, z 4.3 to 6.1, follow the wave. If the longest wave is
/// shorter, a few motions may be slower than all waves, which no series shows: they change v² by up to this fraction
/// at 100 diameters, in inverse proportion to the wavelength.
const FOLLOWED: f64 = 1000.0;
const UNSEEN: f64 = 1e-3;

/// Relative error of ω² over its change in the last round, and over the tolerance: solutions to 1e-10 differ by no more
/// in three packings of z 4.9 to 5.9.
const CHANGE: f64 = 0.3;
const REACHED: f64 = 3e-4;

/// The curves of all polarizations of all rays, in that order.
///
/// If a ray has three polarizations, the first two span its plane with the axis and are rotated in it to those of the
/// modes; the coupling with the third averages out over azimuths and is left out. One or two polarizations are taken as
/// given. The speed of the polarization p is √(pᵀ A p)/q, with A = Σ ω² p p* over the modes.
pub fn curves(
    packing: &Packing,
    rays: &[Ray],
    settings: &Settings,
) -> Result<Vec<DispersionCurve>, AcousticsError> {
    settings.validated()?;
    let backbone = Backbone::new(packing)?;
    curves_of(&backbone, mean_diameter(packing), rays, Alignment::InPlane, settings)
}

pub(crate) fn mean_diameter(packing: &Packing) -> f64 {
    2.0 * packing.radii.iter().sum::<f64>() / packing.grains() as f64
}

/// The curves of all rays. Rays whose modes are not found are left out with a warning. If all are, the first
/// error is returned.
pub(crate) fn all_curves(
    backbone: &Backbone,
    diameter: f64,
    rays: &[Ray],
    alignment: Alignment,
    settings: &Settings,
) -> Result<(Vec<DispersionCurve>, Vec<Warning>), AcousticsError> {
    let found: Vec<_> =
        rays.par_iter().map(|ray| curves_along(backbone, diameter, ray, alignment, settings)).collect();
    let (mut curves, mut warnings, mut first_error) = (Vec::new(), Vec::new(), None);
    for found in found {
        match found {
            Ok((found, warning)) => {
                curves.extend(found);
                warnings.extend(warning);
            }
            Err(error @ (AcousticsError::NotConverged { .. } | AcousticsError::NoSignal { .. })) => {
                first_error = first_error.or_else(|| Some(error.clone()));
                warnings.push(Warning::LeftOut(error));
            }
            Err(error) => return Err(error),
        }
    }
    match first_error {
        Some(error) if curves.is_empty() => Err(error),
        _ => Ok((curves, warnings)),
    }
}

fn curves_of(
    backbone: &Backbone,
    diameter: f64,
    rays: &[Ray],
    alignment: Alignment,
    settings: &Settings,
) -> Result<Vec<DispersionCurve>, AcousticsError> {
    let curves: Result<Vec<_>, _> =
        rays.par_iter().map(|ray| curves_along(backbone, diameter, ray, alignment, settings)).collect();
    Ok(curves?.into_iter().flat_map(|(curves, _)| curves).collect())
}

/// The acoustic tensor A at one wave number.
struct AcousticTensor {
    wavenumber: f64,
    /// A/q², m²/s².
    over_square: Mat3,
    /// Relative error of ω².
    error: f64,
}

fn curves_along(
    backbone: &Backbone,
    diameter: f64,
    ray: &Ray,
    alignment: Alignment,
    settings: &Settings,
) -> Result<(Vec<DispersionCurve>, Option<Warning>), AcousticsError> {
    let mut wavelengths = settings.wavelengths.clone();
    wavelengths.sort_by(|a, b| b.total_cmp(a));
    let no_limit = || AcousticsError::NoSignal {
        what: "long wave",
        direction: ray.direction.into(),
        polarization: ray.polarizations.first().copied().unwrap_or_default().into(),
        reason: "its speeds have no positive limit at long waves; use longer waves".to_owned(),
    };
    for doubling in 0.. {
        let last = doubling >= settings.doublings;
        let found = modes_along(backbone, diameter, ray, alignment, &wavelengths, settings);
        let too_short = match &found {
            Ok(found) => found.as_ref().is_none_or(|e| e.is_too_short(settings.tolerance)),
            Err(error) => matches!(error, AcousticsError::NotConverged { .. }),
        };
        if last || !too_short {
            let series = found?.ok_or_else(no_limit)?;
            let (direction, ratio) = (ray.direction.into(), series.ratio);
            let warning =
                series.is_too_short(settings.tolerance).then_some(Warning::TooShort { direction, ratio });
            let longest = wavelengths[0];
            let unseen = if longest < FOLLOWED { UNSEEN * 100.0 / longest } else { 0.0 };
            return Ok((series.curves(ray.direction, unseen), warning));
        }
        wavelengths.iter_mut().for_each(|w| *w *= 2.0);
    }
    Err(no_limit())
}

/// The series of all polarizations of a ray; `None` if one of them has no limit.
fn modes_along(
    backbone: &Backbone,
    diameter: f64,
    ray: &Ray,
    alignment: Alignment,
    wavelengths: &[f64],
    settings: &Settings,
) -> Result<Option<Extrapolation>, AcousticsError> {
    let completed = completed(&ray.polarizations);
    // All three modes are computed, so that they cannot be confused. If some have no stiffness, only those of
    // the ray are.
    let tensors = acoustic_tensors(backbone, ray, &completed, diameter, wavelengths, settings);
    let tensors = match tensors {
        Err(_) if ray.polarizations.len() < completed.len() => {
            acoustic_tensors(backbone, ray, &ray.polarizations, diameter, wavelengths, settings)?
        }
        tensors => tensors?,
    };
    let points = |polarization: Vec3| {
        let points = tensors.iter().map(|a| {
            let speed = polarization.dot(&(a.over_square * polarization)).max(0.0).sqrt();
            DispersionPoint { wavenumber: a.wavenumber, speed, stddev: 0.5 * a.error * speed }
        });
        (polarization, points.collect())
    };
    let polarizations = aligned(&ray.polarizations, alignment, &tensors[0].over_square);
    Ok(Extrapolation::of(polarizations.into_iter().map(points).collect()))
}

fn acoustic_tensors(
    backbone: &Backbone,
    ray: &Ray,
    polarizations: &[Vec3],
    diameter: f64,
    wavelengths: &[f64],
    settings: &Settings,
) -> Result<Vec<AcousticTensor>, AcousticsError> {
    let mut near = Vec::new();
    let mut found = Vec::with_capacity(wavelengths.len());
    for wavelength in wavelengths {
        let wavenumber = TAU / (wavelength * diameter);
        let bloch = Bloch::new(backbone, &(ray.direction * wavenumber));
        let Settings { tolerance, max_iterations, .. } = *settings;
        let modes = modes(&bloch, polarizations, &near, tolerance, max_iterations).map_err(|error| {
            let contacts = backbone.network.contacts();
            match error {
                SolveError::Floppy => grainlab_core::results::NotJammed::Floppy { contacts }.into(),
                error => AcousticsError::NotConverged {
                    direction: ray.direction.into(),
                    wavelength: wavelength * diameter,
                    reason: error.to_string(),
                },
            }
        })?;
        found.push(AcousticTensor {
            wavenumber,
            over_square: modes.acoustic_tensor / (wavenumber * wavenumber),
            error: (CHANGE * modes.change).hypot(REACHED * tolerance).max(if *wavelength < SOFT_BELOW {
                SOFT
            } else {
                0.0
            }),
        });
        near = modes.found;
    }
    Ok(found)
}
