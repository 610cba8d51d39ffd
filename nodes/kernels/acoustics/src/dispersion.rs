//! Acoustic modes of the frozen contact network at Bloch wave vectors.
//!
//! The packing is repeated to infinity, so that waves of any length and direction fit. At each wave vector q the three
//! acoustic modes are computed; ω²/q² is proportional to 1 − b q² and extrapolated to long waves
//! ([`crate::DispersionCurve::fit`]). Amplitudes are infinitesimal: contacts neither open nor slide.

mod alignment;
mod bloch;
mod christoffel_modes;
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
use crate::error::{AcousticsError, in_brackets, no_signal};
use crate::left_out::keep;
use crate::ray::Ray;
use alignment::{aligned, completed, nearest_of};
use bloch::Bloch;
use christoffel_modes::{AcousticTensor, long_wave_polarizations};
use error::SolveError;
use extrapolation::Extrapolation;
use grainlab_core::notes::Note;
use grainlab_core::results::NoStiffness;
use grainlab_core::{Packing, Vec3};
use grainlab_micromechanics::network::{SpringNetwork, relaxed_stiffness};
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

/// Doublings of the wavelengths at once: near the frequency of a loosely held grain the modes are costly, and far below it
/// they are not.
const AT_ONCE: u32 = 3;

/// Relative residual, also least ratio of stiffnesses, and iterations for whether a network resists every strain.
const RESISTS: f64 = 1e-6;
const ITERATIONS: u32 = 20_000;

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
    let diameter = mean_diameter(packing);
    let (found, _, left_out) =
        Dispersion { backbone: &backbone, diameter, alignment: Alignment::InPlane, settings }.curves(rays)?;
    left_out.map_or(Ok(found.curves), Err)
}

/// Mean grain diameter, the unit of wavelengths, m.
pub(crate) fn mean_diameter(packing: &Packing) -> f64 {
    2.0 * packing.radii.iter().sum::<f64>() / packing.grains() as f64
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RayCurves {
    /// Curves of all polarizations of all rays, in that order.
    pub(crate) curves: Vec<DispersionCurve>,
    /// In the same order, along the polarization of the mode nearest to each ([`christoffel_modes`]).
    pub(crate) modes: Vec<DispersionCurve>,
}

pub(crate) struct Dispersion<'a> {
    pub(crate) backbone: &'a Backbone,
    /// Mean diameter, m.
    pub(crate) diameter: f64,
    pub(crate) alignment: Alignment,
    pub(crate) settings: &'a Settings,
}

impl Dispersion<'_> {
    /// Returns the curves of all rays, with notes, and the first error of rays that are left out because their modes were not
    /// found. If all are, the first error is the result.
    pub(crate) fn curves(
        &self,
        rays: &[Ray],
    ) -> Result<(RayCurves, Vec<Note>, Option<AcousticsError>), AcousticsError> {
        let found: Vec<_> = rays.par_iter().map(|ray| self.along(ray)).collect();
        let (mut all, mut notes) = (RayCurves::default(), Vec::new());
        let left_out = keep(found, &mut notes, |(found, note), notes| {
            all.curves.extend(found.curves);
            all.modes.extend(found.modes);
            notes.extend(note);
        })?;
        Ok((all, notes, left_out))
    }

    fn along(&self, ray: &Ray) -> Result<(RayCurves, Option<Note>), AcousticsError> {
        let settings = self.settings;
        let mut wavelengths = settings.wavelengths.clone();
        wavelengths.sort_by(|a, b| b.total_cmp(a));
        let no_limit = || {
            let polarization = ray.polarizations.first().copied().unwrap_or_default();
            let reason = "its speeds have no positive limit at long waves; use longer waves";
            no_signal("long wave", &ray.direction, &polarization, reason)
        };
        for doubling in (0..).step_by(AT_ONCE as usize) {
            let last = doubling + AT_ONCE > settings.doublings;
            let found = self.series(ray, &wavelengths);
            let too_short = match &found {
                Ok(found) => found.as_ref().is_none_or(|(e, _)| e.is_too_short(settings.tolerance)),
                Err(error) => matches!(error, AcousticsError::NotConverged { .. }),
            };
            if last || !too_short {
                let (series, modes) = found?.ok_or_else(no_limit)?;
                let note = || Note::too_short(in_brackets(&ray.direction.into()), series.ratio);
                let note = series.is_too_short(settings.tolerance).then(note);
                let longest = wavelengths[0];
                let unseen = if longest < FOLLOWED { UNSEEN * 100.0 / longest } else { 0.0 };
                let [curves, modes] = [series, modes].map(|s| s.curves(ray.direction, unseen));
                return Ok((RayCurves { curves, modes }, note));
            }
            wavelengths.iter_mut().for_each(|w| *w *= f64::from(1 << AT_ONCE));
        }
        Err(no_limit())
    }

    /// The series of all polarizations of a ray, and of the modes nearest to them; `None` if one of them has no limit.
    fn series(
        &self,
        ray: &Ray,
        wavelengths: &[f64],
    ) -> Result<Option<(Extrapolation, Extrapolation)>, AcousticsError> {
        let completed = completed(&ray.polarizations);
        // All three modes are computed, so that they cannot be confused. If some have no stiffness, only those of
        // the ray are.
        let tensors = self.tensors(ray, &completed, wavelengths);
        let (tensors, computed) = match tensors {
            Err(_) if ray.polarizations.len() < completed.len() => {
                let own = &ray.polarizations;
                (self.tensors(ray, own, wavelengths)?, own)
            }
            tensors => (tensors?, &completed),
        };
        let points = |polarization: Vec3| {
            let points = tensors.iter().map(|a| {
                let speed = polarization.dot(&(a.over_square * polarization)).max(0.0).sqrt();
                DispersionPoint { wavenumber: a.wavenumber, speed, stddev: 0.5 * a.error * speed }
            });
            (polarization, points.collect())
        };
        let given = aligned(&ray.polarizations, self.alignment, &tensors[0].over_square);
        let modes = nearest_of(&ray.polarizations, long_wave_polarizations(&tensors, computed));
        let series =
            |polarizations: Vec<Vec3>| Extrapolation::of(polarizations.into_iter().map(points).collect());
        Ok(series(given).zip(series(modes)))
    }

    fn tensors(
        &self,
        ray: &Ray,
        polarizations: &[Vec3],
        wavelengths: &[f64],
    ) -> Result<Vec<AcousticTensor>, AcousticsError> {
        let Self { backbone, diameter, .. } = *self;
        let Settings { tolerance, max_iterations, .. } = *self.settings;
        let mut near = Vec::new();
        let mut found = Vec::with_capacity(wavelengths.len());
        for wavelength in wavelengths {
            let wavenumber = TAU / (wavelength * diameter);
            let bloch = Bloch::new(backbone, &(ray.direction * wavenumber));
            let modes = modes(&bloch, polarizations, &near, tolerance, max_iterations)
                .map_err(|error| failure(&backbone.network, error, ray.direction, wavelength * diameter))?;
            let soft = if *wavelength < SOFT_BELOW { SOFT } else { 0.0 };
            found.push(AcousticTensor {
                wavenumber,
                over_square: modes.acoustic_tensor / (wavenumber * wavenumber),
                error: (CHANGE * modes.change).hypot(REACHED * tolerance).max(soft),
            });
            near = modes.found;
        }
        Ok(found)
    }
}

/// The error of modes that were not found. A motion without resistance is no sign that the whole network has none.
fn failure(network: &SpringNetwork, error: SolveError, direction: Vec3, wavelength: f64) -> AcousticsError {
    let stiffness = || relaxed_stiffness(network, RESISTS, ITERATIONS).ok().flatten();
    let resists = || {
        stiffness().is_some_and(|c| {
            let stiffnesses = c.relaxed.mandel().symmetric_eigenvalues();
            stiffnesses.min() > RESISTS * stiffnesses.max()
        })
    };
    if error == SolveError::Floppy && !resists() {
        return NoStiffness::Floppy { contacts: network.contacts() }.into();
    }
    AcousticsError::NotConverged { direction: direction.into(), wavelength, reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_without_resistance_does_not_make_a_packing_loose_that_resists_strains() {
        let network = |packing: &Packing| Backbone::new(packing).unwrap().network;
        let reason = |packing: &Packing| failure(&network(packing), SolveError::Floppy, Vec3::z(), 1e-2);
        let mut packing = lattice_sample::lattice();
        let text = reason(&packing).to_string();
        assert!(text.contains("some grains move without resistance"), "{text}");
        packing.contacts.retain(|c| c.image == [0; 3]);
        assert!(matches!(reason(&packing), AcousticsError::NoStiffness(NoStiffness::Floppy { .. })));
    }
}
