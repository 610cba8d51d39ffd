//! From `WaveSpeeds` to an observation.

use crate::observed::{Observed, Unobservable, with_error};
use crate::settings::{Axis, Settings};
use grainlab_core::notes::Note;
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
            None => {
                let (axis, note) = found(&speeds)?;
                notes.push(note);
                axis
            }
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
    notes.extend(notes_on_fit(&fitted, speeds.len(), |at| format!("speeds[{at}]")));
    if let Some(named) = reading.axis.filter(|named| named.cross(&axis).norm() > APART) {
        notes.push(Note::axis_differs(axis.x, axis.y, axis.z, named.x, named.y, named.z));
    }
    notes.extend(reading.notes.iter().map(|note| Note::instrument_reports(note.to_string())));
    notes.extend(other_axis(&fitted, &speeds, density, &axis));
    let freedom = fitted.degrees_of_freedom;
    let misfit = fitted.chi_square.map(|chi_square| Misfit { chi_square, degrees_of_freedom: freedom });
    let observation = match fitted.observation.covariance {
        Some(_) => fitted.observation,
        None => {
            notes.push(Note::speed_errors_unknown(settings.modulus_error));
            with_error(fitted.observation, settings.modulus_error)
        }
    };
    let observation = Observation { grains: reading.grains, ..observation };
    Ok(Observed { observation, misfit, notes })
}

/// Returns the axis inferred from the speeds, with a note on it. A medium that looks isotropic gets e3.
fn found(speeds: &[WaveSpeed]) -> Result<(Vec3, Note), Unobservable> {
    match christoffel::find_axis(speeds) {
        Ok(found) => {
            let axis = found.axis;
            let degrees = found.stddev().to_degrees();
            Ok((axis, Note::axis_found(axis.x, axis.y, axis.z, degrees, found.sigma)))
        }
        Err(isotropic @ AxisError::Isotropic { .. }) => {
            Ok((Vec3::z(), Note::axis_taken(isotropic.to_string())))
        }
        Err(error) => Err(error.into()),
    }
}

/// Returns a note on another axis about which speeds that depart from a medium scatter less than half as much: the departure is
/// then due to the axis used, not to the sample.
fn other_axis(fitted: &SpeedFit, speeds: &[WaveSpeed], density: Measured, taken: &Vec3) -> Option<Note> {
    fitted.anisotropy_scatter?;
    let found = christoffel::find_axis(speeds).ok()?;
    let axis = found.axis;
    if axis.cross(taken).norm() < APART.max(3.0 * found.stddev()) {
        return None;
    }
    let about =
        christoffel::moduli_from_speeds(speeds, density, Some(axis), fitted.observation.conditions).ok()?;
    let (before, after) = (2.0 * fitted.scatter()?, 2.0 * about.scatter()?);
    (after < 0.5 * before).then(|| Note::other_axis_fits(axis.x, axis.y, axis.z, after, before))
}

/// Returns notes on the moduli that were fitted to `speeds` speeds; `name` names each speed.
pub fn notes_on_fit(fitted: &SpeedFit, speeds: usize, name: impl Fn(usize) -> String) -> Vec<Note> {
    let departs = fitted.anisotropy_scatter.map(Note::speeds_depart);
    let contradicts = fitted.conflict.as_ref().map(|conflict| {
        let chi_square = fitted.chi_square.unwrap_or_default();
        Note::speeds_contradict(
            name(conflict.worst),
            chi_square,
            fitted.degrees_of_freedom as f64,
            conflict.sigma,
        )
    });
    let open: Vec<&str> = fitted.undetermined.iter().map(|m: &Modulus| m.name()).collect();
    let open = (!open.is_empty()).then(|| Note::speeds_leave_open(open.join(", ")));
    let taken = fitted.assumed > 0;
    let taken = taken.then(|| Note::speed_errors_taken(fitted.assumed as f64, speeds as f64));
    departs.into_iter().chain(contradicts).chain(open).chain(taken).collect()
}
