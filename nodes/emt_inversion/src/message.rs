//! From one `Moduli` to one `Microstructure`.

use crate::Settings;
use emt::{CREDIBLE_LEVEL, Calibration, EmtError, Estimate, Gamma, Observation, Quantity, Status, models};
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
    let estimates = models()
        .iter()
        .map(|model| match model.infer(&observation, &calibration) {
            Ok(estimate) => estimate_message(&estimate),
            Err(error) => failure(model.name(), &calibration, &observation.conditions.gamma, &error),
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
    let observed = Observation::paper(reading.g12, reading.g13, reading.theta, reading.pressure, gamma);
    match &reading.covariance {
        Some(covariance) => observed.with_paper_covariance(&Mat3::from_row_slice(covariance)),
        None if settings.modulus_error > 0.0 => observed.with_relative_error(settings.modulus_error),
        None => observed,
    }
}

fn estimate_message(estimate: &Estimate) -> msg::Estimate {
    const PAPER: [Quantity; 3] = [Quantity::K, Quantity::KHat, Quantity::Eps];
    let covariance = estimate.covariance();
    let [k, k_hat, eps] = PAPER.map(|q| estimate.structure.get(q).unwrap_or_default());
    msg::Estimate {
        model: estimate.model.to_owned(),
        calibration: estimate.calibration.clone(),
        status: match estimate.status {
            Status::Ok => msg::Estimate::STATUS_OK,
            Status::Extrapolated => msg::Estimate::STATUS_EXTRAPOLATED,
        },
        gamma_over_delta: estimate.gamma.map_or(0.0, |g| g.value),
        gamma_over_delta_source: estimate.gamma.map_or("none", |g| g.source.name()).to_owned(),
        k,
        k_hat,
        eps,
        covariance: covariance
            .map_or([0.0; 9], |c| std::array::from_fn(|i| c[(PAPER[i / 3] as usize, PAPER[i % 3] as usize)])),
        interval: std::array::from_fn(|i| {
            estimate.interval(PAPER[i / 2]).map_or(0.0, |bounds| bounds[i % 2])
        }),
        credible_level: if covariance.is_some() { CREDIBLE_LEVEL } else { 0.0 },
        warnings: estimate.warnings.iter().map(ToString::to_string).collect(),
    }
}

fn failure(model: &str, calibration: &Calibration, gamma: &Gamma, error: &EmtError) -> msg::Estimate {
    let status =
        if error.is_of_input() { msg::Estimate::STATUS_UNDETERMINED } else { msg::Estimate::STATUS_FAILED };
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
