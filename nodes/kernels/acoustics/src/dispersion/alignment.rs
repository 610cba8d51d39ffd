//! Polarizations of a ray aligned with those of the modes.

use grainlab_core::{Mat3, Vec3};
use nalgebra::SymmetricEigen;

/// How three polarizations of a ray are rotated to those of the modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alignment {
    /// The first two, in their plane.
    InPlane,
    /// All three.
    Free,
}

/// The polarizations, completed to three perpendicular ones.
pub(super) fn completed(polarizations: &[Vec3]) -> Vec<Vec3> {
    let mut all = polarizations.to_vec();
    while all.len() < 3 {
        let left = |e: &Vec3| e - all.iter().map(|p| *p * p.dot(e)).sum::<Vec3>();
        let next = (0..3).map(|k| left(&Vec3::ith(k, 1.0))).max_by(|a, b| a.norm().total_cmp(&b.norm()));
        all.push(next.unwrap_or_default().normalize());
    }
    all
}

/// Three polarizations rotated to those of the modes of `tensor`. One or two are returned unchanged.
pub(super) fn aligned(polarizations: &[Vec3], alignment: Alignment, tensor: &Mat3) -> Vec<Vec3> {
    let Ok(all) = <[Vec3; 3]>::try_from(polarizations) else { return polarizations.to_vec() };
    let frame = Mat3::from_columns(&all);
    let mut inside = frame.transpose() * tensor * frame;
    if alignment == Alignment::InPlane {
        for k in 0..2 {
            (inside[(k, 2)], inside[(2, k)]) = (0.0, 0.0);
        }
    }
    let modes = frame * SymmetricEigen::new(inside).eigenvectors;
    // Each polarization takes the nearest of the remaining modes.
    let mut left: Vec<Vec3> = modes.column_iter().map(|c| c.into_owned()).collect();
    let mut nearest_mode = |polarization: &Vec3| {
        let along = |k: &usize| left[*k].dot(polarization).abs();
        let most = (0..left.len()).max_by(|a, b| along(a).total_cmp(&along(b)));
        let mode = left.swap_remove(most.unwrap_or_default());
        if mode.dot(polarization) < 0.0 { -mode } else { mode }
    };
    polarizations.iter().map(&mut nearest_mode).collect()
}
