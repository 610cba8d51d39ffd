//! The marginal likelihood of a model.

use super::points::{Posterior, REPLICATES};
use crate::error::EmtError;

/// The marginal likelihood of the moduli of an observation: the mean of the likelihood over the prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Natural logarithm of the evidence, for densities of moduli in MPa.
    pub ln: f64,
    /// Standard error of the logarithm, from the integration.
    pub stderr: f64,
}

impl Posterior<'_> {
    /// The evidence. An error if the prior has a density of a quantity that follows from the unknowns: their joint prior is then
    /// not normalised.
    pub fn evidence(&self) -> Result<Evidence, EmtError> {
        if self.target.following.iter().any(Option::is_some) {
            return Err(EmtError::NoLikelihood {
                model: self.target.model,
                reason: "the evidence needs priors of the independent quantities alone; leave out those of k and \
                         eps_stiffness, which follow from z and eps",
            });
        }
        let mut sums = [0.0; REPLICATES];
        for point in &self.points {
            sums[point.replicate] += self.weight(point);
        }
        let each = (self.proposed / REPLICATES) as f64;
        let means = sums.map(|s| s / each);
        let mean = means.iter().sum::<f64>() / REPLICATES as f64;
        let square = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>();
        let stderr = (square / (REPLICATES * (REPLICATES - 1)) as f64).sqrt() / mean;
        Ok(Evidence { ln: mean.ln() + self.highest, stderr })
    }
}
