//! Invariances, and motions without energy.

use crate::samples::{random, turned};
use grainlab_core::Vec3;
use grainlab_micromechanics::network::{GrainDofs, SpringNetwork, Springs, relaxed_stiffness};
use grainlab_micromechanics::{PackingView, Settings, analyze};
use nalgebra::Rotation3;

#[test]
fn turning_the_packing_turns_the_stiffness() {
    let p = random(60, 1.12, 11);
    let r = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let settings = Settings::default();
    let (a, b) = (analyze(&p, &settings).unwrap(), analyze(&turned(&p, r.matrix()), &settings).unwrap());
    let (c, turned) = (a.report.stiffness().copied().unwrap(), b.report.stiffness().copied().unwrap());
    let error = (turned.tensor.0 - c.tensor.rotated(r.matrix()).0).amax() / c.tensor.0.amax();
    assert!(error < 1e-10, "relaxed: {error:e}");
    let error =
        (turned.bounds.affine.0 - c.bounds.affine.rotated(r.matrix()).0).amax() / c.bounds.affine.0.amax();
    assert!(error < 1e-13, "affine: {error:e}");
}

#[test]
fn periodic_copies_change_nothing() {
    let p = random(40, 1.12, 12);
    let settings = Settings::default();
    let one = analyze(&p, &settings).unwrap();
    for copies in [2, 3] {
        let many = analyze(&p.repeated(copies).unwrap(), &settings).unwrap();
        let (c, d) = (one.report.stiffness().unwrap(), many.report.stiffness().unwrap());
        let error = (c.tensor.0 - d.tensor.0).amax() / c.tensor.0.amax();
        assert!(error < 1e-8, "{copies} copies: {error:e}");
        let (one, many) = (&one.report, &many.report);
        assert_eq!(one.contacts.coordination, many.contacts.coordination);
        assert_eq!(one.contacts.mechanical_coordination, many.contacts.mechanical_coordination);
        assert!((one.pressure() / many.pressure() - 1.0).abs() < 1e-12);
    }
}

/// A cluster that touches no image is moved and turned as one body: no contact deforms.
#[test]
fn rigid_motion_costs_nothing() {
    let mut p = random(30, 1.2, 13);
    p.contacts.retain(|c| c.image == [0, 0, 0]);
    assert!(p.contacts.len() > 30);
    let network = SpringNetwork::new(&PackingView::new(&p).unwrap(), Springs::NormalAndTangential).unwrap();
    let (shift, spin) = (Vec3::new(1.0, -2.0, 0.5) * 1e-5, Vec3::new(0.3, 0.2, -0.4));
    let phi = spin * network.spin_scale();
    let moved = |with_spin: bool| {
        let phi = if with_spin { phi } else { -phi };
        let rows = |x: &Vec3| {
            let u = shift + spin.cross(x);
            [[u.x], [u.y], [u.z], [phi.x], [phi.y], [phi.z]]
        };
        p.positions.iter().map(rows).collect::<Vec<_>>()
    };
    let mut force = vec![[[0.0]; 6]; p.grains()];
    let [rigid] = network.apply(&moved(true), &mut force);
    let [rolling] = network.apply(&moved(false), &mut force);
    // Squares of rounding (1e-16) against squares of order one.
    assert!(rigid.abs() < 1e-28 * rolling, "{rigid:e} against {rolling:e}");
}

#[test]
fn operator_is_symmetric_and_reports_its_energy() {
    let p = random(30, 1.1, 14);
    let network = SpringNetwork::new(&PackingView::new(&p).unwrap(), Springs::NormalAndTangential).unwrap();
    let x: Vec<GrainDofs<2>> = (0..p.grains())
        .map(|g| std::array::from_fn(|r| std::array::from_fn(|l| ((g * 7 + r * 3 + l * 11) as f64).sin())))
        .collect();
    let mut y = vec![[[0.0; 2]; 6]; p.grains()];
    let energy = network.apply(&x, &mut y);
    let dot = |a: usize, b: usize| -> f64 {
        x.iter().zip(&y).map(|(x, y)| (0..6).map(|k| x[k][a] * y[k][b]).sum::<f64>()).sum()
    };
    assert!((dot(0, 1) - dot(1, 0)).abs() < 1e-13 * dot(0, 0));
    assert!((dot(0, 0) - energy[0]).abs() < 1e-13 * energy[0]);
    assert!((dot(1, 1) - energy[1]).abs() < 1e-13 * energy[1]);
}

#[test]
fn the_same_packing_gives_the_same_bits() {
    let p = random(60, 1.15, 15);
    let bits = || {
        let m = analyze(&p, &Settings::default()).unwrap().report.stiffness().copied().unwrap();
        m.tensor.row_major().map(f64::to_bits)
    };
    assert_eq!(bits(), bits());
}

/// A solve with a large tolerance still bounds the stiffness from above, with an error of second order in its
/// residual.
#[test]
fn error_of_the_stiffness_is_second_order_in_the_tolerance_and_from_above() {
    let p = random(60, 1.2, 16);
    let network = SpringNetwork::new(&PackingView::new(&p).unwrap(), Springs::NormalAndTangential).unwrap();
    let with = |tolerance| relaxed_stiffness(&network, tolerance, 20_000).unwrap().unwrap().relaxed.0;
    let exact = with(1e-12);
    let scale = exact.amax();
    for tolerance in [1e-3, 1e-5] {
        let difference = with(tolerance) - exact;
        assert!(difference.symmetric_eigenvalues().min() > -1e-12 * scale, "{tolerance:e}: below the truth");
        let error = difference.amax() / scale;
        assert!(error < 10.0 * tolerance * tolerance.sqrt(), "{tolerance:e}: {error:e}");
    }
}
