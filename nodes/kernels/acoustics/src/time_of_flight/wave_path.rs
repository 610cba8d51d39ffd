//! Measurements with moving grains, for every polarization of every ray.

use crate::curve::DispersionCurve;
use crate::error::AcousticsError;
use crate::ray::Ray;
use crate::sample::Sample;
use crate::trace::Trace;
use crate::warning::Warning;
use grainlab_core::{Packing, Vec3};
use rayon::prelude::*;

/// One polarization along one ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WavePath {
    /// Unit direction of propagation.
    pub(crate) direction: Vec3,
    /// Unit polarization.
    pub(crate) polarization: Vec3,
    /// Lattice planes (h k l) normal to the direction.
    pub(crate) indices: [i32; 3],
    /// Indices of ray and polarization.
    pub(crate) place: [u64; 2],
}

/// What was measured on one path.
#[derive(Clone, Debug)]
pub(crate) struct PathResult {
    pub(crate) curve: DispersionCurve,
    pub(crate) traces: Vec<Trace>,
    pub(crate) warnings: Vec<Warning>,
}

impl WavePath {
    /// The error that there is no `what` on this path.
    pub(crate) fn no_signal(&self, what: &'static str, reason: &str) -> AcousticsError {
        AcousticsError::NoSignal {
            what,
            direction: self.direction.into(),
            polarization: self.polarization.into(),
            reason: reason.to_owned(),
        }
    }
}

/// The path of each polarization of each ray. A ray must name lattice planes of the packing.
pub(crate) fn paths(packing: &Packing, rays: &[Ray]) -> Result<Vec<WavePath>, AcousticsError> {
    let mut paths = Vec::new();
    for (r, ray) in rays.iter().enumerate() {
        let indices = planes(packing, ray)?;
        for (p, polarization) in ray.polarizations.iter().enumerate() {
            let length = polarization.norm();
            if length.is_nan() || (length - 1.0).abs() > 1e-6 {
                let requirement = "a unit vector";
                return Err(AcousticsError::Setting { name: "polarization", value: length, requirement });
            }
            let place = [r as u64, p as u64];
            paths.push(WavePath { direction: ray.direction, polarization: *polarization, indices, place });
        }
    }
    Ok(paths)
}

/// Measures every path in parallel; the results are in the order of the paths and the same for any number of threads.
///
/// A path without a signal is left out with a [`Warning::LeftOut`]; if all are, the first such error is returned.
#[allow(clippy::type_complexity)]
pub(crate) fn measure_all(
    paths: &[WavePath],
    sample: &Sample,
    measure: impl Fn(&WavePath) -> Result<PathResult, AcousticsError> + Send + Sync,
) -> Result<(Vec<DispersionCurve>, Vec<Trace>, Vec<Warning>), AcousticsError> {
    let results: Vec<_> = paths.par_iter().map(measure).collect();
    let (mut curves, mut traces) = (Vec::new(), Vec::new());
    let mut warnings: Vec<Warning> =
        sample.unbalanced.map(|unbalanced| Warning::NotAtRest { unbalanced }).into_iter().collect();
    let mut first_error = None;
    for result in results {
        match result {
            Ok(mut result) => {
                curves.push(result.curve);
                traces.append(&mut result.traces);
                warnings.append(&mut result.warnings);
            }
            Err(error @ AcousticsError::NoSignal { .. }) => {
                first_error = first_error.or_else(|| Some(error.clone()));
                warnings.push(Warning::LeftOut(error));
            }
            Err(error) => return Err(error),
        }
    }
    match first_error {
        Some(error) if curves.is_empty() => Err(error),
        _ => Ok((curves, traces, warnings)),
    }
}

/// The lattice planes normal to a ray.
fn planes(packing: &Packing, ray: &Ray) -> Result<[i32; 3], AcousticsError> {
    let across = |indices: &[i32; 3]| {
        let normal = Ray::normal(&packing.cell, *indices).unwrap_or_else(Vec3::zeros);
        (normal.dot(&ray.direction).abs() - 1.0).abs() < 1e-9
    };
    let no_plane = AcousticsError::NoLatticePlane { direction: ray.direction.into() };
    ray.indices.filter(across).ok_or(no_plane)
}
