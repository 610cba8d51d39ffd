//! From the result of a model to an `Estimate`.

use crate::observed::Observed;
use grainlab_core::results::{InferredQuantity, MicrostructureCovariance};
use grainlab_emt::{CREDIBLE_LEVEL, Estimate, INPUTS, Misfit, Status, StrainRatio};
use grainlab_msgs::boundary::ModelResult;
use grainlab_msgs::msg;

/// The message of an estimate. An invalid estimate is sent as unknown, with the reason.
pub(crate) fn estimate_message(estimate: &Estimate, observed: &Observed) -> msg::Estimate {
    let message = as_it_is(estimate, observed);
    match ModelResult::try_from(&message) {
        Ok(_) => message,
        Err(error) => unknown(estimate.model, &estimate.calibration, estimate.gamma, vec![error.to_string()]),
    }
}

fn as_it_is(estimate: &Estimate, observed: &Observed) -> msg::Estimate {
    let status = match estimate.status {
        Status::Unknown => msg::Estimate::STATUS_UNKNOWN,
        _ if observed.in_conflict => msg::Estimate::STATUS_CONTRADICTORY,
        Status::Ok => msg::Estimate::STATUS_OK,
        Status::Extrapolated => msg::Estimate::STATUS_EXTRAPOLATED,
        Status::Contradictory => msg::Estimate::STATUS_CONTRADICTORY,
    };
    let misfit = both(observed.misfit, estimate.misfit);
    let covariance = known_covariance(estimate.covariance());
    let bounds = InferredQuantity::ALL.map(|q| covariance.and_then(|_| estimate.interval(q)));
    let shares = InferredQuantity::ALL.map(|q| estimate.information(q));
    let (gamma_over_delta, gamma_over_delta_source) = gamma_fields(estimate.gamma);
    let of_model = estimate.warnings.iter().map(ToString::to_string);
    // The first warning is the reason of the status.
    let is_of_model = estimate.status == Status::Contradictory && !observed.in_conflict;
    let warnings = match is_of_model {
        true => of_model.chain(observed.notes.iter().cloned()).collect(),
        false => observed.notes.iter().cloned().chain(of_model).collect(),
    };
    let mut message = msg::Estimate {
        model: estimate.model.to_owned(),
        calibration: estimate.calibration.clone(),
        status,
        gamma_over_delta,
        gamma_over_delta_source,
        covariance: entries(covariance),
        covariance_model: entries(known_covariance(estimate.model_covariance)),
        interval: covariance
            .map_or_else(Vec::new, |_| bounds.into_iter().flat_map(Option::unwrap_or_default).collect()),
        credible_level: if covariance.is_some() { CREDIBLE_LEVEL } else { 0.0 },
        chi_square: misfit.chi_square,
        degrees_of_freedom: misfit.degrees_of_freedom as u32,
        condition_number: estimate.condition_number().into_iter().collect(),
        information: std::array::from_fn(|i| shares[i / INPUTS].map_or(0.0, |s| s[i % INPUTS])),
        warnings,
        ..Default::default()
    };
    for (field, value) in message.quantities_mut().into_iter().zip(estimate.structure.values()) {
        field.extend(value);
    }
    message
}

/// Misfit of the speeds about the moduli and of the moduli about the structure: squares and degrees of
/// freedom add up.
fn both(of_data: Option<Misfit>, of_moduli: Option<Misfit>) -> Misfit {
    let nothing = Misfit { chi_square: 0.0, degrees_of_freedom: 0 };
    [of_data, of_moduli].into_iter().flatten().filter(|m| m.degrees_of_freedom > 0).fold(nothing, |sum, m| {
        Misfit {
            chi_square: sum.chi_square + m.chi_square,
            degrees_of_freedom: sum.degrees_of_freedom + m.degrees_of_freedom,
        }
    })
}

/// A covariance of zeros contains no information.
fn known_covariance(covariance: Option<MicrostructureCovariance>) -> Option<MicrostructureCovariance> {
    covariance.filter(|c| c.amax() > 0.0)
}

fn entries(covariance: Option<MicrostructureCovariance>) -> Vec<f64> {
    let row_major = |c: MicrostructureCovariance| c.transpose().iter().copied().collect();
    covariance.map_or_else(Vec::new, row_major)
}

fn gamma_fields(gamma: Option<StrainRatio>) -> (Vec<f64>, String) {
    (gamma.iter().map(|g| g.value).collect(), gamma.map_or("none", |g| g.source.name()).to_owned())
}

/// The message of a model without an estimate, or that was not applied because there were no moduli.
pub(crate) fn unknown(
    model: &str,
    calibration: &str,
    gamma: Option<StrainRatio>,
    warnings: Vec<String>,
) -> msg::Estimate {
    let (gamma_over_delta, gamma_over_delta_source) = gamma_fields(gamma);
    msg::Estimate {
        model: model.to_owned(),
        calibration: calibration.to_owned(),
        status: msg::Estimate::STATUS_UNKNOWN,
        gamma_over_delta,
        gamma_over_delta_source,
        warnings,
        ..Default::default()
    }
}
