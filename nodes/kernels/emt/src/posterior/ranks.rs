//! Ranks of true values among the draws: uniform if they are as other draws are.

use crate::normal;

/// Ranks of true values among independent draws: uniform where the posterior is right.
#[derive(Clone, Debug, PartialEq)]
pub struct RankHistogram {
    counts: Vec<u64>,
}

impl RankHistogram {
    /// Without ranks; with so many bins.
    pub fn new(bins: usize) -> Self {
        Self { counts: vec![0; bins.max(2)] }
    }

    /// Adds a rank, as the share of draws below the true value, 0 to 1.
    pub fn add(&mut self, share: f64) {
        let bins = self.counts.len();
        let bin = ((share * bins as f64) as usize).min(bins - 1);
        self.counts[bin] += 1;
    }

    /// Number of ranks in each bin.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// χ² of uniform ranks, and the probability of a larger one by chance.
    pub fn uniformity(&self) -> (f64, f64) {
        let total: u64 = self.counts.iter().sum();
        let expected = total as f64 / self.counts.len() as f64;
        if total == 0 {
            return (0.0, 1.0);
        }
        let chi_square = self.counts.iter().map(|c| (*c as f64 - expected).powi(2) / expected).sum();
        (chi_square, normal::chi_square_above(chi_square, self.counts.len() - 1))
    }
}
