//! Coordination, rattlers, fabric, γ/Δ, balance, and packings without a network.

use crate::samples::{packing, random, turned};
use grainlab_core::results::NoStiffness;
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_micromechanics::{Analysis, MicroError, Settings, analyze};
use grainlab_testkit::packings::{DIAMETER, lattice};
use nalgebra::Rotation3;

const D: f64 = 2.0e-4;

fn sites(edge: f64, sites: &[[f64; 3]], friction: f64) -> Packing {
    let positions = sites.iter().map(|s| Vec3::from(*s) * D).collect();
    packing(Cell::cube(edge * D).unwrap(), positions, 0.5 * D * (1.0 + 1e-4), friction, None)
}

fn measured(p: &Packing) -> Analysis {
    analyze(p, &Settings::default()).unwrap()
}

fn assert_finite(a: &Analysis) {
    let r = &a.report;
    let (c, f, d) = (&r.contacts, &r.fabric, &r.stress_decomposition);
    let fabrics = [
        f.contact_fabric,
        f.normal_force_fabric,
        f.stiffness_fabric,
        f.tangential_force_fabric,
        r.stress.tensor,
    ];
    let parts = [d.normal, d.tangential, d.strong.stress, d.weak.stress, d.strong.fabric, d.weak.fabric];
    assert!(fabrics.iter().chain(&parts).all(|t| t.is_finite()));
    let (o, axis) = (&f.orientation, &f.principal_axis);
    let means = o.overlap.iter().chain(&o.sqrt_overlap).chain(&f.fourth_order.components);
    let eps = [axis.contact_anisotropy, d.strong.contact_anisotropy, d.weak.contact_anisotropy];
    assert!(means.chain(&eps).chain([&f.fourth_order.magnitude]).all(|v| v.is_finite()));
    assert_eq!(o.contacts.iter().sum::<u32>(), c.contacts);
    if c.contacts == 0 {
        assert!(c.forces.is_none() && c.friction.is_none() && d.stress_force_fabric.is_none());
        assert!(o.contact_fit.is_none() && axis.contact_anisotropy_stddev.is_none() && !axis.determined);
    }
    let numbers = [
        c.coordination,
        c.mechanical_coordination,
        c.sliding_fraction,
        f.contact_anisotropy,
        f.p4_coefficient,
        r.pressure(),
        r.solid_fraction,
    ];
    assert!(numbers.iter().all(|v| v.is_finite()), "{numbers:?}");
    assert!((axis.direction.norm() - 1.0).abs() < 1e-12);
}

#[test]
fn a_gas_has_no_network_and_no_nan() {
    let a = measured(&sites(4.0, &[[0.0; 3], [2.0, 2.0, 2.0]], 0.1));
    assert_eq!(a.report.elasticity, Err(NoStiffness::NoContacts { grains: 2 }));
    assert_eq!(
        (
            a.report.contacts.coordination,
            a.report.contacts.mechanical_coordination,
            a.report.contacts.rattlers
        ),
        (0.0, 0.0, 2)
    );
    assert_eq!((a.report.unbalanced_force_ratio, a.report.strain_ratios), (None, Default::default()));
    assert_finite(&a);
}

#[test]
fn a_packing_without_grains_has_no_network_and_no_nan() {
    let a = measured(&sites(4.0, &[], 0.1));
    assert_eq!(a.report.elasticity, Err(NoStiffness::NoContacts { grains: 0 }));
    assert_finite(&a);
}

/// In an open chain, grains become rattlers one by one from the ends.
#[test]
fn rattlers_are_removed_until_none_is_left() {
    let chain: Vec<[f64; 3]> = (0..5).map(|k| [k as f64, 0.5, 0.5]).collect();
    let a = measured(&sites(8.0, &chain, 0.1));
    assert_eq!(a.report.elasticity, Err(NoStiffness::OnlyRattlers { grains: 5, needed: 2 }));
    assert_eq!(
        (a.report.contacts.contacts, a.report.contacts.rattlers, a.report.contacts.mechanical_coordination),
        (4, 5, 0.0)
    );
    assert!((a.report.contacts.coordination - 1.6).abs() < 1e-15);
    assert_finite(&a);
}

/// A tetrahedron of touching grains that does not span the cell: each grain has three contacts, but any
/// strain relaxes.
#[test]
fn a_cluster_that_does_not_span_the_cell_is_no_network() {
    let h = 1.0 / 2f64.sqrt();
    let tetrahedron = [[0.0; 3], [0.0, h, h], [h, 0.0, h], [h, h, 0.0]];
    let a = measured(&sites(4.0, &tetrahedron, 0.1));
    assert_eq!(a.report.elasticity, Err(NoStiffness::Floppy { contacts: 6 }));
    assert_eq!(a.report.contacts.rattlers, 0);
    // Without friction three contacts do not support a grain.
    let a = measured(&sites(4.0, &tetrahedron, 0.0));
    assert_eq!(a.report.elasticity, Err(NoStiffness::OnlyRattlers { grains: 4, needed: 4 }));
}

/// One grain in a cell as long as its diameter touches its own image: a chain of infinite length, whose only
/// stiffness is along itself.
#[test]
fn a_chain_across_the_cell_is_stiff_along_itself_alone() {
    let cell = Cell::new(Mat3::from_diagonal(&(Vec3::new(3.0, 3.0, 1.0) * D))).unwrap();
    let p = packing(cell, vec![Vec3::zeros()], 0.5 * D * 1.0001, 0.1, None);
    let a = measured(&p);
    assert_eq!(
        (a.report.contacts.contacts, a.report.contacts.rattlers, a.report.contacts.mechanical_coordination),
        (1, 0, 2.0)
    );
    let c = a.report.stiffness().copied().unwrap().tensor.0;
    let (k_n, _) = p.contact_stiffness(&p.contacts[0]);
    assert!((c[(2, 2)] / (k_n * D * D / p.cell.volume()) - 1.0).abs() < 1e-12);
    let rest = (0..36).filter(|k| *k != 14).map(|k| c[(k / 6, k % 6)].abs()).fold(0.0, f64::max);
    assert!(rest < 1e-12 * c[(2, 2)], "{rest:e}");
    assert!(
        (a.report.fabric.contact_anisotropy - 2.5).abs() < 1e-9
            && (a.report.fabric.principal_axis.direction - Vec3::z()).norm() < 1e-9
    );
    assert!((a.report.fabric.p4_coefficient - 9.0).abs() < 1e-9);
}

#[test]
fn a_coincident_pair_and_a_reversed_normal_are_named() {
    let mut p = random(20, 1.2, 21);
    p.contacts[3].normal = -p.contacts[3].normal;
    let (i, j) = (p.contacts[3].i, p.contacts[3].j);
    match analyze(&p, &Settings::default()) {
        Err(MicroError::Normal { contact: 3, i: a, j: b, cosine }) => {
            assert!((a, b) == (i, j) && cosine < -0.999)
        }
        other => panic!("{other:?}"),
    }
    let mut p = random(20, 1.2, 21);
    let c = p.contacts[0];
    p.positions[c.j as usize] = p.positions[c.i as usize] - p.cell.shift(c.image);
    assert!(matches!(analyze(&p, &Settings::default()), Err(MicroError::Normal { .. })));
}

#[test]
fn settings_out_of_range_are_refused() {
    let p = random(40, 1.1, 22);
    for tolerance in [0.0, f64::NAN, 1.0] {
        let settings = Settings { tolerance: Some(tolerance), ..Settings::default() };
        assert!(matches!(analyze(&p, &settings), Err(MicroError::Setting { name: "tolerance", .. })));
    }
    for axis in [Vec3::zeros(), Vec3::new(f64::NAN, 0.0, 1.0)] {
        let settings = Settings { axis, ..Settings::default() };
        assert!(matches!(analyze(&p, &settings), Err(MicroError::Setting { name: "axis", .. })));
    }
}

/// Structure and stress do not depend on the stiffness, so that they are never lost with it.
#[test]
fn a_packing_whose_stiffness_is_not_found_keeps_its_structure_and_stress() {
    let p = random(40, 1.1, 22);
    let short = Settings { max_iterations: 5, ..Settings::default() };
    let (a, whole) = (analyze(&p, &short).unwrap(), measured(&p));
    assert_eq!(a.report.elasticity, Err(NoStiffness::Unsolved));
    assert!(
        matches!(a.unsolved, Some(MicroError::NotConverged { iterations: 5, residual, .. }) if residual > 1e-9),
        "{:?}",
        a.unsolved
    );
    assert!(a.why_no_stiffness().unwrap().contains("the moduli are unknown: stiffness solve reached"));
    assert_eq!((a.report.stress, a.report.contacts), (whole.report.stress, whole.report.contacts));
    assert_eq!(a.report.fabric, whole.report.fabric);
}

#[test]
fn a_packing_that_overlaps_beyond_every_contact_law_has_no_moduli() {
    for (overlap, is_solved) in [(0.099, true), (0.101, false)] {
        let a = measured(&lattice(overlap * DIAMETER));
        assert_eq!(a.report.elasticity.is_ok(), is_solved, "{overlap}");
        assert!(a.report.contacts.contacts == 3 && a.report.pressure() > 0.0);
        if !is_solved {
            assert_eq!(a.report.elasticity, Err(NoStiffness::TooDeep));
            assert!(a.report.symmetry.is_none() && a.why_no_stiffness().is_none());
        }
    }
}

#[test]
fn eps_and_the_ratios_follow_the_axis() {
    let mut p = random(60, 1.15, 23);
    p.deformation =
        Mat3::from_diagonal(&Vec3::new((-0.0136f64).exp(), (-0.0136f64).exp(), (-0.0194f64).exp()));
    let a = measured(&p);
    // Table II, S1: γ/Δ = −.0029/.0466.
    assert!((a.report.strain_ratios.total.unwrap() + 0.0029 / 0.0466).abs() < 1e-12);
    let r = Rotation3::from_euler_angles(0.5, 0.8, -0.3);
    let mut q = turned(&p, r.matrix());
    q.deformation = r.matrix() * p.deformation;
    let settings = Settings { axis: r * Vec3::z() * 3.0, ..Settings::default() };
    let b = analyze(&q, &settings).unwrap();
    let pairs = [
        (a.report.fabric.contact_anisotropy, b.report.fabric.contact_anisotropy),
        (a.report.fabric.p4_coefficient, b.report.fabric.p4_coefficient),
        (a.report.strain_ratios.total.unwrap(), b.report.strain_ratios.total.unwrap()),
        (a.report.strain_ratios.contact.unwrap(), b.report.strain_ratios.contact.unwrap()),
        (a.report.strain_ratios.elastic.unwrap(), b.report.strain_ratios.elastic.unwrap()),
    ];
    for (x, y) in pairs {
        assert!((x - y).abs() < 1e-10, "{x} {y}");
    }
    let (found, expected) =
        (b.report.fabric.principal_axis.direction, r * a.report.fabric.principal_axis.direction);
    assert!(found.cross(&expected).norm() < 1e-9 && found.z >= 0.0);
}

#[test]
fn the_unbalanced_ratio_counts_net_forces_of_non_rattlers() {
    // A closed chain of one grain: two equal and opposite forces.
    let cell = Cell::new(Mat3::from_diagonal(&(Vec3::new(3.0, 3.0, 2.0) * D))).unwrap();
    let mut p = packing(cell, vec![Vec3::zeros(), Vec3::z() * D], 0.5 * D * 1.0001, 0.1, None);
    assert_eq!(p.contacts.len(), 2);
    assert!(measured(&p).report.unbalanced_force_ratio.unwrap() < 1e-10);
    // Each grain is pushed with 1 + 2 N one way, 3 N net with forces in line; the mean contact force is 1.5 N.
    p.contacts[0].normal_force = 1.0;
    p.contacts[1].normal_force = 2.0;
    assert!((measured(&p).report.unbalanced_force_ratio.unwrap() - 1.0 / 1.5).abs() < 1e-12);
}
