//! What does not change the stiffness.

use crate::samples::{network, random, solved, turned};
use grainlab_micromechanics::network::{Springs, relaxed_stiffness};
use grainlab_micromechanics::{Settings, analyze};
use nalgebra::Rotation3;

#[test]
fn turning_the_packing_turns_the_stiffness() {
    let p = random(60, 1.12, 11);
    let r = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let [c, turned] = [&p, &turned(&p, r.matrix())].map(|p| solved(p, &Settings::default()));
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

#[test]
fn the_same_packing_gives_the_same_bits() {
    let p = random(60, 1.15, 15);
    let bits = || solved(&p, &Settings::default()).tensor.row_major().map(f64::to_bits);
    assert_eq!(bits(), bits());
}

/// A solve with a large tolerance still bounds the stiffness from above, with an error of second order in its
/// residual.
#[test]
fn error_of_the_stiffness_is_second_order_in_the_tolerance_and_from_above() {
    let p = random(60, 1.2, 16);
    let network = network(&p, Springs::NormalAndTangential);
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
