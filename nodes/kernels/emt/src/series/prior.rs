//! Prior knowledge of a sample, before its speeds: z over pressure by preparation, the contact, and the noise.

use super::gain::ContactKind;
use crate::error::EmtError;
use grainlab_core::Material;
use grainlab_core::contact::SpringLaw;
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// z over pressure of one preparation: z + slope log10 P + rise (P^0.3 − 1), P = p/E* / 1e-6, to .01 to .02 in packings of the
/// campaign `preparations`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreparationPrior {
    /// Name of the preparation.
    pub name: String,
    /// Probability, in any unit.
    pub weight: f64,
    /// z at p/E* = 1e-6: mean and standard deviation.
    pub z: [f64; 2],
    /// Change of z per decade of pressure.
    pub slope: [f64; 2],
    /// Factor of P^0.3 − 1.
    pub rise: [f64; 2],
    /// ln of the bulk and of the shear modulus over those of the laws: dense packings of one z are stiffer than loose ones.
    #[serde(default)]
    pub moduli: [f64; 2],
}

/// A family of contact laws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactPrior {
    /// Family of the law.
    pub law: ContactKind,
    /// Probability, in any unit.
    pub weight: f64,
    /// Range of the crossover pressure, Pa, uniform in its logarithm; none for a law without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crossover: Option<[f64; 2]>,
}

/// The prior of a series.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeriesPrior {
    /// Lowest k_t/k_n; the highest is Mindlin's.
    pub lowest_stiffness_ratio: f64,
    /// Probability that k_t/k_n is Mindlin's; else it is uniform from the lowest to it.
    pub mindlin: f64,
    /// Standard deviation of ln of the level of the moduli: contact stiffness.
    pub level: f64,
    /// Standard deviation of a trend of ln of both moduli per decade of pressure: no contact law is exact.
    pub trend: f64,
    /// 95 % interval of the noise over the stated errors of the speeds.
    pub noise: [f64; 2],
    /// ε of the sample: mean and standard deviation.
    pub eps: [f64; 2],
    /// Standard deviation of ε at each pressure about that of the sample.
    pub eps_own: f64,
    /// Standard deviation of z at each pressure about that of the preparation.
    pub z_own: f64,
    /// Families of contact laws.
    pub contact: Vec<ContactPrior>,
    /// Preparations of the sample.
    pub preparation: Vec<PreparationPrior>,
    /// k_t/k_n of contacts that are known.
    #[serde(skip)]
    pub(super) known_ratio: Option<f64>,
    /// d ln(k_t/k_n) per decade of pressure, fixed.
    #[serde(skip)]
    pub(super) drift: f64,
    /// Slope of z instead of those of the preparations.
    #[serde(skip)]
    pub(super) other_slope: Option<[f64; 2]>,
    /// True for z of the bulk modulus and of the shear modulus apart.
    #[serde(skip)]
    pub(super) is_split: bool,
}

/// A normal distribution that stands for one cell of a uniform one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub(super) mean: f64,
    pub(super) stddev: f64,
    pub(super) weight: f64,
}

impl Cell {
    /// So many cells from `low` to `high`: normal distributions of half a cell's width, whose mixture is uniform to 1.4 %.
    fn uniform(low: f64, high: f64, count: usize, weight: f64) -> Vec<Cell> {
        let width = (high - low) / count as f64;
        let of = |n: usize| Cell {
            mean: low + width * (n as f64 + 0.5),
            stddev: 0.5 * width,
            weight: weight / count as f64,
        };
        (0..count).map(of).collect()
    }
}

/// Number of cells of k_t/k_n, and of the noise.
const RATIO_CELLS: usize = 4;
pub(super) const NOISES: usize = 9;

/// Width of the cells of ln p_r: 1.75 natural units.
const CROSSOVER_WIDTH: f64 = 1.75;

/// Standard deviation of k_t/k_n about Mindlin's.
const AT_MINDLIN: f64 = 0.01;

/// Standard deviation of a k_t/k_n that is known, and of ln of a level of which nothing is.
const KNOWN: f64 = 1e-3;
const ANY_LEVEL: f64 = 10.0;

/// Mean and standard deviation in place of ln p_r where the law has none.
const NO_CROSSOVER: Cell = Cell { mean: 0.0, stddev: 1.0, weight: 1.0 };

impl SeriesPrior {
    /// The prior that the repository's campaign `preparations` gives.
    pub fn builtin() -> &'static Self {
        static BUILTIN: OnceLock<SeriesPrior> = OnceLock::new();
        BUILTIN.get_or_init(|| match Self::parse(include_str!("prior.toml")) {
            Ok(prior) => prior,
            Err(e) => unreachable!("the built-in prior of a series: {e}"),
        })
    }

    /// Reads the text of a prior file.
    ///
    /// # Errors
    /// A fault of the text, with its line, or a number out of its range.
    pub fn parse(text: &str) -> Result<Self, EmtError> {
        let prior: Self = toml::from_str(text).map_err(|e| EmtError::SeriesPrior { fault: e.to_string() })?;
        prior.check()?;
        Ok(prior)
    }

    /// The text of a prior file.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// The prior with one family of contact laws.
    #[must_use]
    pub fn of_law(&self, law: ContactKind) -> Self {
        let mut prior = self.clone();
        prior.contact.retain(|c| c.law == law);
        if prior.contact.is_empty() {
            prior.contact.push(ContactPrior { law, weight: 1.0, crossover: None });
        }
        // Spheres of this material have no other stiffness, and linear springs have any.
        match law {
            ContactKind::Hertz => (prior.mindlin, prior.level, prior.trend) = (1.0, 0.0, 0.0),
            ContactKind::Rough => (prior.level, prior.trend) = (0.0, 0.0),
            ContactKind::Linear => (prior.level, prior.trend) = (ANY_LEVEL, 0.0),
            ContactKind::Blunt => {}
        }
        prior
    }

    pub(crate) fn known_ratio(&self) -> Option<f64> {
        self.known_ratio
    }

    /// The prior of contacts of this law, whose k_t/k_n is exact, between grains of this material.
    #[must_use]
    pub fn of_springs(&self, springs: &SpringLaw, material: &Material) -> Self {
        let ratio = material.stiffness_ratio();
        let (law, known) = match springs {
            SpringLaw::HertzMindlin => (ContactKind::Hertz, ratio),
            SpringLaw::Linear(l) => (ContactKind::Linear, l.stiffness_ratio),
            SpringLaw::Rough(r) => {
                let kind = if r.roughness > 0.0 { ContactKind::Rough } else { ContactKind::Hertz };
                (kind, r.tangential_factor * ratio)
            }
        };
        Self { known_ratio: Some(known), ..self.of_law(law) }
    }

    fn check(&self) -> Result<(), EmtError> {
        let fault = |fault: String| Err(EmtError::SeriesPrior { fault });
        let spreads = self.preparation.iter().flat_map(|p| [p.z, p.slope, p.rise]).chain([self.eps]);
        for [mean, stddev] in spreads {
            if !(mean.is_finite() && stddev >= 0.0 && stddev.is_finite()) {
                return fault(format!("[{mean}, {stddev}] must be a mean and a standard deviation"));
            }
        }
        for (name, value) in
            [("level", self.level), ("trend", self.trend), ("eps_own", self.eps_own), ("z_own", self.z_own)]
        {
            if !(value >= 0.0 && value.is_finite()) {
                return fault(format!("{name} = {value} must not be negative"));
            }
        }
        let weights = self.preparation.iter().map(|p| p.weight).chain(self.contact.iter().map(|c| c.weight));
        if let Some(weight) = weights.into_iter().find(|w| !(*w > 0.0 && w.is_finite())) {
            return fault(format!("weight = {weight} must be positive"));
        }
        for p in &self.preparation {
            if !(4.05..7.0).contains(&p.z[0]) {
                return fault(format!("preparation {}: z = {} must be from 4.05 to 7", p.name, p.z[0]));
            }
        }
        for c in &self.contact {
            match c.crossover {
                Some([low, high]) if c.law.has_crossover() && low > 0.0 && low < high && high.is_finite() => {
                }
                None if !c.law.has_crossover() => {}
                _ => {
                    return fault(format!(
                        "contact {}: crossover must be a range of pressures for rough and blunt, else absent",
                        c.law
                    ));
                }
            }
        }
        let [low, high] = self.noise;
        match () {
            () if self.preparation.is_empty() || self.contact.is_empty() => {
                fault("it needs a [[preparation]] and a [[contact]]".to_owned())
            }
            () if !(low > 0.0 && low < high && high.is_finite()) => {
                fault(format!("noise = [{low}, {high}] must be a range"))
            }
            () if !(0.0..=1.0).contains(&self.mindlin) => {
                fault(format!("mindlin = {} must be a probability", self.mindlin))
            }
            () if !(self.lowest_stiffness_ratio > 0.0 && self.lowest_stiffness_ratio < 1.0) => fault(
                format!("lowest_stiffness_ratio = {} must be between 0 and 1", self.lowest_stiffness_ratio),
            ),
            () => Ok(()),
        }
    }

    /// Cells of k_t/k_n below that of Mindlin's contacts, and Mindlin's.
    pub(super) fn stiffness_ratios(&self, mindlin: f64) -> Vec<Cell> {
        if let Some(mean) = self.known_ratio {
            return vec![Cell { mean, stddev: KNOWN, weight: 1.0 }];
        }
        let low = self.lowest_stiffness_ratio.min(mindlin - AT_MINDLIN);
        let mut cells = match self.mindlin {
            all if all >= 1.0 => Vec::new(),
            some => Cell::uniform(low, mindlin, RATIO_CELLS, 1.0 - some),
        };
        if self.mindlin > 0.0 {
            cells.push(Cell { mean: mindlin - AT_MINDLIN, stddev: AT_MINDLIN, weight: self.mindlin });
        }
        cells
    }

    /// Cells of ln p_r of a family; `known` is that of rough grains of known roughness.
    pub(super) fn crossovers(contact: &ContactPrior, known: Option<[f64; 2]>) -> Vec<Cell> {
        match (contact.law, known, contact.crossover) {
            (ContactKind::Rough, Some([mean, stddev]), _) => vec![Cell { mean, stddev, weight: 1.0 }],
            (_, _, Some([low, high])) => {
                let count = ((high / low).ln() / CROSSOVER_WIDTH).round().max(1.0) as usize;
                Cell::uniform(low.ln(), high.ln(), count, 1.0)
            }
            _ => vec![NO_CROSSOVER],
        }
    }

    /// Factors of the stated errors with their probabilities: a log-normal distribution.
    pub(super) fn noises(&self) -> [[f64; 2]; NOISES] {
        let [low, high] = self.noise.map(f64::ln);
        let mut all = std::array::from_fn(|n| {
            let ln = low + (high - low) * n as f64 / (NOISES - 1) as f64;
            let score = (ln - 0.5 * (low + high)) / ((high - low) / 3.92);
            [ln.exp(), (-0.5 * score * score).exp()]
        });
        let sum: f64 = all.iter().map(|[_, w]| w).sum();
        all.iter_mut().for_each(|[_, w]| *w /= sum);
        all
    }
}
