//! Where a model's forward map is one to one.

use crate::conditions::Conditions;
use crate::error::EmtError;
use crate::structure::{QUANTITIES, Quantity, Structure};

/// Lowest and highest value, both included.
pub type Range = [f64; 2];

/// The structures and states that a model predicts for, and whose prediction it inverts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Name of the model.
    pub model: &'static str,
    /// Range of each quantity that the model predicts from; `None` for those that it does not use.
    pub structure: [Option<Range>; QUANTITIES],
    /// Range of g = γ/Δ.
    pub gamma: Range,
    /// Range of the Poisson ratio of the grains.
    pub poisson_ratio: Range,
    /// Whether the solid fraction must be known.
    pub needs_solid_fraction: bool,
}

impl Domain {
    /// The values of `structure` that the model predicts from, in the order of [`Quantity::ALL`] and zero where it uses
    /// none, if all of them and the state lie inside.
    pub fn take(
        &self,
        structure: &Structure,
        conditions: &Conditions,
    ) -> Result<[f64; QUANTITIES], EmtError> {
        conditions.check()?;
        let mut values = [0.0; QUANTITIES];
        for (i, quantity) in Quantity::ALL.into_iter().enumerate() {
            let Some(range) = self.structure[i] else { continue };
            let missing = EmtError::Missing { model: self.model, missing: quantity.name() };
            values[i] = structure.get(quantity).ok_or(missing)?;
            self.within(quantity.name(), values[i], range)?;
        }
        self.within("gamma/Delta", conditions.gamma.value, self.gamma)?;
        if let Some(material) = &conditions.material {
            self.within("the Poisson ratio of the grains", material.poisson_ratio, self.poisson_ratio)?;
        }
        if self.needs_solid_fraction && conditions.solid_fraction.is_none() {
            return Err(EmtError::Missing { model: self.model, missing: "the solid fraction" });
        }
        Ok(values)
    }

    /// Whether everything of `structure` that the model uses lies inside.
    pub fn contains(&self, structure: &Structure) -> bool {
        structure.values().iter().zip(&self.structure).all(|(value, range)| match (value, range) {
            (Some(v), Some([low, high])) => (*low..=*high).contains(v),
            _ => true,
        })
    }

    fn within(&self, quantity: &'static str, value: f64, [low, high]: Range) -> Result<(), EmtError> {
        // NaN is in no range.
        if (low..=high).contains(&value) {
            return Ok(());
        }
        Err(EmtError::OutsideDomain { model: self.model, quantity, value, low, high })
    }
}
