//! Attenuation of plane waves in the contact network: 1/Q against frequency, of each ray and mode.
//!
//! Two causes are computed, and never mixed:
//!
//! - dissipation by the dashpots of the contacts, of the damped modes ([`ContactLoss`]): 1/Q ∝ ζ ω at long waves
//! - scattering by disorder, without dissipation ([`Scattering`](grainlab_core::results::Scattering)): 1/Q grows with ω³ or faster
//!
//! While both are small, 1/Q of a wave is their sum. Friction at sliding contacts, viscous pore fluids and the material of
//! the grains are not included.

use crate::backbone::Backbone;
use crate::dispersion::alignment::completed;
use crate::dispersion::bloch::Bloch;
use crate::dispersion::damped_modes::damped_modes;
use crate::dispersion::dashpots::dashpots;
use crate::dispersion::mean_diameter::mean_diameter;
use crate::dispersion::modes::modes;
use crate::dispersion::scattering::scattering;
use crate::error::AcousticsError;
use crate::ray::Ray;
use grainlab_core::results::{Attenuation, AttenuationPoint, ContactLoss};
use grainlab_core::{Packing, Vec3};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Shortest wavelength, mean diameters: below, neighbours move against each other.
const MIN_WAVELENGTH: f64 = 2.0;

/// Wavelength below which a plane wave is not one mode of the network, mean diameters.
const ONE_MODE: f64 = 30.0;

/// Relative error of ω² of the undamped modes, and maximum number of iterations for them.
const TOLERANCE: f64 = 1e-5;
const MAX_ITERATIONS: u32 = 20_000;

/// Settings of the attenuation.
#[derive(Clone, Debug, PartialEq)]
pub struct AttenuationSettings {
    /// Wavelengths, mean grain diameters, each above 2.
    pub wavelengths: Vec<f64>,
    /// Contact damping, share of critical, 0 to 1: see [`grainlab_dem::EngineSettings::damping`].
    pub damping: f64,
}

impl Default for AttenuationSettings {
    fn default() -> Self {
        Self { wavelengths: vec![160.0, 80.0, 40.0, 20.0, 14.0, 10.0, 7.0], damping: 0.3 }
    }
}

impl AttenuationSettings {
    /// The settings, if they are in range.
    pub fn validated(&self) -> Result<&Self, AcousticsError> {
        let fault = |name, value, requirement| Err(AcousticsError::Setting { name, value, requirement });
        if self.wavelengths.is_empty() {
            return fault("number of wavelengths of attenuation", 0.0, "1 or more");
        }
        let valid = |w: &f64| w.is_finite() && *w > MIN_WAVELENGTH;
        if let Some(wrong) = self.wavelengths.iter().find(|w| !valid(w)) {
            return fault("wavelength of attenuation", *wrong, "more than 2 mean grain diameters, finite");
        }
        if !(0.0..=1.0).contains(&self.damping) {
            return fault("contact damping", self.damping, "0 to 1, share of critical");
        }
        Ok(self)
    }
}

/// Attenuation of all polarizations of all rays, in that order; the same to the last bit for any number of threads.
///
/// Needs about as much time as [`super::curves`] for each long wave, and some times as much for each wave short enough to be
/// scattered.
pub fn attenuation(
    packing: &Packing,
    rays: &[Ray],
    settings: &AttenuationSettings,
) -> Result<Vec<Attenuation>, AcousticsError> {
    settings.validated()?;
    let backbone = Backbone::new(packing)?;
    let diameter = mean_diameter(packing);
    let mut wavelengths = settings.wavelengths.clone();
    wavelengths.sort_by(|a, b| b.total_cmp(a));
    let places: Vec<(&Ray, f64)> =
        rays.iter().flat_map(|ray| wavelengths.iter().map(move |w| (ray, *w))).collect();
    let found: Vec<Vec<AttenuationPoint>> =
        places.par_iter().map(|(ray, w)| points(&backbone, ray, *w, diameter, settings.damping)).collect();
    let of = |(ray, at): (&Ray, &[Vec<AttenuationPoint>])| {
        let curve = |(k, polarization): (usize, &Vec3)| Attenuation {
            direction: ray.direction,
            polarization: *polarization,
            points: at.iter().map(|points| points[k]).collect(),
        };
        ray.polarizations.iter().enumerate().map(curve).collect::<Vec<_>>()
    };
    Ok(rays.iter().zip(found.chunks(wavelengths.len())).flat_map(of).collect())
}

/// One point for each polarization of `ray`, at a wavelength in mean diameters.
fn points(
    backbone: &Backbone,
    ray: &Ray,
    wavelength: f64,
    diameter: f64,
    damping: f64,
) -> Vec<AttenuationPoint> {
    let wavenumber = TAU / (wavelength * diameter);
    let q = ray.direction * wavenumber;
    let bloch = Bloch::new(backbone, &q);
    let all = completed(&ray.polarizations);
    let contact =
        if wavelength >= ONE_MODE { contact_losses(&bloch, ray, &all, &q, damping) } else { Vec::new() };
    let scattering = scattering(&bloch, wavenumber, &ray.direction, &[all[0], all[1], all[2]]);
    let point = |k: usize| AttenuationPoint {
        wavenumber,
        contact: contact.get(k).copied().flatten(),
        scattering: scattering[k],
    };
    (0..ray.polarizations.len()).map(point).collect()
}

/// The loss of each mode, in the order of the polarizations nearest to it; empty if the modes are not found.
fn contact_losses(
    bloch: &Bloch<'_>,
    ray: &Ray,
    all: &[Vec3],
    q: &Vec3,
    damping: f64,
) -> Vec<Option<ContactLoss>> {
    let of = |polarizations: &[Vec3]| modes(bloch, polarizations, &[], TOLERANCE, MAX_ITERATIONS);
    // If some polarizations have no stiffness, only those of the ray are computed.
    let Ok(undamped) = of(all).or_else(|_| of(&ray.polarizations)) else { return Vec::new() };
    let count = undamped.motions.len();
    let dashpots = dashpots(bloch.backbone, q, damping);
    let damped = damped_modes(bloch, &dashpots, &undamped.found, count, MAX_ITERATIONS);
    let Ok(damped) = damped else { return Vec::new() };
    let mut left: Vec<usize> = (0..count).collect();
    let mut nearest = |polarization: &Vec3| {
        let along = |k: usize| undamped.motions[k].dot(polarization).abs();
        let most = (0..left.len()).max_by(|a, b| along(left[*a]).total_cmp(&along(left[*b])))?;
        damped[left.swap_remove(most)].map(|mode| ContactLoss {
            omega: mode.omega,
            loss: mode.loss,
            stddev: mode.change * mode.loss,
            first_order: mode.first_order,
        })
    };
    ray.polarizations.iter().map(&mut nearest).collect()
}
