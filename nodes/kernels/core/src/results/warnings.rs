//! Warnings about a measured packing.

use super::{ElasticStiffness, PackingReport};
use crate::notes::Note;
use crate::{Packing, PathPosition, SymmetryClass, Vec3, contact_search, non_rattlers, solid_like_share};
use std::collections::HashMap;

/// Unbalanced force ratio above which a packing is not at rest, so that the stiffness of the network is not
/// meaningful. Packings at rest are below 1e-3; contact forces that do not match the positions give some
/// tenths.
const RESTLESS: f64 = 0.01;

/// Ratio of the kinetic energy to half the sum of normal force times overlap, above which a packing is in motion. Packings at rest are below 1e-6.
const MOVING: f64 = 0.01;

/// Share of solid-like grains above which a packing is a crystal in part: random packings of one size have at most 0.02.
const CRYSTALLINE: f64 = 0.1;

/// Number of solid-like grains from which they are a crystal: one has at least eight neighbours with its order.
const NUCLEUS: f64 = 9.0;

/// Width of the cell, in mean diameters, from which no grain is a neighbour of another one on two sides.
const WIDE: f64 = 2.4;

/// Solid fraction above which spheres of any sizes would overlap by large parts of their radii.
const FULL: f64 = 0.95;

/// Standard deviation of radii over their mean below which sizes count as one.
const EQUAL_SIZES: f64 = 0.15;

/// Ratio of the mean net torque of tangential forces to the mean torque of one of them, above which something else turns the
/// grains: below 1e-3 in packings at rest of this engine, LAMMPS and YADE, 0.3 to 0.5 in those of LAMMPS with `rolling sds`.
const TWISTED: f64 = 0.05;

/// Mean net torque, in units of the unbalanced force ratio times the mean contact force times a radius, up to which it is that of
/// grains not quite at rest: 0.4 to 0.7 where the unbalanced force ratio is 0.01.
const UNEASY: f64 = 2.0;

/// Difference of two positions over the mean diameter below which they are those of two copies: more than the rounding of six
/// printed digits.
const SAME: f64 = 1e-4;

/// Number of grains below which a unit that repeats is that of a crystal.
const CRYSTAL: usize = 20;

/// Relative margin of the lower bound of Θ: for packings whose stress is not exactly isotropic.
const BELOW: f64 = 1e-3;

/// Standard deviations of ε about a fixed axis by which ε about the principal axis exceeds ε about the reference axis, and least
/// difference, from which the contacts have another axis. Contacts in all directions alike have up to 3 standard deviations about
/// their most distinct axis.
const ANOTHER_AXIS: f64 = 4.0;
const LEAST_EPS: f64 = 0.01;

/// Smallest eigenvalue of a stiffness, over the largest entry of the affine one, below which it is rounding: packings near
/// isostaticity have 1e-3 and more.
const NO_RESISTANCE: f64 = 1e-6;

/// Returns warnings about `packing` and its measurement: a place within a phase, forces or torques that do not balance, motion, copies, contacts that its
/// positions, its law or its friction contradict, bounds that do not hold. None for most packings at rest.
pub fn warnings(packing: &Packing, report: &PackingReport) -> Vec<Note> {
    let contacts = contact_search::doubts(packing).unwrap_or_else(|e| vec![Note::remark(e.to_string())]);
    let path = packing.path.as_ref().and_then(PathPosition::note);
    let others = [moving(packing), twisted(packing, report), copied(packing), crystalline(packing)];
    path.into_iter()
        .chain(report_warnings(report))
        .chain(others.into_iter().flatten())
        .chain(contacts)
        .collect()
}

/// Returns warnings about the geometry of a packing at rest, which any recorded packing may have: deep overlaps, contacts that
/// do not cross the cell, crystals.
pub fn geometry_warnings(packing: &Packing) -> Vec<Note> {
    let found = [packing.overlap_note(), packing.crossings_note(), crystalline(packing)];
    found.into_iter().flatten().collect()
}

fn restless(report: &PackingReport) -> Option<Note> {
    let unbalanced = report.unbalanced_force_ratio.filter(|u| u.is_nan() || *u > RESTLESS)?;
    Some(Note::unbalanced_forces(unbalanced, RESTLESS))
}

/// Kinetic energy of the grains that carry force, relative to the affine motion and to their mean velocity, over F_n overlap/2
/// summed over contacts.
fn moving(packing: &Packing) -> Option<Note> {
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
    (elastic > 0.0 && kinetic > MOVING * elastic).then(|| Note::in_motion(kinetic / elastic, MOVING))
}

/// Mean net torque of the tangential forces on grains that carry force, over the mean torque of one of them, where forces balance.
fn twisted(packing: &Packing, report: &PackingReport) -> Option<Note> {
    let unbalanced = report.unbalanced_force_ratio.filter(|u| *u <= RESTLESS)?;
    if packing.law.rolling.is_some() || packing.friction <= 0.0 {
        return None;
    }
    let (mut net, mut torques, mut forces) = (vec![Vec3::zeros(); packing.grains()], 0.0, 0.0);
    for c in &packing.contacts {
        for grain in [c.i, c.j].map(|g| g as usize) {
            let torque = c.normal.cross(&c.tangential_force) * packing.radii[grain];
            net[grain] += torque;
            torques += torque.norm();
            forces += c.normal_force.hypot(c.tangential_force.norm()) * packing.radii[grain];
        }
    }
    let carrying: Vec<f64> =
        net.iter().zip(non_rattlers(packing)).filter(|n| n.1).map(|n| n.0.norm()).collect();
    let net = carrying.iter().sum::<f64>() / carrying.len() as f64;
    let ends = (2 * packing.contacts.len()) as f64;
    let ratio = net / (torques / ends);
    (ratio > TWISTED && net > UNEASY * unbalanced * forces / ends)
        .then(|| Note::unbalanced_torques(ratio, TWISTED))
}

/// Number of equal parts of the cell along each edge that have the same grains.
fn copies(packing: &Packing) -> usize {
    let (grains, cell) = (packing.grains(), &packing.cell);
    let diameter = 2.0 * packing.radii.iter().sum::<f64>() / grains as f64;
    let diameters = Vec3::from_fn(|k, _| cell.matrix().column(k).norm() / diameter);
    let boxes = diameters.map(|d| (d / (2.0 * SAME)).ceil());
    let places: Vec<Vec3> = packing.positions.iter().map(|x| cell.fractional(x)).collect();
    // Both boxes along each edge that are nearest to a place, one of them its own.
    let near = |s: Vec3, up: [f64; 3]| {
        let place = |k: usize| ((s[k] * boxes[k] - 0.5).floor() + up[k]).rem_euclid(boxes[k]) as u64;
        [0, 1, 2].map(place)
    };
    let own = |s: &Vec3| near(s + boxes.map(|b| 0.5 / b), [0.0; 3]);
    let at: HashMap<_, _> = places.iter().map(own).zip(&packing.radii).collect();
    let found = |s: Vec3, radius: f64| {
        (0..8u8).any(|corner| {
            let up = [0, 1, 2].map(|k| f64::from(corner >> k & 1));
            at.get(&near(s, up)).is_some_and(|r| (*r - radius).abs() < SAME * diameter)
        })
    };
    let along = |axis: usize| {
        let repeats = |n: usize| {
            let step = Vec3::ith(axis, 1.0 / n as f64);
            places.iter().zip(&packing.radii).all(|(s, radius)| found(s + step, *radius))
        };
        // Copies are at least half a mean diameter apart.
        let most = grains.min((2.0 * diameters[axis]) as usize);
        (2..=most).rev().filter(|n| grains.is_multiple_of(*n)).find(|n| repeats(*n)).unwrap_or(1)
    };
    (0..3).map(along).product()
}

fn copied(packing: &Packing) -> Option<Note> {
    let copies = copies(packing);
    let unit = packing.grains() / copies;
    let copies = copies as f64;
    (copies > 1.0 && unit >= CRYSTAL).then(|| Note::copies(copies, unit as f64, copies.sqrt()))
}

fn below_its_bound(report: &PackingReport) -> Option<Note> {
    let stiffness = report.stiffness()?;
    // Recordings of earlier versions have a bound for laws that resist rolling, too, where it does not hold.
    if report.law.rolling.is_some() {
        return None;
    }
    let (theta, bound) = (stiffness.tensor.bulk_voigt(), stiffness.bounds.bulk_reuss?);
    (theta < bound * (1.0 - BELOW)).then(|| Note::below_bound(theta, bound))
}

/// True for a packing with a stiffness that resists some strains, and not all.
pub fn yields(report: &PackingReport) -> bool {
    report.stiffness().is_some_and(|s| least(s) < NO_RESISTANCE)
}

/// Smallest eigenvalue over the largest entry of the affine stiffness.
fn least(stiffness: &ElasticStiffness) -> f64 {
    stiffness.tensor.0.symmetric_eigenvalues().min() / stiffness.bounds.affine.0.amax()
}

fn unresisted(report: &PackingReport) -> Option<Note> {
    let least = least(report.stiffness()?);
    let is_negative = least < -NO_RESISTANCE;
    let note = || if is_negative { Note::negative_stiffness() } else { Note::no_resistance() };
    (least < NO_RESISTANCE).then(note)
}

fn overfull(report: &PackingReport) -> Option<Note> {
    let phi = report.solid_fraction;
    (phi > FULL).then(|| Note::overfull(phi))
}

/// Judged by the surroundings of the grains, because overlaps also raise the solid fraction of random packings.
fn crystalline(packing: &Packing) -> Option<Note> {
    let diameter = 2.0 * packing.radii.iter().sum::<f64>() / packing.grains() as f64;
    let is_wide = (0..3).all(|k| packing.cell.width(k) >= WIDE * diameter);
    let share =
        (is_wide && packing.size_spread() < EQUAL_SIZES).then(|| solid_like_share(packing).ok())??;
    (share > CRYSTALLINE && share * packing.grains() as f64 >= NUCLEUS - 0.5)
        .then(|| Note::crystalline(share))
}

/// A note on a packing whose anisotropy has another axis than the reference axis, beyond its noise.
fn another_axis(report: &PackingReport) -> Option<Note> {
    let (fabric, axis) = (&report.fabric, &report.fabric.principal_axis);
    let stddev = axis.contact_anisotropy_stddev?;
    let beyond = axis.contact_anisotropy.abs() - fabric.contact_anisotropy.abs();
    let symmetry = report.symmetry.as_ref();
    let class = symmetry.map(|s| s.class);
    let is_alike = matches!(class, Some(SymmetryClass::Isotropic | SymmetryClass::Cubic));
    if is_alike || beyond <= (ANOTHER_AXIS * stddev).max(LEAST_EPS) {
        return None;
    }
    // The axis of the stiffness, where it has one, scatters less.
    let is_axial = class == Some(SymmetryClass::TransverselyIsotropic);
    let found = symmetry.filter(|_| is_axial).map_or(axis.direction, |s| s.axis);
    let used = fabric.reference_axis;
    let angle = found.dot(&used).abs().min(1.0).acos().to_degrees();
    let (own, eps) = (axis.direction, axis.contact_anisotropy);
    Some(Note::another_axis(
        found.x,
        found.y,
        found.z,
        angle,
        used.x,
        used.y,
        used.z,
        eps,
        stddev,
        own.x,
        own.y,
        own.z,
        fabric.contact_anisotropy,
    ))
}

/// Warnings that follow from the report of a packing alone.
pub fn report_warnings(report: &PackingReport) -> Vec<Note> {
    let others = [
        restless(report),
        below_its_bound(report),
        unresisted(report),
        overfull(report),
        another_axis(report),
    ];
    others.into_iter().flatten().chain(report.spring_notes()).collect()
}
