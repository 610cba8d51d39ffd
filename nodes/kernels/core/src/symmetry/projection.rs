//! The stiffness of a class that is nearest to a symmetric matrix in Mandel form (order xx, yy, zz, yz, xz, xy, shears
//! times √2), for axes along the frame's. All four are orthogonal projections.

use nalgebra::Matrix6;

/// Two constants: the dilatation, and the mean over the five deviators.
pub(super) fn isotropic(c: &Matrix6<f64>) -> Matrix6<f64> {
    let bulk = c.fixed_view::<3, 3>(0, 0).sum() / 3.0;
    let shear = (c.trace() - bulk) / 5.0;
    Matrix6::from_fn(|i, j| {
        let dilatation = if i < 3 && j < 3 { (bulk - shear) / 3.0 } else { 0.0 };
        if i == j { shear + dilatation } else { dilatation }
    })
}

/// Three constants, axes along the cube's edges.
pub(super) fn cubic(c: &Matrix6<f64>) -> Matrix6<f64> {
    let normal = c.fixed_view::<3, 3>(0, 0);
    let c11 = normal.trace() / 3.0;
    let c12 = (normal.sum() - normal.trace()) / 6.0;
    let c44 = (c[(3, 3)] + c[(4, 4)] + c[(5, 5)]) / 3.0;
    Matrix6::from_fn(|i, j| match (i == j, i < 3, j < 3) {
        (true, true, _) => c11,
        (true, false, _) => c44,
        (false, true, true) => c12,
        _ => 0.0,
    })
}

/// Five constants, axis z.
pub(super) fn transversely_isotropic(c: &Matrix6<f64>) -> Matrix6<f64> {
    let plane = (c[(0, 0)] + c[(1, 1)] + 2.0 * c[(0, 1)]) / 2.0;
    // The mean of the two shears in the plane: (xx − yy)/√2, and xy.
    let shear = ((c[(0, 0)] + c[(1, 1)]) / 2.0 - c[(0, 1)] + c[(5, 5)]) / 2.0;
    let cross = (c[(0, 2)] + c[(1, 2)]) / 2.0;
    let along = (c[(3, 3)] + c[(4, 4)]) / 2.0;
    let mut p = Matrix6::zeros();
    for i in 0..2 {
        p[(i, i)] = (plane + shear) / 2.0;
        p[(i, 1 - i)] = (plane - shear) / 2.0;
        p[(i, 2)] = cross;
        p[(2, i)] = cross;
        p[(3 + i, 3 + i)] = along;
    }
    p[(2, 2)] = c[(2, 2)];
    p[(5, 5)] = shear;
    p
}

/// Nine constants, axes along the frame's.
pub(super) fn orthotropic(c: &Matrix6<f64>) -> Matrix6<f64> {
    Matrix6::from_fn(|i, j| if i == j || (i < 3 && j < 3) { c[(i, j)] } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A projection changes nothing the second time, and what it discards is perpendicular to what it keeps.
    #[test]
    fn projections_are_orthogonal_and_nested() {
        let a = Matrix6::from_fn(|i, j| ((3 * i + 7 * j + i * j) as f64).sin());
        let c = a + a.transpose();
        let all = [isotropic, cubic, transversely_isotropic, orthotropic];
        for p in all {
            let kept = p(&c);
            assert!((p(&kept) - kept).amax() < 1e-14);
            assert!((c - kept).dot(&kept).abs() < 1e-13);
        }
        for p in &all[1..] {
            assert!((p(&isotropic(&c)) - isotropic(&c)).amax() < 1e-14, "isotropic is in every class");
        }
        for p in &all[..3] {
            assert!((orthotropic(&p(&c)) - p(&c)).amax() < 1e-14, "every class is orthotropic");
        }
    }
}
