//! From packings to the constants of the models of effective medium theory.
//!
//! - `sample`: a packing to learn from
//! - `requirements`: properties that packings need
//! - `isotropic`: Eqs. 21 and 22
//! - `relaxation`: the laws of relaxed networks, and the scatter of packings about them
//! - `discrepancy`: the errors of the models on the packings
//! - `regression`, `student`: least squares, and the distribution of a mean of few

mod discrepancy;
mod isotropic;
mod regression;
mod relaxation;
mod requirements;
mod sample;
mod student;

pub use discrepancy::discrepancies;
pub use relaxation::network;
pub use requirements::{check, packings};
pub use sample::CalibrationSample;

use grainlab_core::Material;
use grainlab_emt::{Calibration, CalibrationError};
use isotropic::of_isotropic;
use sample::bounds;

/// Constants from isotropic and from anisotropic packings, all of one material, and from others of any material, stress
/// and sizes, which only the laws of the model `relaxed` use. Without anisotropic ones only Eqs. 21 and 22 are fitted.
pub fn learn(
    name: &str,
    isotropic: &[CalibrationSample],
    anisotropic: &[CalibrationSample],
    others: &[CalibrationSample],
) -> Result<Calibration, CalibrationError> {
    let own: Vec<&CalibrationSample> = isotropic.iter().chain(anisotropic).collect();
    let material = material(&own)?;
    others.iter().try_for_each(CalibrationSample::check)?;
    let (low, high) = bounds(own.iter().map(|s| s.pressure));
    let mut calibration = Calibration::of_isotropic(name.to_owned(), of_isotropic(isotropic)?, material);
    calibration.pressures = Some([low, high]);
    if !anisotropic.is_empty() {
        let all: Vec<&CalibrationSample> = own.into_iter().chain(others).collect();
        calibration.network = Some(Box::new(network(&all)?));
        calibration.discrepancies = discrepancies(&all, &calibration);
    }
    Ok(calibration)
}

fn material(samples: &[&CalibrationSample]) -> Result<Material, CalibrationError> {
    let first =
        samples.first().ok_or(CalibrationError::Packings { what: "packings", found: 0, needed: 3 })?;
    for s in samples {
        s.check()?;
        for (field, value, reference) in [
            ("shear modulus of the grains", s.material.shear_modulus, first.material.shear_modulus),
            ("Poisson ratio of the grains", s.material.poisson_ratio, first.material.poisson_ratio),
        ] {
            if value != reference {
                let requirement = "all packings of a calibration must be of one material";
                return Err(CalibrationError::Constant { field, value, requirement });
            }
        }
    }
    Ok(first.material)
}
