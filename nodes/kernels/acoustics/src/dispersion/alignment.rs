//! Polarizations of a ray aligned with those of the modes.

use grainlab_core::{Mat3, Vec3};
use nalgebra::SymmetricEigen;

/// Rotation of three polarizations of a ray to those of the modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Alignment {
    /// The first two, in their plane.
    InPlane,
    /// All three polarizations.
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
    nearest_of(&all, modes.column_iter().map(|c| c.into_owned()).collect())
}

/// For each polarization the nearest of the `modes` that no one before it has taken, with its sign.
pub(super) fn nearest_of(polarizations: &[Vec3], mut modes: Vec<Vec3>) -> Vec<Vec3> {
    let mut nearest = |polarization: &Vec3| {
        let along = |k: &usize| modes[*k].dot(polarization).abs();
        let most = (0..modes.len()).max_by(|a, b| along(a).total_cmp(&along(b)))?;
        let mode = modes.swap_remove(most);
        Some(if mode.dot(polarization) < 0.0 { -mode } else { mode })
    };
    polarizations.iter().filter_map(&mut nearest).collect()
}
