//! The paths of a burst: every polarization of every ray.

use crate::curve::DispersionCurve;
use crate::error::{AcousticsError, setting};
use crate::ray::Ray;
use crate::trace::Trace;
use grainlab_core::notes::Note;
use grainlab_core::{Packing, Vec3};

/// One polarization along one ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WavePath {
    /// Unit direction of propagation.
    pub(crate) direction: Vec3,
    /// Unit polarization vector.
    pub(crate) polarization: Vec3,
    /// Lattice planes (h k l) normal to the direction.
    pub(crate) indices: [i32; 3],
    /// Indices of ray and polarization.
    pub(crate) place: [u64; 2],
}

#[derive(Clone, Debug)]
pub(crate) struct PathResult {
    pub(crate) curve: DispersionCurve,
    pub(crate) traces: Vec<Trace>,
    pub(crate) notes: Vec<Note>,
}

/// The path of each polarization of each ray. A ray must name lattice planes of the packing.
pub(crate) fn paths(packing: &Packing, rays: &[Ray]) -> Result<Vec<WavePath>, AcousticsError> {
    let mut paths = Vec::new();
    for (r, ray) in rays.iter().enumerate() {
        let indices = planes(packing, ray)?;
        for (p, polarization) in ray.polarizations.iter().enumerate() {
            let length = polarization.norm();
            setting("polarization", length, (length - 1.0).abs() <= 1e-6, "a unit vector")?;
            let place = [r as u64, p as u64];
            paths.push(WavePath { direction: ray.direction, polarization: *polarization, indices, place });
        }
    }
    Ok(paths)
}

fn planes(packing: &Packing, ray: &Ray) -> Result<[i32; 3], AcousticsError> {
    let across = |indices: &[i32; 3]| {
        let normal = Ray::normal(&packing.cell, *indices).unwrap_or_else(Vec3::zeros);
        (normal.dot(&ray.direction).abs() - 1.0).abs() < 1e-9
    };
    let no_plane = AcousticsError::NoLatticePlane { direction: ray.direction.into() };
    ray.indices.filter(across).ok_or(no_plane)
}
