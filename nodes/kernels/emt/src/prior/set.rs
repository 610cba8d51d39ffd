//! The priors of the quantities of a model.

use super::density::Density;
use crate::domain::Domain;
use crate::error::EmtError;
use grainlab_core::results::InferredQuantity;

/// Independent priors of some quantities.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prior([Option<Density>; InferredQuantity::COUNT]);

impl Prior {
    /// Prior with this density of a quantity, too.
    #[must_use]
    pub fn with(mut self, quantity: InferredQuantity, density: Density) -> Self {
        self.0[quantity as usize] = Some(density);
        self
    }

    /// Prior of these quantities alone.
    #[must_use]
    pub fn only(&self, quantities: &[InferredQuantity]) -> Self {
        let mut kept = self.clone();
        for quantity in InferredQuantity::ALL.into_iter().filter(|q| !quantities.contains(q)) {
            kept.0[quantity as usize] = None;
        }
        kept
    }

    /// The density of a quantity; `None` if it has none.
    pub fn get(&self, quantity: InferredQuantity) -> Option<&Density> {
        self.0[quantity as usize].as_ref()
    }

    /// The quantities with a density.
    pub fn quantities(&self) -> impl Iterator<Item = InferredQuantity> + '_ {
        InferredQuantity::ALL.into_iter().filter(|q| self.get(*q).is_some())
    }

    /// The prior of a model without any other: uniform over its domain.
    pub fn uniform(domain: &Domain) -> Self {
        let density = |range: Option<[f64; 2]>| Density::uniform(range?[0], range?[1]).ok();
        Self(domain.structure.map(density))
    }

    /// The prior of a model: each density within the domain, and uniform over it for the quantities without one. Densities of
    /// quantities that the domain does not limit stay as they are.
    pub fn completed(&self, domain: &Domain) -> Result<Self, EmtError> {
        let mut all = Self::uniform(domain);
        for quantity in self.quantities() {
            let (i, model) = (quantity as usize, domain.model);
            let Some(density) = self.0[i] else { continue };
            let Some([low, high]) = domain.structure[i] else {
                all.0[i] = Some(density);
                continue;
            };
            let excluded = EmtError::PriorOutsideDomain { model, quantity: quantity.name(), low, high };
            all.0[i] = Some(density.within([low, high]).ok_or(excluded)?);
        }
        Ok(all)
    }
}
