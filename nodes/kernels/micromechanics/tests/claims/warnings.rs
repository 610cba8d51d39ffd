//! Warnings about packings and their measurement.

use crate::golden::reference;
use grainlab_core::contact::RollingResistance;
use grainlab_core::notes::{Code, texts};
use grainlab_core::results::{PackingReport, geometry_warnings, warnings, yields};
use grainlab_core::{Cell, Packing, SymmetryClass, Vec3, contact_search};
use grainlab_micromechanics::{Settings, analyze};
use grainlab_testkit::packings::{DIAMETER, FACE_CENTRED, OVERLAP, lattice};

fn report(packing: &Packing) -> PackingReport {
    analyze(packing, &Settings::default()).unwrap().report
}

fn changed(change: impl FnOnce(&mut Packing)) -> String {
    let mut packing = lattice(OVERLAP);
    change(&mut packing);
    texts(&warnings(&packing, &report(&packing))).join("; ")
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
        texts(&warnings(&p, &report)).join("; ")
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
    let found = |p: &Packing| texts(&warnings(p, &report)).join("; ");
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

/// Reports with the fabric and the symmetry of h03, a packing that was sheared in xz: 5.5 standard deviations.
#[test]
fn an_axis_other_than_the_one_used_is_named_if_the_anisotropy_is_beyond_its_noise() {
    let packing = reference();
    let report = report(&packing);
    let found = |eps: f64, about: f64, class: SymmetryClass| {
        let mut report = report.clone();
        let symmetry = report.symmetry.as_mut().unwrap();
        (symmetry.class, symmetry.axis) = (class, Vec3::new(0.6, 0.0, 0.8));
        report.fabric.contact_anisotropy = about;
        report.fabric.principal_axis.direction = Vec3::new(0.8, 0.0, 0.6);
        report.fabric.principal_axis.contact_anisotropy = eps;
        report.fabric.principal_axis.contact_anisotropy_stddev = Some(0.0126);
        warnings(&packing, &report).iter().map(ToString::to_string).find(|w| w.contains("has its axis at"))
    };
    let axial = SymmetryClass::TransverselyIsotropic;
    let text = found(-0.0814, 0.0123, axial).unwrap();
    assert!(text.contains("(0.60, 0.00, 0.80), 37 degrees from the axis (0.00, 0.00, 1.00)"), "{text}");
    assert!(text.contains("eps -0.081 +- 0.013") && text.contains("--axis 0.60,0.00,0.80"), "{text}");
    let lower = found(-0.0814, 0.0123, SymmetryClass::Lower).unwrap();
    assert!(lower.contains("--axis 0.80,0.00,0.60"), "{lower}");
    for (eps, about, class) in [
        // Contacts in all directions alike; a stiffness without an axis; an axis near the one used.
        (0.03, 0.0, axial),
        (-0.0814, 0.0123, SymmetryClass::Isotropic),
        (0.0814, 0.079, axial),
    ] {
        assert_eq!(found(eps, about, class), None, "{eps} {about}");
    }
    assert!(!warnings(&packing, &report).iter().any(|w| w.is(Code::AnotherAxis)));
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
    let found = texts(&warnings(&packing, &report)).join("; ");
    assert!(
        found.contains("below its lower bound")
            && found.contains("2.00e-1 of the mean contact force")
            && found.contains("5.100: no grains fill a cell so far"),
        "{found}"
    );
}

/// Compressed by 3.5 % it fills as much of the cell as a crystal: its solid fraction does not tell.
#[test]
fn crystals_are_reported_by_their_structure_and_compressed_random_packings_are_not() {
    let random = reference();
    let mut compressed = random.clone();
    compressed.radii.iter_mut().for_each(|r| *r *= 1.035);
    compressed.contacts = contact_search::of_packing(&compressed).unwrap();
    assert!(compressed.solid_fraction() > 0.67, "{}", compressed.solid_fraction());
    let edge = 2f64.sqrt() * DIAMETER;
    let sites = FACE_CENTRED.map(|s| Vec3::from(s) * edge).to_vec();
    let crystal =
        Packing::at_rest(Cell::cube(edge).unwrap(), vec![0.501 * DIAMETER; 4], sites).repeated(3).unwrap();
    for (packing, is_crystal) in [(random, false), (compressed, false), (crystal, true)] {
        let found = texts(&geometry_warnings(&packing)).join("; ");
        assert_eq!(found.contains("have the surroundings of a crystal"), is_crystal, "{found}");
        // Grains of many sizes have no crystal that this could know.
        let radii = packing.radii.iter().enumerate().map(|(k, r)| r * (1.0 - 0.4 * (k % 2) as f64)).collect();
        let mixed = Packing { radii, contacts: Vec::new(), ..packing };
        assert!(!texts(&geometry_warnings(&mixed)).join("; ").contains("crystal"));
    }
}

/// A cell of eight grains is so narrow that each neighbour of a grain is one on two sides.
#[test]
fn crystals_are_reported_also_if_simple_cubic_and_none_in_a_cell_of_few_grains() {
    for (copies, is_crystal) in [(1, false), (2, false), (3, true), (5, true)] {
        let found = texts(&geometry_warnings(&lattice(OVERLAP).repeated(copies).unwrap())).join("; ");
        assert_eq!(
            found.contains("100 % of the grains have the surroundings of a crystal"),
            is_crystal,
            "{found}"
        );
    }
}

/// Also where the packing is one of a recording, whose report does not have its geometry.
#[test]
fn overlaps_beyond_the_contact_law_and_planes_without_contacts_are_reported() {
    let deep = lattice(0.12 * DIAMETER);
    let said = changed(|p| p.clone_from(&deep));
    assert!(said.contains("overlap by more than 10 %") && said.contains("there are no moduli"), "{said}");
    let hertz = changed(|p| *p = lattice(0.06 * DIAMETER));
    assert!(hertz.contains("Hertz's law, which is for contacts far smaller"), "{hertz}");
    let mut open = lattice(OVERLAP).repeated(5).unwrap();
    open.contacts.retain(|c| c.image[1] == 0);
    assert!(changed(|p| p.clone_from(&open)).contains("open across edge b of the cell"));
    for (packing, words) in [(open, "open across edge b"), (deep, "overlap by more than 10 %")] {
        let found = texts(&geometry_warnings(&packing)).join("; ");
        assert!(found.contains(words), "{found}");
    }
}
