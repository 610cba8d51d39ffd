//! Results of the models, with the stable keys of `results[]`.

use crate::measurements::Measurement;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{CREDIBLE_LEVEL, EmtError, Estimate, Status, recommended};
use grainlab_msgs::boundary::{Interval, ModelResult, Quantities};
use grainlab_msgs::topics::{MODULI, PACKING_REPORT};
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::Deref;

/// One model's result, and the origin of its data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inference {
    /// Origin of its data.
    #[serde(flatten)]
    pub origin: Origin,
    /// Result of the model.
    #[serde(flatten)]
    pub result: ModelResult,
}

impl Deref for Inference {
    type Target = ModelResult;

    fn deref(&self) -> &ModelResult {
        &self.result
    }
}

impl From<ModelResult> for Inference {
    fn from(result: ModelResult) -> Self {
        Self { origin: Origin::default(), result }
    }
}

/// Origin of results.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Origin {
    /// Topic of the data; absent if they came from a command line or a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Node that inferred; absent if unknown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by: Option<String>,
    /// Measurement of the packing, where there are several; else absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measurement: Option<Measurement>,
}

impl Origin {
    pub(crate) fn data_and_node(&self) -> Option<String> {
        Some(format!("{} ({})", self.data()?, self.by.as_deref().unwrap_or("an unknown program")))
    }

    /// The data, and the measurement where there are several: `moduli` of the packing, `wave_speeds, shot 2`.
    pub fn data(&self) -> Option<String> {
        let source = match self.source.as_deref()? {
            report if report == PACKING_REPORT.name => "moduli",
            moduli if moduli == MODULI.name => "moduli of an instrument",
            other => other,
        };
        Some(match &self.measurement {
            Some(measurement) => format!("{source}, {}", measurement.label),
            None => source.to_owned(),
        })
    }
}

/// Results by their origin, in its order.
pub fn by_origin(results: &[Inference]) -> Vec<(Origin, Vec<&Inference>)> {
    let mut groups = BTreeMap::<Origin, Vec<&Inference>>::new();
    for r in results {
        groups.entry(r.origin.clone()).or_default().push(r);
    }
    let mut groups: Vec<_> = groups.into_iter().collect();
    // The report of the packing comes first, and of one topic the results of a program that is not known come last.
    groups.sort_by_key(|(o, _)| {
        (o.source.as_deref().is_some_and(|s| s != PACKING_REPORT.name), o.source.clone(), o.by.is_none())
    });
    groups
}

impl Inference {
    /// The recommended one among the results of all models from the same data.
    pub fn recommended<'a>(results: &[&'a Self]) -> Option<&'a Self> {
        let named = |r: &Self| {
            [Status::Ok, Status::Extrapolated, Status::Contradictory]
                .into_iter()
                .find(|s| s.name() == r.status)
        };
        let status = |r: &Self| named(r).unwrap_or(Status::Unknown);
        let name = recommended(results.iter().map(|r| (r.model.as_str(), status(r))))?;
        results.iter().find(|r| r.model == name).copied()
    }

    /// Why none of the results is recommended: the reason of the model that would be.
    pub fn why_unknown(results: &[&Self]) -> Option<String> {
        let name = recommended(results.iter().map(|r| (r.model.as_str(), Status::Ok)))?;
        let without = results.iter().find(|r| r.model == name)?;
        Some(format!("model {name}: {}", without.warnings.first()?))
    }

    /// From the result of a model of the kernel.
    pub fn of(model: &str, calibration: &str, outcome: &Result<Estimate, EmtError>) -> Self {
        let estimate = match outcome {
            Ok(estimate) => estimate,
            Err(e) => return ModelResult::unknown(model, calibration, vec![e.to_string()]).into(),
        };
        // A covariance of zeros contains no information.
        let known = estimate.covariance().is_some_and(|c| c.amax() > 0.0);
        let of_model = |q: InferredQuantity| {
            let i = q as usize;
            estimate.structure.get(q).and(estimate.model_covariance).map(|c| c[(i, i)].max(0.0).sqrt())
        };
        let result = ModelResult {
            model: estimate.model.to_owned(),
            calibration: estimate.calibration.clone(),
            values: Quantities(estimate.structure.values()),
            sigma: Quantities::of(|q| estimate.stddev(q).filter(|_| known)),
            sigma_model: Quantities::of(of_model),
            interval: Interval {
                level: known.then_some(CREDIBLE_LEVEL),
                bounds: Quantities::of(|q| estimate.interval(q).filter(|_| known)),
            },
            chi_square: estimate.misfit.map(|m| m.chi_square),
            degrees_of_freedom: Some(estimate.misfit.map_or(0, |m| m.degrees_of_freedom)),
            condition_number: estimate.condition_number(),
            status: estimate.status.name(),
            gamma_over_delta: estimate.gamma.map(|g| g.value),
            gamma_over_delta_source: estimate.gamma.map(|g| g.source.name()),
            warnings: estimate.warnings.iter().map(ToString::to_string).collect(),
        };
        result.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_core::Material;
    use grainlab_emt::{Calibration, Measured, Observation, StrainRatio};
    use grainlab_msgs::msg::Moduli;

    #[test]
    fn a_result_read_back_from_a_message_is_the_one_that_the_kernel_gave() {
        let message = Moduli {
            g12: vec![121.71e6],
            g13: vec![127.37e6],
            theta: vec![144.38e6],
            pressure: 50e3,
            solid_fraction: vec![0.636],
            grain_shear_modulus: Material::GLASS.shear_modulus,
            grain_poisson_ratio: Material::GLASS.poisson_ratio,
            grain_density: Material::GLASS.density,
            ..Moduli::default()
        };
        let sent = grainlab_emt_inversion::microstructure_of_moduli(
            &message,
            &grainlab_emt_inversion::Settings::default(),
        )
        .message;
        let results = sent.results().unwrap();
        let read = Inference::from(results.into_iter().find(|e| e.model == "ratio").unwrap());
        let mut observation =
            Observation::from_g12_g13_theta(121.71e6, 127.37e6, 144.38e6, 50e3, StrainRatio::ZERO);
        observation.conditions.solid_fraction = Some(Measured::exact(0.636));
        observation.conditions.material = Some(Material::GLASS);
        let observation = observation.with_relative_error(0.01);
        let outcome = grainlab_emt::model("ratio").unwrap().infer(&observation, &Calibration::PAPER);
        let direct = Inference::of("ratio", "paper", &outcome);
        assert!(direct.sigma[InferredQuantity::K].is_some() && direct.interval.level.is_some(), "{direct:?}");
        assert_eq!(read, direct);
    }

    #[test]
    fn the_keys_of_a_result_are_the_agreed_ones() {
        let unknown = Inference::from(ModelResult::unknown("ratio", "paper", vec!["why".into()]));
        let keys = |value: &serde_json::Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
        let value = serde_json::to_value(&unknown).unwrap();
        let quantities = ["eps", "eps_stiffness", "k", "k_hat", "z"];
        let mut expected = vec![
            "model",
            "calibration",
            "sigma",
            "sigma_model",
            "interval",
            "chi_square",
            "degrees_of_freedom",
            "condition_number",
            "status",
            "gamma_over_delta",
            "gamma_over_delta_source",
            "warnings",
        ];
        expected.extend(quantities);
        expected.sort_unstable();
        let mut found = keys(&value);
        found.sort_unstable();
        assert_eq!(found, expected);
        for group in ["sigma", "sigma_model"] {
            let mut found = keys(&value[group]);
            found.sort_unstable();
            assert_eq!(found, quantities, "{group}");
        }
        assert!(value["interval"].get("level").is_some() && value["interval"].get("z").is_some());
    }
}
