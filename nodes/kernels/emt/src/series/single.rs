//! Structure of a sample at one pressure, with the joint error of its quantities.

use super::component::Mixture;
use super::draws::SeriesDraw;
use super::estimate::{FEWEST, HIGHEST_Z, Interval, SEED};
use super::forward::Forward;
use super::prior::SeriesPrior;
use super::sample::SpeedSeries;
use crate::calibration::RelaxationCalibration;
use crate::error::EmtError;
use nalgebra::{SMatrix, SVector};

/// Quantities: z, ε, and ε weighted by contact stiffness.
pub(crate) const QUANTITIES: usize = 3;

/// The structure at the only pressure of a series.
pub(crate) struct SingleEstimate {
    /// Marginal distributions of z, ε and ε weighted by stiffness; the last two hold where the speeds have directions.
    pub(crate) marginals: [Interval; QUANTITIES],
    pub(crate) covariance: SMatrix<f64, QUANTITIES, QUANTITIES>,
    pub(crate) has_eps: bool,
    /// Probability of a z beyond those that are stated.
    pub(crate) z_beyond: f64,
    /// Probability of a z below the lowest of the calibration's packings.
    pub(crate) z_below: f64,
    /// ln of the moduli over those of the contact law.
    pub(crate) level: Interval,
    /// k_t/k_n of the contacts.
    pub(crate) stiffness_ratio: Interval,
    /// Probability of less probable data, under all that was assumed.
    pub(crate) p: f64,
}

impl SingleEstimate {
    pub(crate) fn of(
        series: &SpeedSeries,
        network: &RelaxationCalibration,
        prior: &SeriesPrior,
    ) -> Result<Self, EmtError> {
        series.check()?;
        let mixture = Mixture::of(Forward::new(series, network, prior), series.ln_crossover);
        if mixture.solutions.is_empty() {
            return Err(EmtError::NotFinite { quantity: "likelihood of the moduli", value: f64::NAN });
        }
        let (draws, effective) = mixture.draws(SEED);
        if effective < FEWEST {
            return Err(EmtError::NotSampled {
                model: "free-contact",
                reason: "the moduli are far from those of any contacts between these grains; check pressure, material, density and \
                         units",
            });
        }
        let first = |all: &[f64]| all.first().copied().unwrap_or(0.0);
        let values = |d: &SeriesDraw| {
            SVector::from([first(&d.z).min(HIGHEST_Z), first(&d.eps), first(&d.eps_stiffness)])
        };
        let before = mixture.of_prior(SEED);
        let both = |of: &dyn Fn(&SeriesDraw) -> f64| {
            let spread = |all: &[SeriesDraw]| Interval::of(all.iter().map(|d| (of(d), d.weight)));
            Interval { prior_stddev: spread(&before).stddev, ..spread(&draws) }
        };
        let marginals = std::array::from_fn(|i| both(&|d| values(d)[i]));
        let mean = SVector::from(marginals.each_ref().map(|m| m.mean));
        let probability = |of: &dyn Fn(f64) -> bool| {
            draws.iter().filter(|d| of(first(&d.z))).fold(0.0, |sum, d| sum + d.weight)
        };
        let off = draws.iter().map(|d| (values(d) - mean, d.weight));
        Ok(Self {
            marginals,
            covariance: off.map(|(v, w)| v * v.transpose() * w).sum(),
            has_eps: series.has_directions(),
            z_beyond: probability(&|z| z > HIGHEST_Z),
            z_below: probability(&|z| z < network.reach.z[0]),
            level: both(&|d| d.level),
            stiffness_ratio: both(&|d| d.stiffness_ratio),
            p: mixture.contradiction(SEED),
        })
    }
}
