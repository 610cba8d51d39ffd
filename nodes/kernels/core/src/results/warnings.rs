//! Warnings about a measured packing.

use super::{ElasticStiffness, PackingReport};
use crate::{Packing, Vec3, contact_search, non_rattlers};

/// Unbalanced force ratio above which a packing is not at rest, so that the stiffness of the network is not
/// meaningful. Packings at rest are below 1e-3; contact forces that do not match the positions give some
/// tenths.
const RESTLESS: f64 = 0.01;

/// Ratio of the kinetic energy to half the sum of normal force times overlap, above which a packing is in motion. Packings at rest are below 1e-6.
const MOVING: f64 = 0.01;

/// Solid fraction above which spheres of nearly one size are not packed at random, with room for their overlaps.
const RANDOM: f64 = 0.67;

/// Solid fraction above which spheres of any sizes would overlap by large parts of their radii.
const FULL: f64 = 0.95;

/// Standard deviation of radii over their mean below which sizes count as one.
const EQUAL_SIZES: f64 = 0.15;

/// Relative margin of the lower bound of Θ: for packings whose stress is not exactly isotropic.
const BELOW: f64 = 1e-3;

/// Smallest eigenvalue of a stiffness, over the largest entry of the affine one, below which it is rounding: packings near
/// isostaticity have 1e-3 and more.
const NO_RESISTANCE: f64 = 1e-6;

/// Warnings about `packing` and its measurement: forces that do not balance, motion, contacts that its positions, its law or its
/// friction contradict, bounds that do not hold. None for most packings at rest.
pub fn warnings(packing: &Packing, report: &PackingReport) -> Vec<String> {
    let contacts = contact_search::doubts(packing).unwrap_or_else(|e| vec![e.to_string()]);
    report_warnings(report).into_iter().chain(moving(packing)).chain(contacts).collect()
}

fn restless(report: &PackingReport) -> Option<String> {
    let unbalanced = report.unbalanced_force_ratio.filter(|u| u.is_nan() || *u > RESTLESS)?;
    Some(format!(
        "forces do not balance: the mean net force of a grain is {unbalanced:.2e} of the mean contact force (more than \
         {RESTLESS}): the packing moves, or contact forces are missing or wrong; stress and stiffness are those of a packing \
         that is not at rest"
    ))
}

/// Kinetic energy of the grains that carry force, relative to the affine motion and to their mean velocity, over F_n overlap/2
/// summed over contacts.
fn moving(packing: &Packing) -> Option<String> {
    let elastic: f64 = packing.contacts.iter().map(|c| 0.5 * c.normal_force.abs() * c.overlap).sum();
    let carries = non_rattlers(packing);
    let carrying = || (0..packing.grains()).filter(|g| carries[*g]);
    let mass = |g: usize| packing.material.sphere_mass(packing.radii[g]);
    let momentum: Vec3 = carrying().map(|g| packing.velocities[g] * mass(g)).sum();
    let mean = momentum / carrying().map(mass).sum::<f64>().max(f64::MIN_POSITIVE);
    let energy = |g: usize| {
        let (radius, v, w) = (packing.radii[g], packing.velocities[g] - mean, packing.spins[g]);
        0.5 * mass(g) * (v.norm_squared() + 0.4 * radius * radius * w.norm_squared())
    };
    let kinetic: f64 = carrying().map(energy).sum();
    (elastic > 0.0 && kinetic > MOVING * elastic).then(|| {
        format!(
            "the packing is in motion: the kinetic energy of its grains that carry force, about their mean velocity, is {:.1e} of \
             half the sum of normal force times overlap (more than {MOVING}); check the velocities and their units, or let it come to rest",
            kinetic / elastic
        )
    })
}

fn below_its_bound(report: &PackingReport) -> Option<String> {
    let stiffness = report.stiffness()?;
    // Recordings of earlier versions have a bound for laws that resist rolling, too, where it does not hold.
    if report.law.rolling.is_some() {
        return None;
    }
    let (theta, bound) = (stiffness.tensor.bulk_voigt(), stiffness.bounds.bulk_reuss?);
    (theta < bound * (1.0 - BELOW)).then(|| {
        format!(
            "Theta {:.4e} Pa is below its lower bound by the forces present, {:.4e} Pa: contacts are missing, or forces are \
             not those of a packing at rest",
            theta, bound
        )
    })
}

/// True for a packing with a stiffness that resists some strains, and not all.
pub fn yields(report: &PackingReport) -> bool {
    report.stiffness().is_some_and(|s| least(s) < NO_RESISTANCE)
}

/// Smallest eigenvalue over the largest entry of the affine stiffness.
fn least(stiffness: &ElasticStiffness) -> f64 {
    stiffness.tensor.0.symmetric_eigenvalues().min() / stiffness.bounds.affine.0.amax()
}

fn unresisted(report: &PackingReport) -> Option<String> {
    let least = least(report.stiffness()?);
    (least < NO_RESISTANCE).then(|| {
        let text = if least < -NO_RESISTANCE {
            "the stiffness is negative under some strain: the packing is stable only while that strain is held"
        } else {
            "some strain of the cell meets no resistance: the contacts do not span it in every direction; moduli of 0 are those of \
             no packing at rest"
        };
        text.to_owned()
    })
}

/// Random packings of spheres of nearly one size have a solid fraction of at most .64 at small pressures.
fn crystalline(report: &PackingReport) -> Option<String> {
    let phi = report.solid_fraction;
    if phi > FULL {
        return Some(format!(
            "solid fraction {phi:.3}: no grains fill a cell so far; check the units of cell and radii"
        ));
    }
    (report.size_spread < EQUAL_SIZES && phi > RANDOM).then(|| {
        format!(
            "solid fraction {phi:.3} is above that of random packings of spheres of one size (0.64): the grains have \
             crystallised in part, as they do in small cells; the inversion was calibrated on random packings"
        )
    })
}

/// Warnings that follow from the report of a packing alone.
pub fn report_warnings(report: &PackingReport) -> Vec<String> {
    let springs = report.spring_notes().into_iter().map(|note| format!("stiffness {note}"));
    let others = [restless(report), below_its_bound(report), unresisted(report), crystalline(report)];
    others.into_iter().flatten().chain(springs).collect()
}
