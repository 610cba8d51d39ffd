//! Warnings about packings and their measurement.

use crate::golden::reference;
use crate::touching_itself::{OVERLAP, lattice};
use grainlab_core::contact::RollingResistance;
use grainlab_core::results::{PackingReport, warnings, yields};
use grainlab_core::{Cell, Packing, Vec3};
use grainlab_micromechanics::{Settings, analyze};

fn report(packing: &Packing) -> PackingReport {
    analyze(packing, &Settings::default()).unwrap().report
}

fn changed(change: impl FnOnce(&mut Packing)) -> String {
    let mut packing = lattice(OVERLAP);
    change(&mut packing);
    warnings(&packing, &report(&packing)).join("; ")
}

#[test]
fn a_packing_at_rest_has_no_warnings() {
    assert_eq!(changed(|_| ()), "");
}

/// Without friction a simple cubic lattice shears freely; without a bond it is open along one axis.
#[test]
fn a_packing_that_some_strain_does_not_load_is_reported() {
    let (smooth, open) = (changed(|p| p.friction = 0.0), changed(|p| _ = p.contacts.pop()));
    for text in [smooth, open] {
        assert!(text.contains("some strain of the cell meets no resistance"), "{text}");
    }
    assert!(!yields(&report(&lattice(OVERLAP))));
}

#[test]
fn missing_and_tensile_contacts_are_reported() {
    assert!(changed(|p| _ = p.contacts.pop()).contains("1 contact overlaps by position but is not listed"));
    let pulls = changed(|p| p.contacts[1].normal_force *= -1.0);
    assert!(pulls.contains("1 contact pulls") && pulls.contains("grains 0 and 0"), "{pulls}");
}

#[test]
fn grains_that_carry_force_and_move_are_reported_and_a_drift_of_all_is_no_motion() {
    for (drift, speed, spin, is_reported) in
        [(0.0, 100.0, 0.0, true), (0.0, 0.0, 1e6, true), (100.0, 0.0, 0.0, false), (0.0, 1e-6, 1e-2, false)]
    {
        let found = changed(|p| {
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
    assert!(changed(|p| p.law = p.law.with_rolling(rolling)).contains("rolling springs"));
}

/// The lattice touches its own images: tangential forces cancel as forces, and their torques do not.
#[test]
fn tangential_forces_that_twist_grains_at_rest_are_reported_unless_the_law_resists_rolling() {
    let twisted = |share: f64, unbalanced: f64, rolling: Option<RollingResistance>| {
        let mut p = lattice(OVERLAP);
        let c = &mut p.contacts[0];
        c.tangential_force = c.normal.yzx() * (share * c.normal_force);
        p.law.rolling = rolling;
        let report = PackingReport { unbalanced_force_ratio: Some(unbalanced), ..report(&p) };
        warnings(&p, &report).join("; ")
    };
    let rolling = RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 };
    for found in [twisted(0.1, 0.0, None), twisted(0.1, 9e-3, None), twisted(1e-3, 0.0, None)] {
        assert!(
            found.contains("torques do not balance") && found.contains("hertz_mindlin:KR,CR,MUR"),
            "{found}"
        );
    }
    // Grains that are not quite at rest turn a little; where forces do not balance, that is said alone.
    for found in [twisted(1e-3, 9e-3, None), twisted(0.1, 0.1, None), twisted(0.1, 0.0, Some(rolling))] {
        assert!(!found.contains("torques"), "{found}");
    }
}

#[test]
fn identical_copies_of_a_packing_are_reported_and_crystals_and_packings_at_rest_are_not() {
    let packing = reference();
    let report = report(&packing);
    let found = |p: &Packing| warnings(p, &report).join("; ");
    assert!(
        ["identical", "torques"].iter().all(|word| !found(&packing).contains(word)),
        "{}",
        found(&packing)
    );
    let mut copies = packing.repeated(2).unwrap();
    let text = found(&copies);
    assert!(text.contains("8 identical copies of 500 grains") && text.contains("factor of 2.83"), "{text}");
    copies.positions[7].x += 1e-3 * copies.radii[7];
    assert!(!found(&copies).contains("identical copies"));
    // Along one edge, as by `replicate 1 3 1`.
    let edge: Vec3 = packing.cell.matrix().column(1).into();
    let shifted = |x: Vec3| [0.0, -1.0, 1.0].map(|n| x + edge * n);
    let mut matrix = *packing.cell.matrix();
    matrix.set_column(1, &(3.0 * edge));
    let radii = packing.radii.iter().flat_map(|r| [*r; 3]).collect();
    let positions = packing.positions.iter().flat_map(|x| shifted(*x)).collect();
    let row = Packing::at_rest(Cell::new(matrix).unwrap(), radii, positions);
    assert!(found(&row).contains("3 identical copies of 500 grains"));
    assert!(!found(&lattice(OVERLAP).repeated(3).unwrap()).contains("identical copies"));
}

#[test]
fn theta_below_its_bound_forces_out_of_balance_and_an_impossible_filling_are_reported() {
    let packing = lattice(OVERLAP);
    let mut report = report(&packing);
    assert_eq!(report.unbalanced_force_ratio, Some(0.0));
    let Ok(stiffness) = &mut report.elasticity else { panic!("a lattice is stiff") };
    stiffness.bounds.bulk_reuss = Some(1.1 * stiffness.tensor.bulk_voigt());
    report.unbalanced_force_ratio = Some(0.2);
    report.solid_fraction = 5.1;
    let found = warnings(&packing, &report).join("; ");
    assert!(
        found.contains("below its lower bound")
            && found.contains("2.00e-1 of the mean contact force")
            && found.contains("5.100: no grains fill a cell so far"),
        "{found}"
    );
}
