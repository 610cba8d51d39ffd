//! Our model: the moduli of a relaxed contact network, without γ/Δ.
//!
//! The scalars of the stiffness follow the coordination number z, its two deviators follow ε, amplified as the network
//! nears its isostatic point; the harmonic part carries the fourth-order fabric and hardly any ε (see [`Invariants`]). What
//! packings of the same structure still differ by is known as a covariance of those five, so that any set of moduli is
//! weighed by what it is worth: the estimate is the generalised least squares one, which for a linear model is the most
//! probable of all with no prior knowledge of z and ε. k and the ε weighted by contact stiffness follow from z and ε, and
//! from what the moduli still differ by.
//!
//! The constants come from packings ([`crate::calibration`]); only the form is derived.

mod fit;
mod scan;

use crate::calibration::{Calibration, Network};
use crate::conditions::Conditions;
use crate::domain::Domain;
use crate::error::EmtError;
use crate::invariants::Invariants;
use crate::model::{Misfit, Model, Solution};
use crate::moduli::{Moduli, Modulus};
use crate::observation::Observation;
use crate::structure::{QUANTITIES, Quantity, Structure};
use crate::warning::Warning;
use fit::{Data, Fit};

/// The relaxed network: model `relaxed`.
#[derive(Clone, Copy, Debug)]
pub struct Relaxed;

const NAME: &str = "relaxed";

/// Beyond this standard deviation of ε the data do not determine it: it is more than any packing has.
const UNDETERMINED: f64 = 0.2;

impl Model for Relaxed {
    fn name(&self) -> &'static str {
        NAME
    }

    fn uses_gamma(&self) -> bool {
        false
    }

    fn domain(&self, calibration: &Calibration) -> Domain {
        let mut structure = [None; QUANTITIES];
        if let Some(network) = calibration.network() {
            structure[Quantity::Z as usize] = Some(network.domain());
            structure[Quantity::Eps as usize] = Some(network.domain_of_eps());
        }
        Domain {
            model: NAME,
            structure,
            gamma: [-1.0, 1.0],
            poisson_ratio: [0.0, 0.5],
            needs_solid_fraction: false,
        }
    }

    fn predict(
        &self,
        structure: &Structure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let network = network(calibration)?;
        let found = self.domain(calibration).take(structure, conditions)?;
        let [z, eps] = [Quantity::Z, Quantity::Eps].map(|q| found[q as usize]);
        let state = State::of(conditions, None, network, calibration);
        let moduli = state.invariants(network, z, eps).moduli().map(|m| m * state.unit);
        for (modulus, value) in Modulus::ALL.into_iter().zip(moduli) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(EmtError::Unstable { modulus: modulus.name(), value });
            }
        }
        Ok(Moduli::of_values(moduli.map(Some)))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<Solution, EmtError> {
        let network = network(calibration)?;
        let state = State::of(&observation.conditions, observation.grains, network, calibration);
        let data = Data::of(observation, &state);
        if data.used == 0 {
            return Err(EmtError::Missing { model: NAME, missing: "any modulus" });
        }
        let both = (data.used > 1).then(|| scan::best(&data, network, &state, calibration.name(), false));
        let fit = match both {
            Some(Ok(fit)) if fit.eps_stddev() < UNDETERMINED => fit,
            Some(Err(error)) if data.used > 2 => return Err(error),
            // The coordination alone, whatever ε packings have.
            _ => scan::best(&data, network, &state, calibration.name(), true)?,
        };
        Ok(solution(&fit, &data, network, &state))
    }
}

fn network(calibration: &Calibration) -> Result<&Network, EmtError> {
    let missing = || EmtError::NotCalibrated { model: NAME, calibration: calibration.name().to_owned() };
    calibration.network().ok_or_else(missing)
}

/// The state of a sample in the units of the network's laws.
#[derive(Clone, Copy, Debug)]
struct State {
    /// E*^⅔ p^⅓, Pa.
    unit: f64,
    /// ln(φ/φ0), and its standard deviation.
    ln_phi: [f64; 2],
    /// ln of p/E* over that of the calibration's reference.
    ln_p: f64,
    /// Whether φ was given.
    phi_known: bool,
    /// How much wider than those of the calibration samples of this size scatter, as a variance.
    wider: f64,
}

impl State {
    fn of(
        conditions: &Conditions,
        grains: Option<u32>,
        network: &Network,
        calibration: &Calibration,
    ) -> Self {
        let own = calibration.material();
        let young = conditions.material.as_ref().unwrap_or(own).effective_young();
        let pressure = conditions.pressure.value;
        let [mean, spread] = network.solid_fraction;
        let ln_phi = match conditions.solid_fraction {
            Some(phi) => [(phi.value / mean).ln(), phi.stddev / phi.value],
            None => [0.0, spread / mean],
        };
        Self {
            unit: young.cbrt().powi(2) * pressure.cbrt(),
            ln_phi,
            ln_p: (pressure / network.pressure * (own.effective_young() / young)).ln(),
            phi_known: conditions.solid_fraction.is_some(),
            wider: network.wider(grains),
        }
    }

    fn invariants(&self, network: &Network, z: f64, eps: f64) -> Invariants {
        Invariants {
            ln_theta: network.theta.value(z, self.ln_phi[0], self.ln_p),
            ln_shear: network.shear.value(z, self.ln_phi[0], self.ln_p),
            dilatation: network.dilatation.value(z) * eps,
            voigt: network.voigt.value(z) * eps,
            harmonic: network.harmonic.value(z) * eps,
        }
    }
}

fn solution(fit: &Fit, data: &Data, network: &Network, state: &State) -> Solution {
    let mut warnings = Vec::new();
    if !state.phi_known {
        warnings.push(Warning::SolidFractionAssumed { phi: network.solid_fraction[0] });
    }
    let phi = state.ln_phi[0].exp() * network.solid_fraction[0];
    let [loosest, densest] = network.solid_fractions;
    // A hair's breadth: φ went through a logarithm.
    if !(loosest - 1e-9..=densest + 1e-9).contains(&phi) {
        warnings.push(Warning::SolidFractionOutsideFit { phi, range: network.solid_fractions });
    }
    if !(network.z[0]..=network.z[1]).contains(&fit.z) {
        warnings.push(Warning::CoordinationOutsideFit {
            quantity: Quantity::Z,
            value: fit.z,
            range: network.z,
        });
    }
    let eps = fit.eps();
    if let Some(eps) = eps.filter(|eps| !(network.eps[0]..=network.eps[1]).contains(eps)) {
        warnings.push(Warning::EpsOutsideFit { eps, range: network.eps });
    }
    let misfit = fit
        .degrees_of_freedom(data)
        .map(|degrees_of_freedom| Misfit { chi_square: fit.chi_square, degrees_of_freedom });
    if let Some(Misfit { chi_square, degrees_of_freedom }) = misfit
        && chi_square > one_in_a_thousand(degrees_of_freedom)
    {
        let worst = fit.worst(data);
        warnings.push(Warning::Conflict { chi_square, degrees_of_freedom, worst });
    }
    let inferred = fit.inferred(data, network, state);
    Solution {
        structure: inferred.structure,
        slopes: Some(inferred.slopes),
        discrepancy: Some(inferred.discrepancy),
        misfit,
        warnings,
    }
}

/// Value of χ² that chance exceeds once in a thousand.
fn one_in_a_thousand(degrees_of_freedom: usize) -> f64 {
    [10.83, 13.82, 16.27, 18.47][degrees_of_freedom.clamp(1, 4) - 1]
}
