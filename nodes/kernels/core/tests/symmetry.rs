//! Symmetry of a stiffness, found without being told the axes.

use grainlab_core::{Mat3, Stiffness, TransverseIsotropy, Vec3};
use grainlab_core::{Symmetry, SymmetryClass, symmetry};
use grainlab_testkit::Random;
use grainlab_testkit::packings::cubic;
use nalgebra::Matrix6;

fn rotation(dice: &mut Random) -> Mat3 {
    *dice.rotation().matrix()
}

/// Symmetric, normal entries of unit variance in the Mandel norm, as a Voigt matrix.
fn noise(dice: &mut Random) -> Matrix6<f64> {
    let a = Matrix6::from_fn(|_, _| dice.normal());
    let mandel = (a + a.transpose()) * 0.5;
    let w = |i: usize| if i < 3 { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 };
    Matrix6::from_fn(|i, j| mandel[(i, j)] * w(i) * w(j))
}

fn axial(dice: &mut Random) -> TransverseIsotropy {
    TransverseIsotropy {
        c11: 300.0 + 60.0 * dice.unit(),
        c12: 60.0 + 60.0 * dice.unit(),
        c13: 60.0 + 60.0 * dice.unit(),
        c33: 300.0 + 120.0 * dice.unit(),
        g13: 90.0 + 90.0 * dice.unit(),
        g12: 0.0,
        residual: 0.0,
    }
}

fn found(c: &Stiffness, tolerance: f64) -> Symmetry {
    symmetry(c, tolerance).unwrap()
}

#[test]
fn a_transversely_isotropic_stiffness_of_any_axis_gives_back_its_moduli_and_its_axis() {
    let mut dice = Random::new(1);
    for _ in 0..200 {
        let mut moduli = axial(&mut dice);
        moduli.g12 = (moduli.c11 - moduli.c12) / 2.0;
        let r = rotation(&mut dice);
        let s = found(&moduli.stiffness().rotated(&r), 1e-9);
        assert_eq!(s.class, SymmetryClass::TransverselyIsotropic, "{s:?}");
        assert!(s.transversely_isotropic < 1e-12, "{:e}", s.transversely_isotropic);
        let expected = r * Vec3::z();
        assert!(s.axis.cross(&expected).norm() < 1e-10 && s.axis.z >= 0.0);
        let (a, b) = (s.moduli, moduli);
        for (x, y) in
            [(a.c11, b.c11), (a.c12, b.c12), (a.c13, b.c13), (a.c33, b.c33), (a.g12, b.g12), (a.g13, b.g13)]
        {
            assert!((x - y).abs() < 1e-8, "{x} {y}");
        }
    }
}

#[test]
fn an_isotropic_stiffness_has_no_axis_to_lose_itself_over() {
    let c = cubic(360.0, 80.0, 140.0);
    let s = found(&c.rotated(&rotation(&mut Random::new(2))), 1e-12);
    assert_eq!(s.class, SymmetryClass::Isotropic);
    assert!(s.isotropic < 1e-14 && s.cubic < 1e-14 && s.transversely_isotropic < 1e-14);
    assert!((s.axis.norm() - 1.0).abs() < 1e-12);
}

#[test]
fn a_cubic_stiffness_is_cubic_whichever_way_it_is_turned() {
    let mut dice = Random::new(3);
    for k in 0..100 {
        // Stiff along the edges, or along the diagonals.
        let (c11, c44) = if k % 2 == 0 { (400.0, 100.0) } else { (250.0, 150.0) };
        let r = rotation(&mut dice);
        let s = found(&cubic(c11, 80.0, c44).rotated(&r), 1e-9);
        assert_eq!(s.class, SymmetryClass::Cubic, "{k}: {s:?}");
        assert!(s.cubic < 1e-12 && s.transversely_isotropic > 0.01 && s.orthotropic < 1e-9);
        // Each axis found is one of the cube's, either way round.
        let overlap = r.transpose() * s.cubic_axes;
        assert!(overlap.iter().all(|c| c.abs() < 1e-8 || (c.abs() - 1.0).abs() < 1e-12), "{overlap}");
    }
}

#[test]
fn nine_constants_are_orthotropic_and_one_more_is_lower() {
    let mut dice = Random::new(4);
    for _ in 0..100 {
        let mut c = cubic(350.0, 80.0, 130.0);
        for i in 0..6 {
            c.0[(i, i)] *= 0.8 + 0.4 * dice.unit();
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            c.0[(i, j)] *= 0.6 + 0.8 * dice.unit();
            c.0[(j, i)] = c.0[(i, j)];
        }
        let s = found(&c.rotated(&rotation(&mut dice)), 1e-9);
        assert_eq!(s.class, SymmetryClass::Orthotropic, "{s:?}");
        assert!(s.orthotropic < 1e-10 && s.isotropic >= s.cubic && s.cubic >= s.orthotropic);
        let mut d = c;
        d.0[(0, 3)] += 40.0;
        d.0[(3, 0)] += 40.0;
        d.0[(1, 4)] -= 30.0;
        d.0[(4, 1)] -= 30.0;
        assert_eq!(found(&d, 1e-9).class, SymmetryClass::Lower);
    }
}

/// The minimum is the minimum: no frame of many does better, for stiffnesses of no symmetry at all.
#[test]
fn no_other_axis_is_nearer_for_a_stiffness_without_symmetry() {
    let mut dice = Random::new(5);
    for _ in 0..30 {
        let c = Stiffness(cubic(350.0, 90.0, 130.0).0 + noise(&mut dice) * 30.0);
        let s = found(&c, 1e-3);
        let mut best = f64::INFINITY;
        for _ in 0..1000 {
            let axis = Vec3::from_fn(|_, _| dice.normal()).normalize();
            best = best.min(c.transverse_isotropy_about(&axis).residual);
        }
        assert!(s.transversely_isotropic <= best, "{} {best}", s.transversely_isotropic);
        assert!((s.moduli.residual - s.transversely_isotropic).abs() < 1e-9);
    }
}

/// Every residual is a property of the medium, not of the frame it is written in.
#[test]
fn residuals_do_not_depend_on_the_frame() {
    let mut dice = Random::new(6);
    for k in 0..60 {
        let c =
            Stiffness(cubic(350.0, 90.0, 130.0).0 + noise(&mut dice) * if k % 2 == 0 { 3.0 } else { 30.0 });
        let (a, b) = (found(&c, 0.02), found(&c.rotated(&rotation(&mut dice)), 0.02));
        let pairs = [
            (a.isotropic, b.isotropic),
            (a.cubic, b.cubic),
            (a.transversely_isotropic, b.transversely_isotropic),
            (a.orthotropic, b.orthotropic),
        ];
        for (x, y) in pairs {
            assert!((x - y).abs() < 1e-7, "{k}: {pairs:?}");
        }
        assert_eq!(a.class, b.class);
    }
}

/// Noise below the tolerance changes no class; noise above it lowers the class.
#[test]
fn the_tolerance_decides_what_is_noise() {
    let mut dice = Random::new(7);
    let mut moduli = axial(&mut dice);
    (moduli.c33, moduli.g13, moduli.g12) = (450.0, 180.0, (moduli.c11 - moduli.c12) / 2.0);
    let exact = moduli.stiffness();
    let norm = exact.mandel().norm();
    for _ in 0..20 {
        let noise = noise(&mut dice);
        let share = Stiffness(noise).mandel().norm() / norm;
        let noisy = Stiffness(exact.0 + noise * (0.01 / share));
        let s = found(&noisy, 0.01);
        assert_eq!(s.class, SymmetryClass::TransverselyIsotropic, "{s:?}");
        assert!(s.transversely_isotropic < 0.01);
        assert_eq!(found(&noisy, 1e-4).class, SymmetryClass::Lower);
        assert_eq!(found(&noisy, 0.5).class, SymmetryClass::Isotropic);
    }
}

#[test]
fn nothing_has_no_symmetry() {
    assert!(symmetry(&Stiffness(Matrix6::zeros()), 0.01).is_none());
    assert!(symmetry(&Stiffness(Matrix6::from_element(f64::NAN)), 0.01).is_none());
}
