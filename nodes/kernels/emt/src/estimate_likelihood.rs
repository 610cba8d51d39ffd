//! The likelihood of a model that inverts as many moduli as it has unknowns, and states the error of these unknowns.
//!
//! The error of the inferred structure x̂ is normal about the true one, with the covariance of the estimate. The moduli are
//! then normal, too, to first order about the observed ones: m = m_obs + F (x − x̂), with F the inverse of the derivative of
//! the inversion. With a flat prior the posterior is the estimate.

use crate::error::EmtError;
use crate::estimate::Inversion;
use crate::likelihood::{Likelihood, Predicted, UNIT};
use crate::moduli::{MODULI, Modulus};
use crate::observation::Observation;
use grainlab_core::results::InferredQuantity;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

/// Share of the largest derivative below which an unknown does not depend on a modulus.
const NO_SHARE: f64 = 1e-9;

pub(crate) struct OfEstimate {
    unknowns: Vec<InferredQuantity>,
    moduli: Vec<Modulus>,
    observed: Vec<f64>,
    inferred: DVector<f64>,
    /// F, in units of [`UNIT`].
    slopes: DMatrix<f64>,
    covariance: SMatrix<f64, MODULI, MODULI>,
}

impl OfEstimate {
    pub(crate) fn new(estimate: &Inversion, observation: &Observation) -> Result<Self, EmtError> {
        let without = |reason| EmtError::NoLikelihood { model: estimate.model, reason };
        if estimate.undetermined().next().is_some() {
            return Err(without("they do not determine all its unknowns; give more"));
        }
        let model = estimate.model_covariance.ok_or(without(
            "the calibration has no error of the model; use --calibration grainlab, or one of your own",
        ))?;
        let known = InferredQuantity::ALL.into_iter().filter(|q| estimate.structure.get(*q).is_some());
        let unknowns: Vec<_> = known.collect();
        let row = |q: &InferredQuantity| estimate.jacobian.row(*q as usize).into_owned();
        let largest = unknowns.iter().map(|q| row(q).amax()).fold(0.0, f64::max);
        let is_used = |m: &Modulus| {
            observation.moduli.get(*m).is_some()
                && unknowns.iter().any(|q| row(q)[*m as usize].abs() > NO_SHARE * largest)
        };
        let moduli: Vec<_> = Modulus::ALL.into_iter().filter(is_used).collect();
        let n = unknowns.len();
        if moduli.len() != n {
            return Err(without(
                "it states the error of its unknowns, not of more moduli than unknowns; give fewer",
            ));
        }
        let observed: Vec<f64> = moduli.iter().map(|m| observation.moduli.get(*m).unwrap_or(0.0)).collect();
        // Derivatives of the inversion are per relative change of the moduli.
        let by_moduli =
            DMatrix::from_fn(n, n, |i, j| row(&unknowns[i])[moduli[j] as usize] * UNIT / observed[j]);
        let slopes = by_moduli.try_inverse().ok_or(without("its inversion of them is singular"))?;
        let total = estimate.data_covariance.unwrap_or_default() + model;
        let of_unknowns = DMatrix::from_fn(n, n, |i, j| total[(unknowns[i] as usize, unknowns[j] as usize)]);
        let of_moduli = &slopes * of_unknowns * slopes.transpose();
        let mut covariance = SMatrix::identity();
        for (i, a) in moduli.iter().enumerate() {
            for (j, b) in moduli.iter().enumerate() {
                covariance[(*a as usize, *b as usize)] = of_moduli[(i, j)];
            }
        }
        let values = unknowns.iter().map(|q| estimate.structure.get(*q).unwrap_or(0.0));
        let inferred = DVector::from_iterator(n, values);
        Ok(Self { unknowns, moduli, observed, inferred, slopes, covariance })
    }
}

impl Likelihood for OfEstimate {
    fn unknowns(&self) -> &[InferredQuantity] {
        &self.unknowns
    }

    fn following(&self) -> &[InferredQuantity] {
        &[]
    }

    fn moduli(&self) -> &[Modulus] {
        &self.moduli
    }

    fn observed(&self) -> Vec<f64> {
        self.observed.clone()
    }

    fn at(&self, unknowns: &[f64]) -> Option<Predicted> {
        let off = &self.slopes * (&self.inferred - DVector::from_row_slice(unknowns));
        let mut residual = SVector::zeros();
        for (modulus, off) in self.moduli.iter().zip(off.iter()) {
            residual[*modulus as usize] = *off;
        }
        Predicted::new(residual, self.covariance, self.moduli.len())
    }
}
