//! Prior files (TOML): a section for each quantity.

use super::density::Density;
use super::error::PriorError;
use super::set::Prior;
use grainlab_core::results::InferredQuantity;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Section {
    distribution: Kind,
    mean: Option<f64>,
    stddev: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    Normal,
    Uniform,
    TruncatedNormal,
}

impl Prior {
    /// Reads the text of a prior file.
    pub fn parse(text: &str) -> Result<Self, PriorError> {
        let sections: BTreeMap<String, Section> =
            toml::from_str(text).map_err(|e| PriorError::Text(e.to_string()))?;
        let known = InferredQuantity::ALL.map(|q| format!("[{q}]")).join(", ");
        let mut prior = Self::default();
        for (name, section) in sections {
            let quantity = InferredQuantity::ALL.into_iter().find(|q| q.name() == name);
            let quantity = quantity
                .ok_or_else(|| PriorError::Text(format!("no quantity [{name}]; there are {known}")))?;
            let density = section
                .density()
                .map_err(|fault| PriorError::Section { quantity: quantity.name(), fault })?;
            prior = prior.with(quantity, density);
        }
        if prior.quantities().next().is_none() {
            return Err(PriorError::Text(format!("it has no section; there are {known}")));
        }
        Ok(prior)
    }

    /// The text of a prior file, as [`Prior::parse`] reads it.
    pub fn to_toml(&self) -> String {
        let section = |quantity: InferredQuantity| {
            let section = Section::of(self.get(quantity)?);
            Some(format!("[{quantity}]\n{}", toml::to_string(&section).unwrap_or_default()))
        };
        self.quantities().filter_map(section).collect::<Vec<_>>().join("\n")
    }
}

impl Section {
    fn of(density: &Density) -> Self {
        let [low, high] = density.range().map(|limit| Some(limit).filter(|limit| limit.is_finite()));
        let distribution = match density.of_normal() {
            None => Kind::Uniform,
            Some(_) if low.or(high).is_some() => Kind::TruncatedNormal,
            Some(_) => Kind::Normal,
        };
        let [mean, stddev] = density.of_normal().map_or([None; 2], |numbers| numbers.map(Some));
        Self { distribution, mean, stddev, low, high }
    }

    fn density(&self) -> Result<Density, String> {
        let &Self { distribution, mean, stddev, low, high } = self;
        let given = [("mean", mean), ("stddev", stddev), ("low", low), ("high", high)];
        if let Some((key, value)) = given.iter().find(|(_, v)| v.is_some_and(|v| !v.is_finite())) {
            return Err(format!("{key} = {} must be finite", value.unwrap_or(f64::NAN)));
        }
        let need = |key: &str, value: Option<f64>, of: &str| {
            value.ok_or_else(|| format!("{key} is missing: a {of} distribution needs it"))
        };
        let refuse = |key: &str, value: Option<f64>, of: &str, instead: &str| match value {
            Some(_) => Err(format!("a {of} distribution has no {key}; {instead}")),
            None => Ok(()),
        };
        const TRUNCATED: &str = "use \"truncated-normal\"";
        match distribution {
            Kind::Normal => {
                refuse("low", low, "normal", TRUNCATED)?;
                refuse("high", high, "normal", TRUNCATED)?;
                Density::normal(need("mean", mean, "normal")?, need("stddev", stddev, "normal")?)
            }
            Kind::Uniform => {
                refuse("mean", mean, "uniform", TRUNCATED)?;
                refuse("stddev", stddev, "uniform", TRUNCATED)?;
                Density::uniform(need("low", low, "uniform")?, need("high", high, "uniform")?)
            }
            Kind::TruncatedNormal => {
                const NAME: &str = "truncated-normal";
                if low.is_none() && high.is_none() {
                    return Err("low or high is missing: without both use \"normal\"".to_owned());
                }
                let range = [low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY)];
                Density::truncated(need("mean", mean, NAME)?, need("stddev", stddev, NAME)?, range)
            }
        }
        .map_err(|e| e.to_string())
    }
}
