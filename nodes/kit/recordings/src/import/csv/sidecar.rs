//! The JSON beside a CSV.

use grainlab_core::Mat3;
use grainlab_core::contact::ContactLaw;
use serde::Deserialize;
use serde_json::Value;

use crate::import::assemble::Moment;
use crate::import::error::ImportError;
use crate::import::settings::Known;
use crate::import::stated;

fn wrong(problem: impl std::fmt::Display) -> ImportError {
    ImportError::Invalid(format!("sidecar: {problem}"))
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Sidecar {
    #[serde(rename = "G")]
    g: Option<f64>,
    shear_modulus: Option<f64>,
    nu: Option<f64>,
    poisson_ratio: Option<f64>,
    density: Option<f64>,
    contact_law: Option<String>,
    #[serde(default)]
    contact_law_parameters: Vec<f64>,
    mu_prep: Option<Friction>,
    friction: Option<Friction>,
    cell: Option<[[f64; 3]; 3]>,
    #[serde(rename = "box_L")]
    box_lengths: Option<[f64; 3]>,
    step: Option<u64>,
    time: Option<f64>,
    time_step: Option<f64>,
    deformation: Option<[[f64; 3]; 3]>,
    #[serde(rename = "N")]
    grains: Option<usize>,
    n_contacts: Option<usize>,
    units: Option<String>,
    pbc: Option<Value>,
    walls: Option<Value>,
    gravity: Option<Value>,
}

/// True for a value that stands for absence: null, false, zero, "", "none", or a list or table of such values.
fn is_nothing(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Bool(some) => !some,
        Value::Number(number) => number.as_f64() == Some(0.0),
        Value::String(text) => matches!(text.as_str(), "" | "none"),
        Value::Array(all) => all.iter().all(is_nothing),
        Value::Object(all) => all.values().all(is_nothing),
    }
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Friction {
    Number(f64),
    Word(String),
}

impl Sidecar {
    pub(super) fn parse(text: Option<&str>) -> Result<Self, ImportError> {
        let Some(text) = text else { return Ok(Self::default()) };
        serde_json::from_str(text).map_err(wrong)
    }

    /// Refuses other numbers of grains and contacts than it states.
    pub(super) fn counts(&self, grains: usize, contacts: usize) -> Result<(), ImportError> {
        for (what, stated, found) in
            [("grains", self.grains, grains), ("contacts", self.n_contacts, contacts)]
        {
            if let Some(stated) = stated.filter(|stated| *stated != found) {
                return Err(ImportError::count(what, stated, found));
            }
        }
        Ok(())
    }

    pub(super) fn known(&self) -> Result<Known, ImportError> {
        self.units.as_deref().map_or(Ok(()), |units| stated::units(1, units))?;
        self.pbc.as_ref().map_or(Ok(()), |pbc| stated::periodic(1, &pbc.to_string()))?;
        for (what, value) in [("walls", &self.walls), ("gravity", &self.gravity)] {
            if value.as_ref().is_some_and(|value| !is_nothing(value)) {
                return Err(wrong(format_args!("{what}: packings are periodic, without {what}")));
            }
        }
        let friction = |key: &str, value: &Option<Friction>| match value {
            None => Ok(None),
            Some(Friction::Number(mu)) => Ok(Some(*mu)),
            Some(Friction::Word(word)) if word == "inf" => Ok(Some(f64::INFINITY)),
            Some(Friction::Word(word)) => {
                Err(wrong(format_args!("{key} is {word:?}: a number or \"inf\" is needed")))
            }
        };
        let [prepared, friction] = [("mu_prep", &self.mu_prep), ("friction", &self.friction)]
            .map(|(key, value)| friction(key, value));
        let law = self.contact_law.as_deref().map(|name| ContactLaw::new(name, &self.contact_law_parameters));
        let box_lengths = self.box_lengths.map(|l| Mat3::from_diagonal(&l.into()));
        Ok(Known {
            cell: once(("cell", self.cell.map(matrix)), ("box_L", box_lengths))?,
            shear_modulus: once(("G", self.g), ("shear_modulus", self.shear_modulus))?,
            poisson_ratio: once(("nu", self.nu), ("poisson_ratio", self.poisson_ratio))?,
            density: self.density,
            law: law.transpose().map_err(wrong)?,
            friction: once(("mu_prep", prepared?), ("friction", friction?))?,
        })
    }

    pub(super) fn state(&self) -> Result<Moment, ImportError> {
        let state = Moment::at(self.step.unwrap_or(0));
        Ok(Moment {
            time: self.time.unwrap_or(state.time),
            deformation: self.deformation.map_or(state.deformation, matrix),
            time_step: self.time_step.unwrap_or(state.time_step),
            ..state
        })
    }
}

/// The value of a quantity that has two keys. Two equal values are one.
fn once<T: PartialEq>(
    (name, value): (&str, Option<T>),
    (other_name, other): (&str, Option<T>),
) -> Result<Option<T>, ImportError> {
    match (&value, &other) {
        (Some(a), Some(b)) if a != b => Err(wrong(format_args!(
            "{name} and {other_name} state one quantity, and have different values: leave one of them"
        ))),
        _ => Ok(value.or(other)),
    }
}

fn matrix(rows: [[f64; 3]; 3]) -> Mat3 {
    Mat3::from_fn(|r, c| rows[r][c])
}
