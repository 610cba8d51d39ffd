//! Warnings about a measured state.

use grainlab_core::Packing;
use grainlab_core::results::{ElasticStiffness, PackingReport};
use grainlab_core::{Vec3, non_rattlers};
use grainlab_experiment::PathPosition;
use grainlab_recordings::import::contacts;
use std::collections::BTreeSet;

/// Unbalanced force ratio above which a packing is not at rest, so that the stiffness of the network is not
/// meaningful. Packings at rest are below 1e-3; contact forces that do not match the positions give some
/// tenths.
const RESTLESS: f64 = 0.01;

/// Kinetic over elastic energy above which a packing is in motion. Packings at rest are below 1e-6.
const MOVING: f64 = 0.01;

/// Solid fraction above which spheres of nearly one size are not packed at random, with room for their overlaps.
const RANDOM: f64 = 0.67;

/// Standard deviation of radii over their mean below which sizes count as one.
const EQUAL_SIZES: f64 = 0.15;

/// Relative margin of the lower bound of Θ: for packings whose stress is not exactly isotropic.
const BELOW: f64 = 1e-3;

/// Smallest eigenvalue of a stiffness, over the largest entry of the affine one, below which it is rounding: packings near
/// isostaticity have 1e-3 and more.
const NO_RESISTANCE: f64 = 1e-6;

/// All warnings about `packing` and its measurement; `notes` are those of the reader of the file.
pub fn state_warnings(
    packing: &Packing,
    report: &PackingReport,
    position: Option<PathPosition>,
    notes: &[String],
) -> Vec<String> {
    let of_packing = [moving(packing), pulling(packing), missing(packing, notes)];
    position
        .and_then(within_phase)
        .into_iter()
        .chain(of_report(report))
        .chain(of_packing.into_iter().flatten())
        .collect()
}

fn within_phase(position: PathPosition) -> Option<String> {
    let PathPosition { phase, end_of_phase, .. } = position;
    (!end_of_phase).then(|| {
        format!("recorded within phase {phase}, which had not met its end conditions: the packing need not be at rest")
    })
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
            "the packing is in motion: the kinetic energy of its grains is {:.1e} of the elastic energy of its contacts (more \
             than {MOVING}); check the velocities and their units, or let it come to rest",
            kinetic / elastic
        )
    })
}

fn below_its_bound(report: &PackingReport) -> Option<String> {
    let stiffness = report.stiffness()?;
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
    (report.size_spread < EQUAL_SIZES && phi > RANDOM).then(|| {
        format!(
            "solid fraction {phi:.3} is above that of random packings of spheres of one size (0.64): the grains have \
             crystallised in part, as they do in small cells; the inversion was calibrated on random packings"
        )
    })
}

fn pulling(packing: &Packing) -> Option<String> {
    let mut pulling = packing.contacts.iter().filter(|c| c.normal_force < 0.0);
    let first = pulling.next()?;
    let [i, j] = [first.i, first.j].map(|g| packing.ids[g as usize]);
    let pull = match pulling.count() + 1 {
        1 => "1 contact pulls".to_owned(),
        n => format!("{n} contacts pull"),
    };
    Some(format!("{pull} (normal force below 0), the first of grains {i} and {j}: Hertz's law only presses"))
}

/// Warnings that follow from the report of a packing alone.
pub(crate) fn of_report(report: &PackingReport) -> Vec<String> {
    let springs = report.spring_notes().into_iter().map(|note| format!("stiffness {note}"));
    let others = [restless(report), below_its_bound(report), unresisted(report), crystalline(report)];
    others.into_iter().flatten().chain(springs).collect()
}

/// Contacts by position that are missing in the list; the readers of some files have already reported them.
fn missing(packing: &Packing, notes: &[String]) -> Option<String> {
    if notes.iter().any(|w| w.contains("not listed")) {
        return None;
    }
    let force = |r_eff, overlap| packing.law.normal_force(&packing.material, r_eff, overlap);
    let found = contacts::find(&packing.cell, &packing.positions, &packing.radii, force).ok()?;
    let listed: BTreeSet<_> = packing.contacts.iter().map(|c| (c.i, c.j, c.image)).collect();
    // A contact with an own image may be listed under either of its two images.
    let has = |c: &grainlab_core::Contact| {
        listed.contains(&(c.i, c.j, c.image))
            || (c.i == c.j && listed.contains(&(c.i, c.j, c.image.map(|k| k.saturating_neg()))))
    };
    // Overlaps below rounding are not contacts.
    let rounding = 64.0 * f64::EPSILON * packing.cell.matrix().amax();
    let mut missing = found.iter().filter(|c| c.overlap > rounding && !has(c));
    let first = missing.next()?;
    let [i, j] = [first.i, first.j].map(|g| packing.ids[g as usize]);
    let overlap = match missing.count() + 1 {
        1 => "1 contact overlaps by position but is not listed".to_owned(),
        n => format!("{n} contacts overlap by position but are not listed"),
    };
    Some(format!("{overlap}, the first of grains {i} and {j}"))
}

#[cfg(test)]
#[path = "../../acoustic_probe/tests/probe/lattice.rs"]
mod lattice;

#[cfg(test)]
mod tests {
    use super::lattice::{OVERLAP, lattice};
    use super::*;
    use grainlab_core::contact::RollingResistance;
    use grainlab_micromechanics::{Settings, analyze};

    fn report(packing: &Packing) -> PackingReport {
        analyze(packing, &Settings::default()).unwrap().report
    }

    fn warnings(change: impl FnOnce(&mut Packing)) -> String {
        let mut packing = lattice(OVERLAP);
        change(&mut packing);
        state_warnings(&packing, &report(&packing), None, &[]).join("; ")
    }

    #[test]
    fn a_packing_at_rest_has_no_warnings() {
        assert_eq!(warnings(|_| ()), "");
    }

    /// Without friction a simple cubic lattice shears freely; without a bond it is open along one axis.
    #[test]
    fn a_packing_that_some_strain_does_not_load_is_reported() {
        let (smooth, open) = (warnings(|p| p.friction = 0.0), warnings(|p| _ = p.contacts.pop()));
        for text in [smooth, open] {
            assert!(text.contains("some strain of the cell meets no resistance"), "{text}");
        }
        assert!(!yields(&report(&lattice(OVERLAP))));
    }

    #[test]
    fn missing_and_tensile_contacts_are_reported() {
        assert!(
            warnings(|p| _ = p.contacts.pop()).contains("1 contact overlaps by position but is not listed")
        );
        let pulls = warnings(|p| p.contacts[1].normal_force *= -1.0);
        assert!(pulls.contains("1 contact pulls") && pulls.contains("grains 0 and 0"), "{pulls}");
    }

    #[test]
    fn grains_that_carry_force_and_move_are_reported_and_a_drift_of_all_is_no_motion() {
        for (drift, speed, spin, is_reported) in [
            (0.0, 100.0, 0.0, true),
            (0.0, 0.0, 1e6, true),
            (100.0, 0.0, 0.0, false),
            (0.0, 1e-6, 1e-2, false),
        ] {
            let found = warnings(|p| {
                *p = p.repeated(2).unwrap();
                p.velocities.iter_mut().for_each(|v| v.x += drift);
                (p.velocities[0].x, p.spins[0].y) = (drift + speed, spin);
            });
            assert_eq!(found.contains("in motion: the kinetic energy"), is_reported, "{found}");
        }
    }

    #[test]
    fn rolling_springs_that_the_network_lacks_are_reported() {
        let rolling = RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 };
        assert!(warnings(|p| p.law = p.law.with_rolling(rolling)).contains("rolling springs"));
    }

    #[test]
    fn theta_below_the_bound_by_the_forces_present_and_forces_out_of_balance_are_reported() {
        let packing = lattice(OVERLAP);
        let mut report = report(&packing);
        assert_eq!(report.unbalanced_force_ratio, Some(0.0));
        let Ok(stiffness) = &mut report.elasticity else { panic!("a lattice is stiff") };
        stiffness.bounds.bulk_reuss = Some(1.1 * stiffness.tensor.bulk_voigt());
        report.unbalanced_force_ratio = Some(0.2);
        let found = state_warnings(&packing, &report, None, &[]).join("; ");
        assert!(
            found.contains("below its lower bound") && found.contains("2.00e-1 of the mean contact force"),
            "{found}"
        );
    }
}
