//! The least squares problem at one coordination number, and what follows from its solution.

use super::state::State;
use crate::calibration::{DeviatorLaw, NetworkState, Outside, RelaxationCalibration, SCATTERED};
use crate::invariants::{INVARIANTS, Invariants};
use crate::moduli::{MODULI, Modulus};
use crate::observation::Observation;
use crate::point_estimate::{Jacobian, PointEstimate};
use crate::probe::ProbeErrors;
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use nalgebra::{Cholesky, SMatrix, SVector};

/// Relative imbalance of the six moduli, and error of it, below which Θ follows from the other five and adds nothing: moduli of
/// four digits, and a hundredth of the scatter of packings.
const NO_ROOM: f64 = 1e-4;

/// Share of the weight of a datum that the others must leave, for a difference from their prediction to be meaningful: they
/// predict nothing where the fit goes through the datum, and the difference is rounding.
const PREDICTED: f64 = 1e-9;

type Square = SMatrix<f64, MODULI, MODULI>;
type Moduli = SVector<f64, MODULI>;
type ByInvariants = SMatrix<f64, MODULI, INVARIANTS>;
type WithFollowing = SMatrix<f64, 2, MODULI>;

/// The moduli used, in units of [`State::unit`]. A modulus that was not measured but follows from the others is left
/// out; if all six are given and Θ follows from the others, Θ is left out. Rows of moduli left out or not known
/// have residual 0 and variance 1.
pub(super) struct Data {
    pub(super) value: Moduli,
    pub(super) covariance: Square,
    pub(super) is_used: [bool; MODULI],
    pub(super) used: usize,
}

impl Data {
    pub(super) fn of(observation: &Observation, state: &State) -> Self {
        let known = observation.moduli.values();
        let no_room = || {
            let errors = observation.covariance.as_ref();
            let stddev = errors.and_then(|c| observation.moduli.imbalance_stddev(c));
            let follows = |imbalance: f64| imbalance.abs() < NO_ROOM || stddev.is_none_or(|s| s < NO_ROOM);
            observation.moduli.imbalance().is_some_and(follows)
        };
        let left_out = observation.derived.or_else(|| no_room().then_some(Modulus::Theta));
        let is_used: [bool; MODULI] =
            std::array::from_fn(|i| known[i].is_some() && left_out != Some(Modulus::ALL[i]));
        let covariance = observation.covariance.unwrap_or_default() / (state.unit * state.unit);
        Self {
            value: SVector::from_fn(|i, _| known[i].map_or(0.0, |m| m / state.unit)),
            covariance: Square::from_fn(
                |i, j| if is_used[i] && is_used[j] { covariance[(i, j)] } else { 0.0 },
            ),
            is_used,
            used: is_used.iter().filter(|u| **u).count(),
        }
    }

    pub(super) fn masked<const N: usize>(&self, mut m: SMatrix<f64, MODULI, N>) -> SMatrix<f64, MODULI, N> {
        for (i, used) in self.is_used.iter().enumerate() {
            if !used {
                m.fill_row(i, 0.0);
            }
        }
        m
    }
}

/// The problem linearised at one z and ε.
pub(super) struct Fit {
    pub(super) z: f64,
    pub(super) eps: f64,
    /// True if ε is fitted; else it is part of the scatter of the packings.
    fits_eps: bool,
    pub(super) chi_square: f64,
    /// χ² + ln det of the covariance: twice the negative logarithm of the likelihood.
    pub(super) objective: f64,
    /// Observed minus predicted.
    residual: Moduli,
    /// Derivatives of the moduli with respect to the invariants, and to (z, ε).
    by_invariants: ByInvariants,
    by_unknowns: SMatrix<f64, MODULI, 2>,
    /// Inverse of the covariance of the residual, and covariance of the unknowns.
    weight: Square,
    unknowns: SMatrix<f64, 2, 2>,
    /// Share of the variances of the residual that is the scatter of packings.
    of_packings: f64,
    /// Covariance of ε weighted by stiffness and of k with the moduli, by the errors of the state.
    with_following: WithFollowing,
}

impl Fit {
    /// At z, with the given ε or, for `None`, the best one; `None` if the covariance is singular.
    pub(super) fn at(
        data: &Data,
        network: &RelaxationCalibration,
        state: &State,
        z: f64,
        eps: Option<f64>,
        fits_eps: bool,
    ) -> Option<Self> {
        let laws = &state.laws;
        let deviators = deviators(network);
        // The moduli are linear in ε.
        let isotropic = state.invariants(network, z, 0.0);
        let by_eps = |slopes: &ByInvariants| by_eps(slopes, network, z, laws);
        let of_inputs = |eps: f64| {
            let uncertain = state.inputs.iter().filter(|input| input.variance > 0.0);
            uncertain
                .map(|input| {
                    let slopes = input.slopes(network, z, eps, &data.value);
                    let moduli = data.masked(slopes.moduli);
                    (
                        moduli * moduli.transpose() * input.variance,
                        slopes.following * moduli.transpose() * input.variance,
                    )
                })
                .fold((Square::zeros(), WithFollowing::zeros()), |(a, b), (c, d)| (a + c, b + d))
        };
        let at_zero = data.masked(isotropic.slopes());
        let covariance = |slopes: &ByInvariants, by_eps: &Moduli, of_inputs: &Square| {
            let scatter = network
                .scatter_in(z, &state.scatter, laws)
                .fixed_view::<INVARIANTS, INVARIANTS>(0, 0)
                .into_owned();
            let of_packings = slopes * scatter * slopes.transpose();
            let mut c = of_packings + data.covariance + of_inputs;
            if !fits_eps {
                let [mean, spread] = network.eps_spread;
                c += by_eps * by_eps.transpose() * (mean * mean + spread * spread);
            }
            for (i, used) in data.is_used.iter().enumerate() {
                if !used {
                    c[(i, i)] = 1.0;
                }
            }
            (c, of_packings)
        };
        let eps = match eps {
            Some(eps) => eps,
            None if fits_eps => {
                let direction = by_eps(&at_zero);
                let (c, _) = covariance(&at_zero, &direction, &of_inputs(0.0).0);
                let weighted = Cholesky::new(c)?.solve(&direction);
                let residual = data.masked(data.value - Moduli::from(isotropic.moduli()));
                weighted.dot(&residual) / weighted.dot(&direction)
            }
            None => 0.0,
        };
        let [dilatation, voigt, harmonic] = deviators.map(|law| law.value(z, eps, laws));
        let invariants = Invariants { dilatation, voigt, harmonic, ..isotropic };
        let by_invariants = data.masked(invariants.slopes());
        let direction = by_eps(&by_invariants);
        let (of_inputs, with_following) = of_inputs(eps);
        let (c, of_packings) = covariance(&by_invariants, &direction, &of_inputs);
        let cholesky = Cholesky::new(c)?;
        let by_z = by_z(&by_invariants, network, [z, eps], laws);
        let mut by_unknowns = SMatrix::<f64, MODULI, 2>::from_columns(&[by_z, direction]);
        let weight = cholesky.inverse();
        if !fits_eps {
            by_unknowns.set_column(1, &Moduli::zeros());
        }
        let mut information = by_unknowns.transpose() * weight * by_unknowns;
        if !fits_eps {
            information[(1, 1)] = 1.0;
        }
        let residual = data.masked(data.value - Moduli::from(invariants.moduli()));
        let chi_square = residual.dot(&(weight * residual));
        let ln_det = 2.0 * cholesky.l().diagonal().map(f64::ln).sum();
        Some(Self {
            z,
            eps,
            fits_eps,
            chi_square,
            objective: chi_square + ln_det,
            residual,
            by_invariants,
            by_unknowns,
            weight,
            of_packings: (weight * of_packings).trace() / data.used as f64,
            with_following,
            unknowns: information.try_inverse()?,
        })
    }

    /// Change of (z, ε) by one Gauss–Newton step.
    pub(super) fn step(&self) -> [f64; 2] {
        let step = self.gain() * self.residual;
        [step[0], step[1]]
    }

    /// Change of (z, ε) per change of the moduli.
    fn gain(&self) -> SMatrix<f64, 2, MODULI> {
        let mut gain = self.unknowns * self.by_unknowns.transpose() * self.weight;
        if !self.fits_eps {
            gain.fill_row(1, 0.0);
        }
        gain
    }

    pub(super) fn eps_stddev(&self) -> f64 {
        self.unknowns[(1, 1)].max(0.0).sqrt()
    }

    /// Number of data minus number of unknowns; `None` if not positive.
    pub(super) fn degrees_of_freedom(&self, data: &Data) -> Option<usize> {
        let unknowns = if self.fits_eps { 2 } else { 1 };
        data.used.checked_sub(unknowns).filter(|d| *d > 0)
    }

    /// Number of degrees of freedom of the estimated variances of the residual (Satterthwaite 1946): the scatter of packings was
    /// learned from a few recipes, the errors of the data are exact.
    pub(super) fn freedom_of_variances(&self, network: &RelaxationCalibration) -> usize {
        let recipes = f64::from(network.recipes.saturating_sub(1).max(1));
        // Beyond some thousands the distribution is that of known variances.
        (recipes / self.of_packings.powi(2)).min(1e4) as usize
    }

    /// The modulus furthest from its prediction by the others, and the difference in standard deviations.
    pub(super) fn worst(&self, data: &Data) -> (Modulus, f64) {
        // A datum left out of the fit differs from its prediction by (W r)_i over the square root of (W C W)_ii.
        let left = self.weight - self.weight * self.by_unknowns * self.gain();
        let pull = left * self.residual;
        let is_predicted = |i: usize| left[(i, i)] > PREDICTED * self.weight[(i, i)];
        let sigma = |i: usize| if is_predicted(i) { pull[i].abs() / left[(i, i)].sqrt() } else { 0.0 };
        let used = (0..MODULI).filter(|i| data.is_used[*i]);
        let worst = used.max_by(|a, b| sigma(*a).total_cmp(&sigma(*b))).unwrap_or(0);
        (Modulus::ALL[worst], sigma(worst))
    }

    /// z and ε; and k and the ε weighted by stiffness, which follow from them and from the residual of the moduli.
    pub(super) fn inferred(
        &self,
        data: &Data,
        network: &RelaxationCalibration,
        state: &State,
    ) -> PointEstimate {
        let (z, eps) = (self.z, self.eps);
        let gain = self.gain();
        let scatter = network.scatter_in(z, &state.scatter, &state.laws);
        let (laws, of_k, of_eps) = (&state.laws, network.rattlers, network.eps_stiffness);
        // Rows: ε weighted by stiffness, k. Columns: z, ε.
        let follows = SMatrix::<f64, 2, 2>::new(
            of_eps.slope(z, eps, laws),
            of_eps.by_eps(z, laws),
            of_k.slope(z, laws),
            0.0,
        );
        // The scatter of these two is correlated with that of the moduli, and so are errors of the state: regression on the residual.
        let with_moduli = scatter.fixed_view::<2, INVARIANTS>(INVARIANTS, 0) * self.by_invariants.transpose()
            + self.with_following;
        let regression = with_moduli * self.weight;
        let residual_gain = SMatrix::<f64, MODULI, MODULI>::identity() - self.by_unknowns * gain;
        let following = follows * gain + regression * residual_gain;
        let beyond = regression * self.residual;
        let known = self.fits_eps;
        let structure = Microstructure {
            k: Some(of_k.value(z, laws) + beyond[1]),
            z: Some(z),
            eps: known.then_some(eps),
            eps_stiffness: known.then_some(of_eps.value(z, eps, laws) + beyond[0]),
            ..Microstructure::default()
        };

        let rows =
            [InferredQuantity::Z, InferredQuantity::Eps, InferredQuantity::EpsStiffness, InferredQuantity::K];
        let mut by_moduli = SMatrix::<f64, 4, MODULI>::zeros();
        by_moduli.fixed_view_mut::<2, MODULI>(0, 0).copy_from(&gain);
        by_moduli.fixed_view_mut::<2, MODULI>(2, 0).copy_from(&following);

        let mut jacobian = Jacobian::zeros();
        for (row, quantity) in rows.into_iter().enumerate() {
            if structure.get(quantity).is_none() {
                continue;
            }
            let of = quantity as usize;
            for i in 0..MODULI {
                jacobian[(of, i)] = by_moduli[(row, i)] * data.value[i];
            }
        }
        for input in &state.inputs {
            // The residual changes with opposite sign.
            let slopes = input.slopes(network, z, eps, &data.value);
            let mut by_input = -by_moduli * data.masked(slopes.moduli);
            by_input[2] += slopes.following[0];
            by_input[3] += slopes.following[1];
            for (row, quantity) in rows.into_iter().enumerate() {
                if structure.get(quantity).is_some() {
                    jacobian[(quantity as usize, input.at)] = by_input[row];
                }
            }
        }

        // Errors from the scatter of the packings: through the moduli, and that of k and of ε weighted by stiffness.
        let mut by_scatter = SMatrix::<f64, 4, SCATTERED>::zeros();
        by_scatter.fixed_view_mut::<4, INVARIANTS>(0, 0).copy_from(&(by_moduli * self.by_invariants));
        by_scatter[(2, INVARIANTS)] = -1.0;
        by_scatter[(3, INVARIANTS + 1)] = -1.0;
        let mut errors = by_scatter * scatter * by_scatter.transpose();
        if !self.fits_eps {
            let [mean, spread] = network.eps_spread;
            let row = by_moduli * by_eps(&self.by_invariants, network, z, laws);
            errors += row * row.transpose() * (mean * mean + spread * spread);
        }
        errors *= self.outside(network).iter().map(Outside::growth).product::<f64>();
        if let Some(ProbeErrors { z, eps, k }) = state.probe.errors() {
            // Sliding lowers z and k together.
            let lowered = SVector::<f64, 4>::new(*z, 0.0, 0.0, *k);
            let turned = SVector::<f64, 4>::new(0.0, *eps, of_eps.by_eps(self.z, laws) * eps, 0.0);
            errors += lowered * lowered.transpose() + turned * turned.transpose();
        }
        let mut discrepancy = MicrostructureCovariance::zeros();
        for (a, qa) in rows.into_iter().enumerate() {
            for (b, qb) in rows.into_iter().enumerate() {
                discrepancy[(qa as usize, qb as usize)] = errors[(a, b)];
            }
        }
        let (jacobian, discrepancy) = (Some(jacobian), Some(discrepancy));
        PointEstimate { jacobian, discrepancy, ..PointEstimate::exact(structure) }
    }

    pub(super) fn outside(&self, network: &RelaxationCalibration) -> Vec<Outside> {
        network.reach.outside_structure(self.z, self.fits_eps.then_some(self.eps))
    }
}

/// Laws of the two deviators and of the harmonic part.
fn deviators(network: &RelaxationCalibration) -> [DeviatorLaw; 3] {
    [network.dilatation, network.voigt, network.harmonic]
}

pub(super) fn by_z(
    slopes: &ByInvariants,
    network: &RelaxationCalibration,
    [z, eps]: [f64; 2],
    laws: &NetworkState,
) -> Moduli {
    let of_deviators =
        (2..).zip(deviators(network)).map(|(i, law)| slopes.column(i) * law.slope(z, eps, laws));
    slopes.column(0) * network.theta.slope(z, laws)
        + slopes.column(1) * network.shear.slope(z, laws)
        + of_deviators.sum::<Moduli>()
}

pub(super) fn by_eps(
    slopes: &ByInvariants,
    network: &RelaxationCalibration,
    z: f64,
    laws: &NetworkState,
) -> Moduli {
    (2..).zip(deviators(network)).map(|(i, law)| slopes.column(i) * law.by_eps(z, laws)).sum()
}
