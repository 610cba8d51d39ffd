//! From one `Moduli` to one `Microstructure`.

use crate::Settings;
use emt::{CREDIBLE_LEVEL, Calibration, EmtError, Estimate, Gamma, Observation, Status, infer_all};
use grainlab_msgs::boundary::{BoundaryError, ModuliReading};
use grainlab_msgs::{msg, topics};
use grains::Mat3;

/// What every model infers from one set of moduli with the paper's calibration: one estimate a model, in the order of
/// [`emt::models`]. Header and step are copied; nothing but the two arguments enters.
pub fn microstructure_message(
    moduli: &msg::Moduli,
    settings: &Settings,
) -> Result<msg::Microstructure, BoundaryError> {
    let reading = ModuliReading::try_from(moduli)?;
    let observation = observation(&reading, settings);
    let calibration = Calibration::PAPER;
    let estimates = infer_all(&observation, &calibration)
        .into_iter()
        .map(|(model, inferred)| match inferred {
            Ok(estimate) => estimate_message(&estimate),
            Err(error) => failure(model, &calibration, &observation.gamma, &error),
        })
        .collect();
    Ok(msg::Microstructure {
        header: moduli.header.clone(),
        source_step: moduli.source_step,
        // The contract's name and not the resolved one: the bytes must not depend on a namespace.
        source: topics::MODULI.name.to_owned(),
        estimates,
    })
}

fn observation(reading: &ModuliReading, settings: &Settings) -> Observation {
    let gamma = Gamma::of(&reading.gamma_over_delta, settings.gamma);
    let observed = Observation::new(reading.g12, reading.g13, reading.theta, reading.pressure, gamma);
    match &reading.covariance {
        Some(covariance) => observed.with_covariance(Mat3::from_row_slice(covariance)),
        None if settings.modulus_error > 0.0 => observed.with_relative_error(settings.modulus_error),
        None => observed,
    }
}

fn estimate_message(estimate: &Estimate) -> msg::Estimate {
    let interval = estimate.interval();
    let covariance = estimate.covariance.as_ref();
    msg::Estimate {
        model: estimate.model.to_owned(),
        calibration: estimate.calibration.clone(),
        status: match estimate.status {
            Status::Ok => msg::Estimate::STATUS_OK,
            Status::Extrapolated => msg::Estimate::STATUS_EXTRAPOLATED,
        },
        gamma_over_delta: estimate.gamma.value,
        gamma_over_delta_source: estimate.gamma.source.name().to_owned(),
        k: estimate.structure.k,
        k_hat: estimate.structure.k_hat,
        eps: estimate.structure.eps,
        covariance: covariance.map_or([0.0; 9], |c| std::array::from_fn(|i| c[(i / 3, i % 3)])),
        interval: interval.map_or([0.0; 6], |bounds| std::array::from_fn(|i| bounds[i / 2][i % 2])),
        credible_level: if interval.is_some() { CREDIBLE_LEVEL } else { 0.0 },
        warnings: estimate.warnings.iter().map(ToString::to_string).collect(),
    }
}

fn failure(model: &str, calibration: &Calibration, gamma: &Gamma, error: &EmtError) -> msg::Estimate {
    let status = match error {
        EmtError::NotFinite { .. }
        | EmtError::NotPositive { .. }
        | EmtError::NegativeStddev { .. }
        | EmtError::Covariance { .. } => msg::Estimate::STATUS_UNDETERMINED,
        EmtError::GammaOutOfRange { .. }
        | EmtError::RatioOutOfRange { .. }
        | EmtError::NoAnisotropy { .. }
        | EmtError::ShearTooStiff { .. } => msg::Estimate::STATUS_FAILED,
    };
    msg::Estimate {
        model: model.to_owned(),
        calibration: calibration.name().to_owned(),
        status,
        gamma_over_delta: gamma.value,
        gamma_over_delta_source: gamma.source.name().to_owned(),
        warnings: vec![error.to_string()],
        ..Default::default()
    }
}
