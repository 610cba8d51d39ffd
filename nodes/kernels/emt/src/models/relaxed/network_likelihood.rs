//! The probability of moduli for a network of given z and ε: the laws, with the scatter of packings and the errors of the data.
//! k and the ε weighted by stiffness follow, with the scatter that is left when the moduli are known.

use super::fit::{Data, by_eps, by_z};
use super::state::State;
use crate::calibration::{Calibration, Outside, RelaxationCalibration};
use crate::error::EmtError;
use crate::invariants::INVARIANTS;
use crate::likelihood::{FOLLOWING, Likelihood, Predicted, UNIT};
use crate::moduli::Modulus;
use crate::observation::Observation;
use grainlab_core::results::InferredQuantity;
use nalgebra::{SVector, Vector2};

pub(super) struct NetworkLikelihood<'a> {
    network: &'a RelaxationCalibration,
    state: State,
    data: Data,
    moduli: Vec<Modulus>,
    observed: Vec<f64>,
}

impl<'a> NetworkLikelihood<'a> {
    /// Likelihood of an observation that was checked; the name of the model is for the error of one without moduli.
    pub(super) fn new(
        model: &'static str,
        observation: &Observation,
        network: &'a RelaxationCalibration,
        calibration: &Calibration,
    ) -> Result<Self, EmtError> {
        let state =
            State::of(&observation.conditions, (observation.grains, observation.probe), network, calibration);
        state.within_reach(calibration.name())?;
        let data = Data::of(observation, &state);
        if data.used == 0 {
            return Err(EmtError::Missing { model, missing: "at least one modulus" });
        }
        let moduli: Vec<_> = Modulus::ALL.into_iter().filter(|m| data.is_used[*m as usize]).collect();
        let observed = moduli.iter().map(|m| data.value[*m as usize] * state.unit).collect();
        Ok(Self { network, state, data, moduli, observed })
    }
}

impl Likelihood for NetworkLikelihood<'_> {
    fn unknowns(&self) -> &[InferredQuantity] {
        &[InferredQuantity::Z, InferredQuantity::Eps]
    }

    fn following(&self) -> &[InferredQuantity] {
        &[InferredQuantity::EpsStiffness, InferredQuantity::K]
    }

    fn moduli(&self) -> &[Modulus] {
        &self.moduli
    }

    fn observed(&self) -> Vec<f64> {
        self.observed.clone()
    }

    fn at(&self, unknowns: &[f64]) -> Option<Predicted> {
        let &[z, eps] = unknowns else { return None };
        let Self { network, state, data, .. } = self;
        let [low, high] = network.domain();
        if !(low..=high).contains(&z) {
            return None;
        }
        let invariants = state.invariants(network, z, eps);
        let stable = |m: &Modulus| invariants.moduli()[*m as usize] > 0.0;
        // As `predict`: where the network would have no stiffness, no packing is.
        if !Modulus::ALL.iter().all(stable) {
            return None;
        }
        let growth: f64 = network.reach.outside_structure(z, Some(eps)).iter().map(Outside::growth).product();
        let scatter = network.scatter_in(z, &state.scatter, &state.laws) * growth;
        let slopes = data.masked(invariants.slopes());
        let mut covariance = slopes * scatter.fixed_view::<INVARIANTS, INVARIANTS>(0, 0) * slopes.transpose()
            + data.covariance;
        let mut with_moduli = scatter.fixed_view::<FOLLOWING, INVARIANTS>(INVARIANTS, 0) * slopes.transpose();
        let mut following = scatter.fixed_view::<FOLLOWING, FOLLOWING>(INVARIANTS, INVARIANTS).into_owned();
        for input in state.inputs.iter().filter(|input| input.variance > 0.0) {
            let by = input.slopes(network, z, eps, &data.value);
            let moduli = data.masked(by.moduli);
            covariance += moduli * moduli.transpose() * input.variance;
            with_moduli += by.following * moduli.transpose() * input.variance;
            following += by.following * by.following.transpose() * input.variance;
        }
        if let Some(errors) = state.probe.errors() {
            let laws = &state.laws;
            // The moduli are those of another z and another ε.
            let by_eps = by_eps(&slopes, network, z, laws) * errors.eps;
            let by_z = by_z(&slopes, network, [z, eps], laws) * errors.z;
            covariance += by_z * by_z.transpose() + by_eps * by_eps.transpose();
            // Sliding lowers z and k together, and k by more than its law gives.
            let beyond = errors.k - network.rattlers.slope(z, laws) * errors.z;
            let mut of_k = with_moduli.row_mut(1);
            of_k -= by_z.transpose() * beyond;
            following[(1, 1)] += beyond * beyond;
        }
        let residual = data.masked(data.value - SVector::from(invariants.moduli()));
        let scale = state.unit / UNIT;
        covariance *= scale * scale;
        for (i, used) in data.is_used.iter().enumerate() {
            if !used {
                covariance[(i, i)] = 1.0;
            }
        }
        let mut predicted = Predicted::new(residual * scale, covariance, self.moduli.len())?;
        with_moduli *= scale;
        let laws = &state.laws;
        let law = Vector2::new(network.eps_stiffness.value(z, eps, laws), network.rattlers.value(z, laws));
        predicted.following = (
            law + with_moduli * predicted.weighted(),
            following - with_moduli * predicted.inverse() * with_moduli.transpose(),
        );
        Some(predicted)
    }
}
