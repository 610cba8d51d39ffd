//! From `WaveSpeeds` to an observation.

use crate::observed::{Observed, Unobservable, with_error};
use crate::settings::{Axis, Settings};
use grainlab_core::{Material, Vec3, WaveSpeed};
use grainlab_emt::christoffel::{self, AxisError, SpeedFit};
use grainlab_emt::{Conditions, Measured, Misfit, Modulus, Observation, StrainRatio};
use grainlab_msgs::boundary::WaveSpeedsReading;

/// Sine of the angle between the axis used and the one stated beyond which there is a note: 6°.
const APART: f64 = 0.1;

/// The moduli that the speeds determine about the axis set, with the errors of speeds and density, or else
/// that of the settings. γ/Δ is unknown to an instrument.
pub(crate) fn of_speeds(reading: &WaveSpeedsReading, settings: &Settings) -> Result<Observed, Unobservable> {
    let speeds = reading.measured();
    let mut notes = Vec::new();
    let axis = match settings.axis {
        Axis::Stated | Axis::E3 => Vec3::z(),
        Axis::Given(axis) => axis,
        Axis::Found => match reading.axis {
            Some(axis) => axis,
            None => found(&speeds, &mut notes)?,
        },
    };
    let along_stated = axis.cross(&reading.axis.unwrap_or_else(Vec3::z)).norm() < APART;
    let density = Measured { value: reading.density, stddev: reading.density_stddev.unwrap_or(0.0) };
    let conditions = Conditions {
        pressure: Measured { value: reading.pressure, stddev: reading.pressure_stddev },
        gamma: StrainRatio::ZERO,
        solid_fraction: reading.solid_fraction.map(Measured::exact),
        // That of the message is about its own axis.
        stress_ratio: reading
            .stress_ratio
            .filter(|_| along_stated)
            .map(|value| Measured { value, stddev: reading.stress_ratio_stddev }),
        size_spread: reading.size_spread,
        material: Some(Material {
            shear_modulus: reading.grain_shear_modulus,
            poisson_ratio: reading.grain_poisson_ratio,
            // An instrument measures the density of the sample; no model needs that of a grain.
            ..Material::GLASS
        }),
        shear_modulus_stddev: reading.grain_shear_modulus_stddev,
        poisson_ratio_stddev: reading.grain_poisson_ratio_stddev,
        contact_law: reading.contact_law,
        smooth: reading.smooth,
    };
    let grains = reading.grains.map(f64::from);
    let fitted = christoffel::moduli_of_sample(&speeds, density, Some(axis), conditions, grains)?;
    notes.extend(notes_on(&fitted, speeds.len(), reading.axis, &axis));
    notes.extend(reading.warnings.iter().map(|warning| format!("the instrument reports: {warning}")));
    let other = other_axis(&fitted, &speeds, density, &axis);
    let in_conflict = fitted.conflict.is_some() || other.is_some();
    notes.extend(other);
    let freedom = fitted.degrees_of_freedom;
    let misfit = fitted.chi_square.map(|chi_square| Misfit { chi_square, degrees_of_freedom: freedom });
    let observation = match fitted.observation.covariance {
        Some(_) => fitted.observation,
        None => {
            let error = 100.0 * settings.modulus_error;
            notes.push(format!("no wave speed has a standard deviation: every modulus has one of {error} %"));
            with_error(fitted.observation, settings.modulus_error)
        }
    };
    let observation = Observation { grains: reading.grains, ..observation };
    Ok(Observed { observation, misfit: misfit.filter(|m| m.degrees_of_freedom > 0), in_conflict, notes })
}

/// The axis inferred from the speeds, and a note on it. A medium that looks isotropic gets e3.
fn found(speeds: &[WaveSpeed], notes: &mut Vec<String>) -> Result<Vec3, Unobservable> {
    let (axis, note) = match christoffel::find_axis(speeds) {
        Ok(found) => {
            let (axis, degrees, sigma) = (found.axis, found.stddev().to_degrees(), found.sigma);
            let note = format!(
                "no axis was named: ({:.4}, {:.4}, {:.4}) was found from the speeds, to {degrees:.1} degrees (one sigma), \
                 preferred to isotropy by {sigma:.1} sigma",
                axis.x, axis.y, axis.z
            );
            (axis, note)
        }
        Err(isotropic @ AxisError::Isotropic { .. }) => {
            (Vec3::z(), format!("no axis was named, and e3 was taken: {isotropic}"))
        }
        Err(error) => return Err(error.into()),
    };
    notes.push(note);
    Ok(axis)
}

/// A note on another axis about which speeds that depart from a medium scatter less than half as much: the
/// departure is then due to the axis used, not to the sample.
fn other_axis(fitted: &SpeedFit, speeds: &[WaveSpeed], density: Measured, taken: &Vec3) -> Option<String> {
    fitted.anisotropy_scatter?;
    let found = christoffel::find_axis(speeds).ok()?;
    let axis = found.axis;
    if axis.cross(taken).norm() < APART.max(3.0 * found.stddev()) {
        return None;
    }
    let about =
        christoffel::moduli_from_speeds(speeds, density, Some(axis), fitted.observation.conditions).ok()?;
    let (before, after) = (2.0 * fitted.scatter()?, 2.0 * about.scatter()?);
    (after < 0.5 * before).then(|| {
        format!(
            "the wave speeds fit another axis better: about ({:.4}, {:.4}, {:.4}) rho v^2 scatters by {:.2} %, about the one \
             taken by {:.2} %; set the parameter axis",
            axis.x, axis.y, axis.z, 100.0 * after, 100.0 * before
        )
    })
}

/// Notes on the moduli that were fitted to `speeds` speeds; `name` names each speed.
pub fn notes_on_fit(fitted: &SpeedFit, speeds: usize, name: impl Fn(usize) -> String) -> Vec<String> {
    let mut notes = Vec::new();
    if let Some(departure) = fitted.anisotropy_scatter {
        notes.push(format!(
            "rho v^2 of the wave speeds scatters by {:.1} % about a medium isotropic about the axis, more than their errors \
             do: the sample is not quite one, and {:.2} % were added to the error of every speed",
            100.0 * departure, 50.0 * departure
        ));
    }
    if let Some(conflict) = &fitted.conflict {
        let (worst, sigma) = (name(conflict.worst), conflict.sigma);
        let (chi_square, freedom) = (fitted.chi_square.unwrap_or_default(), fitted.degrees_of_freedom);
        notes.push(format!(
            "the wave speeds contradict each other: chi-square {chi_square:.1} for {freedom} degrees of freedom, {worst} \
             is {sigma:.1} sigma from the prediction by the others"
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
    notes
}

fn notes_on(fitted: &SpeedFit, speeds: usize, named: Option<Vec3>, taken: &Vec3) -> Vec<String> {
    let mut notes = notes_on_fit(fitted, speeds, |at| format!("speeds[{at}]"));
    if let Some(named) = named.filter(|n| n.cross(taken).norm() > APART) {
        notes.push(format!(
            "the axis taken is ({:.3}, {:.3}, {:.3}), and the data name ({:.3}, {:.3}, {:.3}): set the parameter axis to \
             found if theirs is meant",
            taken.x, taken.y, taken.z, named.x, named.y, named.z
        ));
    }
    notes
}
