//! Closed-form stiffnesses compared with the relaxed one: a mean spin, the Reuss bound; and the prestress
//! term.

use crate::golden::reference;
use crate::samples::{network, packing, random, solved};
use grainlab_core::Contact;
use grainlab_core::contact::RollingResistance;
use grainlab_core::results::StiffnessMethod;
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_micromechanics::network::{Springs, relaxed_stiffness, uniform_rotation_stiffness};
use grainlab_micromechanics::{MicroError, Settings};
use grainlab_testkit::Random;
use grainlab_testkit::packings::FACE_CENTRED;

const D: f64 = 2.0e-4;

/// One grain in a cell of three different edges, so that the springs along x and z differ.
fn orthorhombic() -> Packing {
    let edges = Vec3::new(1.0 - 1e-4, 1.0 - 3e-4, 1.0 - 9e-4) * D;
    packing(Cell::new(Mat3::from_diagonal(&edges)).unwrap(), vec![Vec3::zeros()], 0.5 * D, 0.3, None)
}

/// In shear xz the springs a = k_t,x l_x² and b = k_t,z l_z² share the rotation: C55 = a b/((a + b) V), and
/// (a + b)/(4 V) without spin.
#[test]
fn a_mean_spin_is_exact_where_two_directions_differ() {
    let p = orthorhombic();
    let m = solved(&p, &Settings::default());
    let weight = |k: usize| {
        let c = p.contacts.iter().find(|c| c.normal[k].abs() > 0.5).unwrap();
        p.contact_stiffness(c).1 * p.branch(c).norm_squared()
    };
    let (a, b, v) = (weight(0), weight(2), p.cell.volume());
    let expected = a * b / ((a + b) * v);
    assert!((m.bounds.uniform_rotation.0[(4, 4)] / expected - 1.0).abs() < 1e-12);
    assert!((m.bounds.affine.0[(4, 4)] / ((a + b) / (4.0 * v)) - 1.0).abs() < 1e-12);
    // A single grain can only relax its spin.
    assert!((m.bounds.uniform_rotation.0 - m.tensor.0).amax() < 1e-12 * m.bounds.affine.0.amax());
    assert!(
        m.bounds.uniform_rotation.0[(4, 4)] < 0.95 * m.bounds.affine.0[(4, 4)],
        "nothing spins: the test shows nothing"
    );
}

#[test]
fn a_mean_spin_lies_between_relaxed_and_affine_and_is_affine_without_tangential_springs() {
    for seed in 41..45 {
        let p = random(50, 1.2, seed);
        let m = solved(&p, &Settings::default());
        for (above, below) in
            [(&m.bounds.affine, &m.bounds.uniform_rotation), (&m.bounds.uniform_rotation, &m.tensor)]
        {
            assert!((above.0 - below.0).symmetric_eigenvalues().min() > -1e-12 * m.bounds.affine.0.amax());
        }
        assert!((m.bounds.affine.0 - m.bounds.uniform_rotation.0).amax() > 1e-6 * m.bounds.affine.0.amax());
        let smooth = network(&p, Springs::Normal);
        let affine = smooth.affine_stiffness();
        assert_eq!(uniform_rotation_stiffness(&smooth, &affine), affine);
    }
}

/// Simple cubic under pressure: both give B = k_n/(3 D).
#[test]
fn the_reuss_bound_is_the_bulk_modulus_of_a_lattice_and_below_it_in_a_packing() {
    let edge = D * (1.0 - 2e-4);
    let p = packing(Cell::cube(edge).unwrap(), vec![Vec3::zeros()], 0.5 * D, 0.3, None);
    let m = solved(&p, &Settings::default());
    let expected = p.contact_stiffness(&p.contacts[0]).0 / (3.0 * edge);
    assert!((m.bounds.bulk_reuss.unwrap() / expected - 1.0).abs() < 1e-12);
    assert!((m.tensor.bulk_reuss().unwrap() / expected - 1.0).abs() < 1e-12);

    let m = solved(&reference(), &Settings::default());
    let share = m.bounds.bulk_reuss.unwrap() / m.tensor.bulk_reuss().unwrap();
    // .879 from Z̃(5/3) of such packings and their ratio of relaxed to affine modulus.
    assert!((0.8..1.0).contains(&share), "{share}");

    let rolling = RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 };
    let resists = Packing { law: p.law.with_rolling(rolling), ..p };
    assert_eq!(solved(&resists, &Settings::default()).bounds.bulk_reuss, None, "its springs are left out");
}

/// Face-centred cubic without tangential springs: prestress acts as springs of −F/D across the contacts, so that the energy has
/// C11 = √2 (k_n − F/D)/D, C12 = (k_n + F/D)/(√2 D) and C44 = (k_n − F/D)/(√2 D), V = D³/√2; under the pressure p = 2√2 F/D² the
/// stress has C12 + p and C44 − p/2. Then (C11 + 2 C12)/3 = −V dp/dV.
#[test]
fn prestress_is_a_negative_tangential_spring_of_a_smooth_lattice() {
    let d = D * (1.0 - 2e-2);
    let edge = d * 2f64.sqrt();
    let positions = FACE_CENTRED.map(|s| Vec3::from(s) * edge).to_vec();
    let p = packing(Cell::cube(edge).unwrap(), positions, 0.5 * D, 0.0, None);
    assert_eq!(p.contacts.len(), 24);
    let (k, f) = (p.contact_stiffness(&p.contacts[0]).0, p.contacts[0].normal_force / d);
    let settings = Settings { springs: Springs::PrestressedNormal, ..Settings::default() };
    let m = solved(&p, &settings);
    assert_eq!(m.method, StiffnessMethod::PrestressedNetwork);
    let (c, root) = (m.tensor.0, 2f64.sqrt());
    for (entry, expected) in [
        (c[(0, 0)], root * (k - f) / d),
        (c[(0, 1)], (k + 5.0 * f) / (root * d)),
        (c[(3, 3)], (k - 3.0 * f) / (root * d)),
        (c[(0, 3)], 0.0),
    ] {
        assert!((entry - expected).abs() < 1e-10 * c[(0, 0)], "{entry:e} for {expected:e}");
    }
    assert!(f > 5e-3 * k, "no prestress to speak of: the test shows nothing");
}

/// Simple cubic without tangential springs: C44 = −F/(2 D²), and no motion of grains is unstable.
#[test]
fn a_lattice_that_only_its_cell_keeps_from_shearing_is_an_error_by_name() {
    let edge = D * (1.0 - 1e-2);
    let p = packing(Cell::cube(edge).unwrap(), vec![Vec3::zeros()], 0.5 * D, 0.0, None);
    let expected = -p.contacts[0].normal_force / (2.0 * edge.powi(2));
    match relaxed_stiffness(&network(&p, Springs::PrestressedNormal), 1e-9, 100) {
        Err(MicroError::HeldOnly { eigenvalue }) => assert!((eigenvalue / expected - 1.0).abs() < 1e-12),
        other => panic!("{other:?}"),
    }
}

/// Loose networks under compression: the solve with prestress against the operator, column by column.
#[test]
fn a_prestressed_network_balances_its_loads() {
    for seed in 48..51 {
        let p = random(50, 1.35, seed);
        let network = network(&p, Springs::PrestressedNormal);
        let (loads, norms) = network.affine_loads();
        match grainlab_micromechanics::network::solve(&network, &loads, &norms, 1e-10, 20_000) {
            Ok(solution) => {
                let mut forces = vec![[[0.0; 6]; 6]; p.grains()];
                network.apply(&solution.motion, &mut forces);
                for l in 0..6 {
                    let left =
                        forces.iter().zip(&loads).flat_map(|(f, b)| (0..6).map(move |k| f[k][l] - b[k][l]));
                    assert!(left.map(|r| r * r).sum::<f64>().sqrt() <= 1e-10 * norms[l]);
                }
            }
            Err(error) => assert!(matches!(error, MicroError::Unstable { .. }), "{error}"),
        }
    }
}

/// Expected: a zigzag chain of smooth spheres under compression buckles; the result is an error, not a
/// number.
#[test]
fn a_chain_that_buckles_is_an_error_by_name() {
    let mut dice = Random::new(47);
    let (grains, edge) = (8, 0.98 * D);
    let cell = Cell::new(Mat3::from_diagonal(&Vec3::new(edge * grains as f64, 5.0 * D, 5.0 * D))).unwrap();
    let place = |g: usize, dice: &mut Random| {
        Vec3::new(edge * g as f64, 1e-2 * D * dice.unit(), 1e-2 * D * dice.unit())
    };
    let positions = (0..grains).map(|g| place(g, &mut dice)).collect();
    // With friction a grain with two contacts is not a rattler, and prestress keeps it.
    let p = packing(cell, positions, 0.5 * D, 0.1, None);
    assert!(p.contacts.len() == grains && p.contacts.iter().all(|c: &Contact| c.normal_force > 0.0));
    let refused = relaxed_stiffness(&network(&p, Springs::PrestressedNormal), 1e-9, 20_000);
    assert!(matches!(refused, Err(MicroError::Unstable { .. })), "{refused:?}");
    // Without prestress, straightening the chain costs no energy.
    let network = network(&p, Springs::Normal);
    assert_eq!(network.contacts(), grains);
    assert_eq!(relaxed_stiffness(&network, 1e-9, 20_000), Ok(None));
}
