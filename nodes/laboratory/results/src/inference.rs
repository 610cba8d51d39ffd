//! Results of the models, with the stable keys of `results[]`.

use crate::measurements::Measurement;
use crate::quantities::NoteView;
use grainlab_core::notes::{Note, Status, texts};
use grainlab_core::results::{Estimate, InferredQuantity, Quantities};
use grainlab_emt::{EmtError, Inversion, recommended};
use grainlab_msgs::topics::{MODULI, PACKING_REPORT};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::collections::BTreeMap;
use std::ops::Deref;

/// The estimate of one model, and the origin of its data.
#[derive(Clone, Debug, PartialEq)]
pub struct Inference {
    /// Origin of the data.
    pub origin: Origin,
    /// Result of the model.
    pub estimate: Estimate,
}

impl Deref for Inference {
    type Target = Estimate;

    fn deref(&self) -> &Estimate {
        &self.estimate
    }
}

impl From<Estimate> for Inference {
    fn from(estimate: Estimate) -> Self {
        Self { origin: Origin::default(), estimate }
    }
}

/// The stable keys of `results[]`.
impl Serialize for Inference {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (e, Origin { source, by, measurement }) = (&self.estimate, &self.origin);
        let mut map = serializer.serialize_map(None)?;
        source.iter().try_for_each(|source| map.serialize_entry("source", source))?;
        by.iter().try_for_each(|by| map.serialize_entry("by", by))?;
        measurement.iter().try_for_each(|m| map.serialize_entry("measurement", m))?;
        map.serialize_entry("model", &e.model)?;
        map.serialize_entry("calibration", &e.calibration)?;
        for quantity in InferredQuantity::ALL {
            map.serialize_entry(quantity.name(), &e.values[quantity])?;
        }
        map.serialize_entry("sigma", &ByName(&Quantities::from_fn(|q| e.sigma(q))))?;
        map.serialize_entry("sigma_model", &ByName(&Quantities::from_fn(|q| e.sigma_model(q))))?;
        map.serialize_entry("interval", &IntervalView(e))?;
        map.serialize_entry("chi_square", &e.chi_square)?;
        map.serialize_entry("degrees_of_freedom", &e.degrees_of_freedom)?;
        map.serialize_entry("condition_number", &e.condition_number)?;
        map.serialize_entry("status", e.status.name())?;
        map.serialize_entry("gamma_over_delta", &e.gamma.map(|gamma| gamma.value))?;
        map.serialize_entry("gamma_over_delta_source", &e.gamma.map(|gamma| gamma.source))?;
        map.serialize_entry("warnings", &texts(&e.notes))?;
        map.serialize_entry("notes", &e.notes.iter().map(NoteView).collect::<Vec<_>>())?;
        map.end()
    }
}

struct ByName<'a, T>(&'a Quantities<T>);

impl<T: Serialize> Serialize for ByName<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(InferredQuantity::ALL.map(InferredQuantity::name).into_iter().zip(&self.0.0))
    }
}

struct IntervalView<'a>(&'a Estimate);

impl Serialize for IntervalView<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let interval = &self.0.interval;
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("level", &interval.level)?;
        for quantity in InferredQuantity::ALL {
            map.serialize_entry(quantity.name(), &interval.bounds[quantity])?;
        }
        map.end()
    }
}

/// Origin of results.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Origin {
    /// Topic of the data; absent if they came from a command line or a file.
    pub source: Option<String>,
    /// Node that inferred; absent if unknown.
    pub by: Option<String>,
    /// Measurement of the packing, where there are several; else absent.
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
    /// Returns the recommended one among the results of all models from the same data.
    pub fn recommended<'a>(results: &[&'a Self]) -> Option<&'a Self> {
        let name = recommended(results.iter().map(|r| (r.model.as_str(), r.status)))?;
        results.iter().find(|r| r.model == name).copied()
    }

    /// Returns the result of the model that would be recommended if each had an estimate.
    pub fn preferred<'a>(results: &[&'a Self]) -> Option<&'a Self> {
        let name = recommended(results.iter().map(|r| (r.model.as_str(), Status::Ok)))?;
        results.iter().find(|r| r.model == name).copied()
    }

    /// Returns why none of the results is recommended: the reason of the model that would be.
    pub fn why_unknown(results: &[&Self]) -> Option<String> {
        let without = Self::preferred(results)?;
        Some(format!("model {}: {}", without.model, without.notes.first()?))
    }

    /// Creates the result of a model of the kernel.
    pub fn new(model: &str, calibration: &str, outcome: &Result<Inversion, EmtError>) -> Self {
        match outcome {
            Ok(inversion) => inversion.estimate().into(),
            Err(error) => Estimate::unknown(model, calibration, vec![Note::from(error)]).into(),
        }
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
        let direct = Inference::new("ratio", "paper", &outcome);
        assert!(direct.sigma(InferredQuantity::K).is_some() && direct.interval.level.is_some(), "{direct:?}");
        assert_eq!(read, direct);
    }

    #[test]
    fn the_keys_of_a_result_are_the_agreed_ones() {
        let unknown = Inference::from(Estimate::unknown("ratio", "paper", vec![Note::no_answer("why")]));
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
            "notes",
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
