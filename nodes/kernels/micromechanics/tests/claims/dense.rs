//! Comparison with a dense pseudo-inverse, assembled independently.

use crate::samples::{packing, random, solved, with_springs};
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_micromechanics::network::Springs;
use grainlab_micromechanics::{Settings, analyze};
use nalgebra::{DMatrix, Matrix6};

/// C = A − ΞᵀK⁺Ξ/V: B_c as a 3×6N matrix with cross-product matrices, K⁺ from all eigenvalues, rotations in
/// radians times the first radius.
pub(crate) fn dense_stiffness(p: &Packing, tangential: bool) -> Matrix6<f64> {
    let dof = 6 * p.grains();
    let length = p.radii[0];
    let (mut k, mut xi) = (DMatrix::zeros(dof, dof), DMatrix::zeros(dof, 6));
    let mut affine = Matrix6::zeros();
    for c in &p.contacts {
        let l = p.branch(c);
        let n = l.normalize();
        let (k_n, k_t) = p.contact_stiffness(c);
        let k_t = if tangential { k_t } else { 0.0 };
        let spring = n * n.transpose() * k_n + (Mat3::identity() - n * n.transpose()) * k_t;
        let mut b = DMatrix::zeros(3, dof);
        // −λ θ×n = +λ n×θ, with λ = R − δ/2 of each grain and the δ of the positions.
        let radii = [c.i, c.j].map(|grain| p.radii[grain as usize]);
        let overlap = radii[0] + radii[1] - l.norm();
        let [on_i, on_j] = radii.map(|radius| n.cross_matrix() * ((radius - 0.5 * overlap) / length));
        for r in 0..3 {
            for s in 0..3 {
                let one = if r == s { 1.0 } else { 0.0 };
                b[(r, 6 * c.j as usize + s)] += one;
                b[(r, 6 * c.i as usize + s)] -= one;
                b[(r, 6 * c.i as usize + 3 + s)] += on_i[(r, s)];
                b[(r, 6 * c.j as usize + 3 + s)] += on_j[(r, s)];
            }
        }
        let spring = DMatrix::from_fn(3, 3, |r, s| spring[(r, s)]);
        let strain = DMatrix::from_fn(3, 6, |r, a| (unit_strain(a) * l)[r]);
        k += b.transpose() * &spring * &b;
        xi += b.transpose() * &spring * &strain;
        let local = strain.transpose() * &spring * &strain;
        affine += Matrix6::from_fn(|r, s| local[(r, s)]);
    }
    let eigen = k.symmetric_eigen();
    let cut = 1e-11 * eigen.eigenvalues.amax();
    let projected = eigen.eigenvectors.transpose() * &xi;
    let mut relaxation = Matrix6::zeros();
    for (m, value) in eigen.eigenvalues.iter().enumerate() {
        if *value > cut {
            relaxation += Matrix6::from_fn(|a, b| projected[(m, a)] * projected[(m, b)] / value);
        }
    }
    (affine - relaxation) / p.cell.volume()
}

fn unit_strain(a: usize) -> Mat3 {
    let mut e = Mat3::zeros();
    let (i, j) = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)][a];
    e[(i, j)] += 0.5;
    e[(j, i)] += 0.5;
    e
}

/// Loose networks have rattlers, floppy grains and soft modes. The error of the dense solve is about 1e-16
/// times the condition number of K, hence 1e-9 of the affine stiffness.
#[test]
fn random_networks_agree_with_a_dense_pseudo_inverse() {
    let mut rattlers = 0;
    for (swell, seed) in [(1.12, 1), (1.14, 2), (1.16, 3), (1.3, 4)] {
        let p = random(40, swell, seed);
        let a = analyze(&p, &Settings::default()).unwrap();
        rattlers += a.report.contacts.rattlers;
        let dense = dense_stiffness(&p, true);
        let m = a.report.stiffness().copied().unwrap();
        let error = (m.tensor.0 - dense).amax() / m.bounds.affine.0.amax();
        assert!(error < 1e-9, "swell {swell}: {error:e}");
    }
    assert!(rattlers > 0, "no sample had a rattler");
}

#[test]
fn random_networks_without_tangential_springs_agree_with_a_dense_pseudo_inverse() {
    for (swell, seed) in [(1.25, 5), (1.35, 6)] {
        let p = random(40, swell, seed);
        let m = with_springs(&p, Springs::Normal);
        let error = (m.tensor.0 - dense_stiffness(&p, false)).amax() / m.bounds.affine.0.amax();
        assert!(error < 1e-9, "swell {swell}: {error:e}");
    }
}

/// Two grains in a cell so small that each touches the other and itself through several faces.
#[test]
fn two_grains_with_own_images_agree_with_a_dense_pseudo_inverse() {
    let d = 2.0e-4;
    let cell = Cell::new(Mat3::new(d, 0.1 * d, 0.0, 0.0, 0.98 * d, 0.2 * d, 0.0, 0.0, 1.5 * d)).unwrap();
    let positions = vec![Vec3::zeros(), Vec3::new(0.4, 0.6, 0.7) * d];
    let p = packing(cell, positions, 0.52 * d, 0.1, None);
    assert!(p.contacts.iter().any(|c| c.i == c.j) && p.contacts.iter().any(|c| c.i != c.j));
    let m = solved(&p, &Settings::default());
    let dense = dense_stiffness(&p, true);
    let error = (m.tensor.0 - dense).amax() / m.bounds.affine.0.amax();
    assert!(error < 1e-12, "{error:e}");
    assert!(
        (m.bounds.affine.0 - m.tensor.0).amax() > 1e-3 * m.bounds.affine.0.amax(),
        "nothing relaxed: the test shows nothing"
    );
}
