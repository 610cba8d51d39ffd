//! The values of the parameters.

use grainlab_acoustics::time_of_flight::ArrivalPick;
use grainlab_acoustics::{Instrument, MethodSettings, Modes, Survey, dispersion, time_of_flight};
use grainlab_core::Vec3;
use grainlab_node_kit::Parameters;

/// Settings of the measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings(pub grainlab_acoustics::Settings);

/// A parameter whose value is in range but invalid, and why it is. The process then ends with
/// [`grainlab_node_kit::Exit::Usage`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("parameter \"{0}\"{1}")]
pub struct SettingsError(&'static str, String);

impl TryFrom<&Parameters> for Settings {
    type Error = SettingsError;

    fn try_from(parameters: &Parameters) -> Result<Self, SettingsError> {
        let text = |name| parameters.get::<String>(name);
        Ok(Self(grainlab_acoustics::Settings {
            method: method(parameters)?,
            axis: axis(&text("axis"))?,
            survey: match text("survey").as_str() {
                "three" => Survey::Minimal,
                "everywhere" => Survey::Hemisphere,
                _ => Survey::AzimuthalAverage,
            },
            modes: match text("modes").as_str() {
                "compression" => Modes::Compression,
                "shear" => Modes::Shear,
                _ => Modes::All,
            },
            instrument: Instrument {
                sample_rate: Some(parameters.get("sample_rate")).filter(|rate| *rate > 0.0),
                signal_to_noise: parameters.get("signal_to_noise"),
                jitter: parameters.get("jitter"),
                shots: count(parameters, "shots"),
                speed_noise: parameters.get("speed_noise"),
                seed: parameters.get::<i64>("seed").unsigned_abs(),
            },
        }))
    }
}

/// The range of every one of them ensures that it fits into 32 bits.
fn count(parameters: &Parameters, name: &str) -> u32 {
    u32::try_from(parameters.get::<i64>(name)).unwrap_or(u32::MAX)
}

fn method(parameters: &Parameters) -> Result<MethodSettings, SettingsError> {
    let friction: f64 = parameters.get("wave_friction");
    if friction < 0.0 && friction != -1.0 {
        let reason = format!(" = {friction}: it is 0 or more, or -1 for that of the packing");
        return Err(SettingsError("wave_friction", reason));
    }
    let friction = Some(friction).filter(|mu| *mu >= 0.0);
    let pick = match parameters.get::<String>("method").as_str() {
        "dispersion" => {
            let wavelengths: Vec<f64> = parameters.get("wavelengths");
            if wavelengths.len() < 3 {
                let (count, needed) =
                    (wavelengths.len(), "three or more are needed to extrapolate to long waves");
                return Err(SettingsError("wavelengths", format!(" has {count} entries: {needed}")));
            }
            return Ok(MethodSettings::Dispersion(dispersion::Settings {
                wavelengths,
                tolerance: parameters.get("tolerance"),
                max_iterations: count(parameters, "max_iterations"),
                ..Default::default()
            }));
        }
        "first_arrival" => ArrivalPick::FirstArrival,
        "peak" => ArrivalPick::Peak,
        _ => ArrivalPick::CrossCorrelation,
    };
    let default = time_of_flight::Settings::default();
    Ok(MethodSettings::TimeOfFlight(time_of_flight::Settings {
        frequencies: Some(parameters.get::<Vec<f64>>("frequencies")).filter(|f| !f.is_empty()),
        cycles: parameters.get("cycles"),
        copies: Some(count(parameters, "copies")).filter(|n| *n > 0),
        amplitude: Some(parameters.get("amplitude")).filter(|a| *a > 0.0).unwrap_or(default.amplitude),
        friction,
        pick,
    }))
}

fn axis(text: &str) -> Result<Option<Vec3>, SettingsError> {
    match text.trim() {
        "e3" => return Ok(Some(Vec3::z())),
        "unknown" => return Ok(None),
        _ => {}
    }
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    let direction = numbers.and_then(|n| <[f64; 3]>::try_from(n).ok()).map(Vec3::from);
    let valid = direction.filter(|v| v.iter().all(|n| n.is_finite()) && v.amax() > 0.0);
    // Scaled first: the square of a large component overflows.
    let unit = valid.map(|v| (v / v.amax()).normalize());
    let choices = "e3, unknown, or three numbers x,y,z that are finite and not all zero";
    unit.map(Some).ok_or_else(|| SettingsError("axis", format!(" = {text:?} is not an axis: {choices}")))
}
