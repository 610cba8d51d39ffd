//! Coordination, rattlers, fabric, γ/Δ, balance, and packings without a network.

use crate::samples::{packing, random, turned};
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_micromechanics::{Analysis, MicroError, NoNetwork, Settings, analyse};
use nalgebra::Rotation3;

const D: f64 = 2.0e-4;

fn sites(edge: f64, sites: &[[f64; 3]], friction: f64) -> Packing {
    let positions = sites.iter().map(|s| Vec3::from(*s) * D).collect();
    packing(Cell::cube(edge * D).unwrap(), positions, 0.5 * D * (1.0 + 1e-4), friction, None)
}

fn measured(p: &Packing) -> Analysis {
    analyse(p, &Settings::default()).unwrap()
}

fn assert_finite(a: &Analysis) {
    let f = &a.fabric;
    let tensors = [f.contact_fabric, f.force_fabric, f.stiffness_fabric, a.stress.tensor];
    assert!(tensors.iter().all(|t| t.is_finite()));
    let s = &f.structure;
    let parts = [
        s.stress.normal,
        s.stress.tangential,
        s.strong.stress,
        s.weak.stress,
        s.strong.fabric,
        s.weak.fabric,
    ];
    assert!(parts.iter().chain([&s.tangential_fabric]).all(|t| t.is_finite()));
    let means =
        s.orientation.overlap.iter().chain(&s.orientation.sqrt_overlap).chain(&s.fourth_order.components);
    assert!(
        means
            .chain([&s.axis.eps, &s.strong.eps, &s.weak.eps, &s.fourth_order.magnitude])
            .all(|v| v.is_finite())
    );
    assert_eq!(s.orientation.contacts.iter().sum::<u32>(), f.contacts);
    if f.contacts == 0 {
        assert!(s.forces.is_none() && s.mobilisation.is_none() && s.stress_force_fabric.is_none());
        assert!(s.orientation.contact_fit.is_none() && s.axis.eps_stddev.is_none() && !s.axis.determined);
    }
    let numbers = [f.k, f.z, f.eps, f.fourth_order, f.mobilised, a.pressure, a.deviatoric, a.solid_fraction];
    assert!(numbers.iter().all(|v| v.is_finite()), "{numbers:?}");
    assert!((f.axis.norm() - 1.0).abs() < 1e-12);
}

#[test]
fn a_gas_has_no_network_and_no_nan() {
    let a = measured(&sites(4.0, &[[0.0; 3], [2.0, 2.0, 2.0]], 0.1));
    assert_eq!(a.moduli, Err(NoNetwork::NoContacts { grains: 2 }));
    assert_eq!((a.fabric.k, a.fabric.z, a.fabric.rattlers), (0.0, 0.0, 2));
    assert_eq!((a.unbalanced, a.fabric.anisotropy), (None, Default::default()));
    assert_finite(&a);
}

#[test]
fn a_packing_without_grains_has_no_network_and_no_nan() {
    let a = measured(&sites(4.0, &[], 0.1));
    assert_eq!(a.moduli, Err(NoNetwork::NoContacts { grains: 0 }));
    assert_finite(&a);
}

/// An open chain unravels from its ends.
#[test]
fn rattlers_are_removed_until_none_is_left() {
    let chain: Vec<[f64; 3]> = (0..5).map(|k| [k as f64, 0.5, 0.5]).collect();
    let a = measured(&sites(8.0, &chain, 0.1));
    assert_eq!(a.moduli, Err(NoNetwork::OnlyRattlers { grains: 5, needed: 2 }));
    assert_eq!((a.fabric.contacts, a.fabric.rattlers, a.fabric.z), (4, 5, 0.0));
    assert!((a.fabric.k - 1.6).abs() < 1e-15);
    assert_finite(&a);
}

/// A tetrahedron of touching grains floats in the cell: everybody has three contacts, yet any strain relaxes.
#[test]
fn a_cluster_that_does_not_span_the_cell_is_no_network() {
    let h = 1.0 / 2f64.sqrt();
    let tetrahedron = [[0.0; 3], [0.0, h, h], [h, 0.0, h], [h, h, 0.0]];
    let a = measured(&sites(4.0, &tetrahedron, 0.1));
    assert_eq!(a.moduli, Err(NoNetwork::Floppy { contacts: 6 }));
    assert_eq!(a.fabric.rattlers, 0);
    // Without friction three contacts do not hold a grain.
    let a = measured(&sites(4.0, &tetrahedron, 0.0));
    assert_eq!(a.moduli, Err(NoNetwork::OnlyRattlers { grains: 4, needed: 4 }));
}

/// One grain in a cell as long as its diameter touches its own image and holds itself: a chain of infinite length, whose
/// only stiffness is along itself.
#[test]
fn a_chain_across_the_cell_is_stiff_along_itself_alone() {
    let cell = Cell::new(Mat3::from_diagonal(&(Vec3::new(3.0, 3.0, 1.0) * D))).unwrap();
    let p = packing(cell, vec![Vec3::zeros()], 0.5 * D * 1.0001, 0.1, None);
    let a = measured(&p);
    assert_eq!((a.fabric.contacts, a.fabric.rattlers, a.fabric.z), (1, 0, 2.0));
    let c = a.moduli.unwrap().stiffness.0;
    let (k_n, _) = p.contact_stiffness(&p.contacts[0]);
    assert!((c[(2, 2)] / (k_n * D * D / p.cell.volume()) - 1.0).abs() < 1e-12);
    let rest = (0..36).filter(|k| *k != 14).map(|k| c[(k / 6, k % 6)].abs()).fold(0.0, f64::max);
    assert!(rest < 1e-12 * c[(2, 2)], "{rest:e}");
    assert!((a.fabric.eps - 2.5).abs() < 1e-9 && (a.fabric.axis - Vec3::z()).norm() < 1e-9);
    assert!((a.fabric.fourth_order - 9.0).abs() < 1e-9);
}

#[test]
fn a_coincident_pair_and_a_reversed_normal_are_named() {
    let mut p = random(20, 1.2, 21);
    p.contacts[3].normal = -p.contacts[3].normal;
    let (i, j) = (p.contacts[3].i, p.contacts[3].j);
    match analyse(&p, &Settings::default()) {
        Err(MicroError::Normal { contact: 3, i: a, j: b, cosine }) => {
            assert!((a, b) == (i, j) && cosine < -0.999)
        }
        other => panic!("{other:?}"),
    }
    let mut p = random(20, 1.2, 21);
    let c = p.contacts[0];
    p.positions[c.j as usize] = p.positions[c.i as usize] - p.cell.shift(c.image);
    assert!(matches!(analyse(&p, &Settings::default()), Err(MicroError::Normal { .. })));
}

#[test]
fn settings_out_of_range_are_refused_and_an_exhausted_solve_is_an_error() {
    let p = random(40, 1.1, 22);
    for tolerance in [0.0, f64::NAN, 1.0] {
        let settings = Settings { tolerance, ..Settings::default() };
        assert!(matches!(analyse(&p, &settings), Err(MicroError::Setting { name: "tolerance", .. })));
    }
    for axis in [Vec3::zeros(), Vec3::new(f64::NAN, 0.0, 1.0)] {
        let settings = Settings { axis, ..Settings::default() };
        assert!(matches!(analyse(&p, &settings), Err(MicroError::Setting { name: "axis", .. })));
    }
    let settings = Settings { max_iterations: 5, ..Settings::default() };
    match analyse(&p, &settings) {
        Err(MicroError::NotConverged { iterations: 5, residual, .. }) => assert!(residual > 1e-9),
        other => panic!("{other:?}"),
    }
}

#[test]
fn eps_and_the_ratios_follow_the_axis() {
    let mut p = random(60, 1.15, 23);
    p.deformation =
        Mat3::from_diagonal(&Vec3::new((-0.0136f64).exp(), (-0.0136f64).exp(), (-0.0194f64).exp()));
    let a = measured(&p);
    // Table II, S1: γ/Δ = −.0029/.0466.
    assert!((a.fabric.anisotropy.total.unwrap() + 0.0029 / 0.0466).abs() < 1e-12);
    let r = Rotation3::from_euler_angles(0.5, 0.8, -0.3);
    let mut q = turned(&p, r.matrix());
    q.deformation = r.matrix() * p.deformation;
    let settings = Settings { axis: r * Vec3::z() * 3.0, ..Settings::default() };
    let b = analyse(&q, &settings).unwrap();
    let pairs = [
        (a.fabric.eps, b.fabric.eps),
        (a.fabric.fourth_order, b.fabric.fourth_order),
        (a.fabric.anisotropy.total.unwrap(), b.fabric.anisotropy.total.unwrap()),
        (a.fabric.anisotropy.contact.unwrap(), b.fabric.anisotropy.contact.unwrap()),
        (a.fabric.anisotropy.elastic.unwrap(), b.fabric.anisotropy.elastic.unwrap()),
    ];
    for (x, y) in pairs {
        assert!((x - y).abs() < 1e-10, "{x} {y}");
    }
    let (found, expected) = (b.fabric.axis, r * a.fabric.axis);
    assert!(found.cross(&expected).norm() < 1e-9 && found.z >= 0.0);
}

#[test]
fn fitted_g_returns_the_law_that_wrote_the_overlaps() {
    let mut p = random(60, 1.15, 24);
    for g in [-0.07, 0.0, 0.02] {
        for c in &mut p.contacts {
            let x = c.normal.z;
            c.overlap = (1e-4 * (1.0 + g - 3.0 * g * x * x)).powi(2);
        }
        let found = grainlab_micromechanics::anisotropy::contact(&p, &Vec3::z()).unwrap();
        assert!((found - g).abs() < 1e-13, "{found} {g}");
    }
}

#[test]
fn the_unbalanced_ratio_counts_net_forces_of_those_who_carry() {
    // A closed chain of one grain: two equal and opposite forces.
    let cell = Cell::new(Mat3::from_diagonal(&(Vec3::new(3.0, 3.0, 2.0) * D))).unwrap();
    let mut p = packing(cell, vec![Vec3::zeros(), Vec3::z() * D], 0.5 * D * 1.0001, 0.1, None);
    assert_eq!(p.contacts.len(), 2);
    assert!(measured(&p).unbalanced.unwrap() < 1e-10);
    // Each grain is pushed with 1 + 2 N one way, 3 N net with forces in line; the mean contact force is 1.5 N.
    p.contacts[0].normal_force = 1.0;
    p.contacts[1].normal_force = 2.0;
    assert!((measured(&p).unbalanced.unwrap() - 1.0 / 1.5).abs() < 1e-12);
}
