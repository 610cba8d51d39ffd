//! Acoustic modes of the frozen contact network at Bloch wave vectors.
//!
//! The packing is repeated for ever, so that waves of any length and direction fit in. At each wave vector q the three
//! acoustic modes are found to rounding; ω²/q² bends as 1 − b q² and is extrapolated to long waves ([`crate::curve`]).
//! Nothing moves: amplitudes are infinitely small, contacts neither open nor slide.

mod bloch;
#[cfg(test)]
mod lattice_sample;
mod modes;
mod row;
mod solve;
mod subspace;

use crate::curve::{Curve, Point};
use crate::dispersion::bloch::Bloch;
use crate::dispersion::modes::{Stopped, modes};
use crate::error::AcousticsError;
use crate::measure::Warning;
use crate::participation::Carrier;
use crate::ray::Ray;
use grainlab_core::{Mat3, Packing, Vec3};
use nalgebra::SymmetricEigen;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Waves of less than this many mean diameters are no waves of a medium: neighbours move against each other.
const SHORTEST: f64 = 2.0;

/// Waves of less than this many mean diameters leave loose grains of a packing behind, one after the other, which makes them
/// faster by up to this share of ω².
const SOFT_BELOW: f64 = 100.0;
const SOFT: f64 = 1e-3;

/// How dispersion is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Wavelengths in mean grain diameters, three or more different ones, each above 2. In packings of z = 5 waves shorter than some 100 diameters
    /// leave loose grains behind that longer ones take along, and are faster for that by up to a thousandth.
    pub wavelengths: Vec<f64>,
    /// Relative error allowed to ω², in [1e-12, 1e-2].
    pub tolerance: f64,
    /// Iterations of conjugate gradients after which a wave vector is given up.
    pub max_iterations: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { wavelengths: vec![160.0, 240.0, 320.0], tolerance: 1e-5, max_iterations: 20_000 }
    }
}

/// The curves of every ray's motions, in that order.
///
/// Where a ray has three motions, the first two span its plane with the axis and are turned in it to those of the modes: what
/// is not symmetric about that plane in a packing averages out over azimuths and is left out. Two or one are taken as they
/// are. Speeds are √(pᵀ R p)/q of the motion p, with R = Σ ω² p p* over the modes.
pub fn curves(packing: &Packing, rays: &[Ray], settings: &Settings) -> Result<Vec<Curve>, AcousticsError> {
    check(settings)?;
    let carrier = Carrier::new(packing)?;
    curves_of(&carrier, mean_diameter(packing), rays, Turn::InPlane, settings)
}

/// How the motions of a ray that has three are turned to those of the modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// The first two, in their plane.
    InPlane,
    /// All.
    Freely,
}

pub(crate) fn mean_diameter(packing: &Packing) -> f64 {
    2.0 * packing.radii.iter().sum::<f64>() / packing.grains() as f64
}

pub(crate) fn check(settings: &Settings) -> Result<(), AcousticsError> {
    let range = |name, value: f64, valid: bool, requirement| {
        if valid { Ok(()) } else { Err(AcousticsError::Setting { name, value, requirement }) }
    };
    let mut different = settings.wavelengths.clone();
    different.sort_by(f64::total_cmp);
    different.dedup_by(|a, b| (*a - *b).abs() <= 1e-6 * b.abs());
    let count = different.len();
    let requirement = "3 or more different ones, to extrapolate from and to tell how well";
    range("number of wavelengths", count as f64, count >= 3, requirement)?;
    for wavelength in &settings.wavelengths {
        let valid = wavelength.is_finite() && *wavelength > SHORTEST;
        range("wavelength", *wavelength, valid, "more than 2 mean grain diameters, finite")?;
    }
    let (t, n) = (settings.tolerance, settings.max_iterations);
    range("tolerance", t, (1e-12..=1e-2).contains(&t), "between 1e-12 and 1e-2")?;
    range("max_iterations", f64::from(n), n > 0, "1 or more")
}

/// The curves of the rays that have any; those whose modes are not found are left out with a warning, unless all are.
pub(crate) fn all_curves(
    carrier: &Carrier,
    diameter: f64,
    rays: &[Ray],
    turn: Turn,
    settings: &Settings,
) -> Result<(Vec<Curve>, Vec<Warning>), AcousticsError> {
    let found: Vec<_> =
        rays.par_iter().map(|ray| curves_along(carrier, diameter, ray, turn, settings)).collect();
    let (mut curves, mut warnings, mut lost) = (Vec::new(), Vec::new(), None);
    for found in found {
        match found {
            Ok(found) => curves.extend(found),
            Err(error @ (AcousticsError::NotConverged { .. } | AcousticsError::NoSignal { .. })) => {
                lost = lost.or_else(|| Some(error.clone()));
                warnings.push(Warning::LeftOut(error));
            }
            Err(error) => return Err(error),
        }
    }
    match lost {
        Some(error) if curves.is_empty() => Err(error),
        _ => Ok((curves, warnings)),
    }
}

fn curves_of(
    carrier: &Carrier,
    diameter: f64,
    rays: &[Ray],
    turn: Turn,
    settings: &Settings,
) -> Result<Vec<Curve>, AcousticsError> {
    let curves: Result<Vec<_>, _> =
        rays.par_iter().map(|ray| curves_along(carrier, diameter, ray, turn, settings)).collect();
    Ok(curves?.into_iter().flatten().collect())
}

/// R/q² at one wave number.
struct Resistance {
    wavenumber: f64,
    /// m²/s².
    over_square: Mat3,
    /// Relative error of ω².
    error: f64,
}

fn curves_along(
    carrier: &Carrier,
    diameter: f64,
    ray: &Ray,
    turn: Turn,
    settings: &Settings,
) -> Result<Vec<Curve>, AcousticsError> {
    let mut wavelengths = settings.wavelengths.clone();
    wavelengths.sort_by(|a, b| b.total_cmp(a));
    let complete = complete(&ray.motions);
    // All three modes are sought, so that none is mistaken for another; where some meet no resistance, those asked for.
    let found = resistances(carrier, ray, &complete, diameter, &wavelengths, settings);
    let found = match found {
        Err(_) if ray.motions.len() < complete.len() => {
            resistances(carrier, ray, &ray.motions, diameter, &wavelengths, settings)?
        }
        found => found?,
    };
    let curve = |motion: Vec3| {
        let points = found.iter().map(|r| {
            let speed = motion.dot(&(r.over_square * motion)).max(0.0).sqrt();
            Point { wavenumber: r.wavenumber, speed, stddev: 0.5 * r.error * speed }
        });
        Curve::through(ray.direction, motion, points.collect()).ok_or_else(|| AcousticsError::NoSignal {
            what: "long wave",
            direction: ray.direction.into(),
            motion: motion.into(),
            reason: "its speeds extrapolate to none; use longer waves".to_owned(),
        })
    };
    turned(&ray.motions, turn, &found[0].over_square).into_iter().map(curve).collect()
}

/// The motions, and what makes them three perpendicular ones.
fn complete(motions: &[Vec3]) -> Vec<Vec3> {
    let mut all = motions.to_vec();
    while all.len() < 3 {
        let left = |e: &Vec3| e - all.iter().map(|m| *m * m.dot(e)).sum::<Vec3>();
        let next = (0..3).map(|k| left(&Vec3::ith(k, 1.0))).max_by(|a, b| a.norm().total_cmp(&b.norm()));
        all.push(next.unwrap_or_default().normalize());
    }
    all
}

/// Three motions turned to the modes of `resistance`; others as they are.
fn turned(motions: &[Vec3], turn: Turn, resistance: &Mat3) -> Vec<Vec3> {
    let Ok(all) = <[Vec3; 3]>::try_from(motions) else { return motions.to_vec() };
    let frame = Mat3::from_columns(&all);
    let mut inside = frame.transpose() * resistance * frame;
    if turn == Turn::InPlane {
        for k in 0..2 {
            (inside[(k, 2)], inside[(2, k)]) = (0.0, 0.0);
        }
    }
    let modes = frame * SymmetricEigen::new(inside).eigenvectors;
    // Each motion's mode is the one that is most along it, of those left.
    let mut left: Vec<Vec3> = modes.column_iter().map(|c| c.into_owned()).collect();
    let mut nearest_mode = |motion: &Vec3| {
        let most =
            (0..left.len()).max_by(|a, b| left[*a].dot(motion).abs().total_cmp(&left[*b].dot(motion).abs()));
        let mode = left.swap_remove(most.unwrap_or_default());
        if mode.dot(motion) < 0.0 { -mode } else { mode }
    };
    motions.iter().map(&mut nearest_mode).collect()
}

fn resistances(
    carrier: &Carrier,
    ray: &Ray,
    motions: &[Vec3],
    diameter: f64,
    wavelengths: &[f64],
    settings: &Settings,
) -> Result<Vec<Resistance>, AcousticsError> {
    let mut near = Vec::new();
    let mut found = Vec::with_capacity(wavelengths.len());
    for wavelength in wavelengths {
        let wavenumber = TAU / (wavelength * diameter);
        let bloch = Bloch::new(carrier, &(ray.direction * wavenumber));
        let Settings { tolerance, max_iterations, .. } = *settings;
        let modes = modes(&bloch, motions, &near, tolerance, max_iterations).map_err(|stopped| {
            let contacts = carrier.network.contacts();
            match stopped {
                Stopped::NoResistance => grainlab_core::results::NotJammed::Floppy { contacts }.into(),
                stopped => AcousticsError::NotConverged {
                    direction: ray.direction.into(),
                    wavelength: wavelength * diameter,
                    reason: stopped.to_string(),
                },
            }
        })?;
        found.push(Resistance {
            wavenumber,
            over_square: modes.resistance / (wavenumber * wavenumber),
            error: modes.change.max(tolerance).max(if *wavelength < SOFT_BELOW { SOFT } else { 0.0 }),
        });
        near = modes.found;
    }
    Ok(found)
}
