//! Sizes of the grains: from a distribution, the same for every seed.
//!
//! The i-th of n grains has the diameter below which a fraction 1 − (i + ½)/n of the distribution lies. A
//! packing of a few hundred grains then already has the moments of the distribution. Grains are placed from
//! the largest to the smallest.

/// Standard deviations at which a lognormal distribution is cut.
pub(crate) const CUT: f64 = 3.0;

/// Diameters of the grains.
#[derive(Clone, Debug, PartialEq)]
pub enum Sizes {
    /// All of one diameter, m.
    Equal(f64),
    /// A uniform distribution between two diameters, m.
    Uniform {
        /// Smallest diameter, m.
        min: f64,
        /// Largest diameter, m.
        max: f64,
    },
    /// The logarithm of the diameter is normal, cut at three standard deviations.
    Lognormal {
        /// Median diameter, m.
        median: f64,
        /// Standard deviation of the logarithm.
        spread: f64,
    },
    /// Several diameters, each with its share.
    Mixture(Vec<Species>),
    /// Those of the packing that the run starts from.
    OfPacking {
        /// Mean diameter, m.
        mean: f64,
    },
}

/// Grains of one diameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Species {
    /// Diameter of the grains, m.
    pub diameter: f64,
    /// Fraction of the grains, by number; the sum is 1.
    pub share: f64,
}

impl Sizes {
    /// Diameters of `count` grains, m, from the largest to the smallest. Empty for those of a packing.
    pub fn diameters(&self, count: u32) -> Vec<f64> {
        let n = f64::from(count);
        let quantiles = (0..count).map(|i| 1.0 - (f64::from(i) + 0.5) / n);
        match self {
            Self::Equal(diameter) => vec![*diameter; count as usize],
            Self::Uniform { min, max } => quantiles.map(|q| min + q * (max - min)).collect(),
            Self::Lognormal { median, spread } => {
                quantiles.map(|q| median * libm::exp(spread * cut_normal(q))).collect()
            }
            Self::Mixture(species) => {
                let mut sorted = species.clone();
                sorted.sort_by(|a, b| b.diameter.total_cmp(&a.diameter));
                let (mut diameters, mut share) = (Vec::with_capacity(count as usize), 0.0);
                for kind in &sorted {
                    share += kind.share;
                    diameters.resize((share * n).round().min(n) as usize, kind.diameter);
                }
                // The sum of the fractions is 1 up to rounding.
                diameters.resize(count as usize, sorted.last().map_or(0.0, |kind| kind.diameter));
                diameters
            }
            Self::OfPacking { .. } => Vec::new(),
        }
    }

    /// Mean diameter of the distribution, m.
    pub fn mean(&self) -> f64 {
        match self {
            Self::Equal(diameter) => *diameter,
            Self::Uniform { min, max } => 0.5 * (min + max),
            // Mean of the distribution that is not cut: the difference is negligible.
            Self::Lognormal { median, spread } => median * libm::exp(0.5 * spread * spread),
            Self::Mixture(species) => species.iter().map(|s| s.share * s.diameter).sum(),
            Self::OfPacking { mean } => *mean,
        }
    }

    /// Largest diameter over smallest.
    pub fn ratio(&self) -> f64 {
        match self {
            Self::Equal(_) | Self::OfPacking { .. } => 1.0,
            Self::Uniform { min, max } => max / min,
            Self::Lognormal { spread, .. } => libm::exp(2.0 * CUT * spread),
            Self::Mixture(species) => {
                let diameters = species.iter().map(|s| s.diameter);
                diameters.clone().fold(0.0, f64::max) / diameters.fold(f64::INFINITY, f64::min)
            }
        }
    }
}

/// The quantile of the standard normal distribution cut at [`CUT`] on both sides, by bisection.
fn cut_normal(share: f64) -> f64 {
    let below = |z: f64| 0.5 * libm::erfc(-z / std::f64::consts::SQRT_2);
    let wanted = below(-CUT) + share * (below(CUT) - below(-CUT));
    let (mut low, mut high) = (-CUT, CUT);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if below(middle) < wanted { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_has_its_moments_at_a_few_hundred_grains() {
        let moments = |sizes: &Sizes| {
            let logs: Vec<f64> = sizes.diameters(400).iter().map(|d| (d / 2e-4).ln()).collect();
            let mean = logs.iter().sum::<f64>() / 400.0;
            (mean, (logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / 400.0).sqrt())
        };
        let (mean, spread) = moments(&Sizes::Lognormal { median: 2e-4, spread: 0.2 });
        // A normal distribution cut at three standard deviations has 0.9866 of its standard deviation.
        assert!(mean.abs() < 1e-9 && (spread / 0.2 - 0.9866).abs() < 2e-3, "{mean} {spread}");
        let uniform = Sizes::Uniform { min: 1e-4, max: 3e-4 }.diameters(400);
        assert!((uniform.iter().sum::<f64>() / 400.0 - 2e-4).abs() < 1e-18);
        assert!(uniform.windows(2).all(|w| w[0] > w[1]) && uniform[0] < 3e-4 && uniform[399] > 1e-4);
    }

    #[test]
    fn a_mixture_has_its_shares_at_any_number_of_grains() {
        let species = |diameter, share| Species { diameter, share };
        let sizes = Sizes::Mixture(vec![species(1e-4, 0.3), species(2e-4, 0.7)]);
        for count in [1, 10, 333, 1000] {
            let diameters = sizes.diameters(count);
            let large = diameters.iter().filter(|d| **d == 2e-4).count();
            assert_eq!((diameters.len(), large), (count as usize, (0.7 * f64::from(count)).round() as usize));
        }
        assert!((sizes.mean() - 1.7e-4).abs() < 1e-18 && sizes.ratio() == 2.0);
    }

    #[test]
    fn half_of_a_symmetric_law_lies_below_its_middle() {
        assert!(cut_normal(0.5).abs() < 1e-12);
        assert!((cut_normal(0.9) + cut_normal(0.1)).abs() < 1e-12);
        // It is 1.2816 for the whole distribution.
        assert!((cut_normal(0.9) - 1.2754).abs() < 1e-3, "{}", cut_normal(0.9));
    }
}
