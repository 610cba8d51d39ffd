//! From `WaveSpeeds` to what a model takes.

use crate::observed::{Observed, Unobservable, with_error};
use crate::settings::{Axis, Settings};
use emt::christoffel::{self, Fitted};
use emt::{Conditions, Gamma, Measured, Misfit, Modulus};
use grainlab_msgs::boundary::WaveSpeedsReading;
use grains::{Material, Vec3};

/// Sine of the angle between the axis taken and the one named beyond which something is said: 6°.
const APART: f64 = 0.1;

/// The moduli that the speeds determine about the axis set, with the errors of speeds and density, or else that of the
/// settings. γ/Δ is not among what an instrument knows.
pub(crate) fn of_speeds(reading: &WaveSpeedsReading, settings: &Settings) -> Result<Observed, Unobservable> {
    let axis = match settings.axis {
        Axis::E3 => Vec3::z(),
        Axis::Given(axis) => axis,
        Axis::Found => reading.axis.ok_or(Unobservable::NoAxis)?,
    };
    let density = Measured { value: reading.density, stddev: reading.density_stddev.unwrap_or(0.0) };
    let conditions = Conditions {
        pressure: Measured::exact(reading.pressure),
        gamma: Gamma::ZERO,
        solid_fraction: reading.solid_fraction.map(Measured::exact),
        material: Some(Material {
            shear_modulus: reading.grain_shear_modulus,
            poisson_ratio: reading.grain_poisson_ratio,
            // An instrument knows that of the sample; no model asks for that of a grain.
            ..Material::GLASS
        }),
    };
    let speeds = reading.measured();
    let fitted = christoffel::observation(&speeds, density, Some(axis), conditions)?;
    let notes = notes(&fitted, speeds.len(), reading.axis, &axis);
    let freedom = fitted.degrees_of_freedom;
    let misfit = fitted.chi_square.map(|chi_square| Misfit { chi_square, degrees_of_freedom: freedom });
    let observation = match fitted.observation.covariance {
        Some(_) => fitted.observation,
        None => with_error(fitted.observation, settings.modulus_error),
    };
    Ok(Observed {
        observation,
        misfit: misfit.filter(|m| m.degrees_of_freedom > 0),
        in_conflict: fitted.conflict.is_some(),
        notes,
    })
}

fn notes(fitted: &Fitted, speeds: usize, named: Option<Vec3>, taken: &Vec3) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(conflict) = &fitted.conflict {
        let (worst, sigma) = (conflict.worst, conflict.sigma);
        let (chi_square, freedom) = (fitted.chi_square.unwrap_or_default(), fitted.degrees_of_freedom);
        notes.push(format!(
            "the wave speeds contradict each other: chi-square {chi_square:.1} for {freedom} degrees of freedom, speeds[{worst}] \
             is {sigma:.1} sigma from what the others say"
        ));
    }
    if !fitted.undetermined.is_empty() {
        let open: Vec<&str> = fitted.undetermined.iter().map(|m: &Modulus| m.name()).collect();
        notes.push(format!("the wave speeds do not determine {}", open.join(", ")));
    }
    if fitted.assumed > 0 {
        notes.push(format!(
            "{} of {speeds} wave speeds have no standard deviation: the largest relative one of the others was taken",
            fitted.assumed
        ));
    }
    if let Some(named) = named.filter(|n| n.cross(taken).norm() > APART) {
        notes.push(format!(
            "the axis taken is ({:.3}, {:.3}, {:.3}), and the data name ({:.3}, {:.3}, {:.3}): set the parameter axis to \
             found if theirs is meant",
            taken.x, taken.y, taken.z, named.x, named.y, named.z
        ));
    }
    notes
}
