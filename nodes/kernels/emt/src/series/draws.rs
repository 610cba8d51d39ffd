//! Draws from the posterior of a series: those of the normal approximations, weighted to those of the model.

use super::component::{Component, Mixture, Solution, normalised};
use super::forward::Forward;
use super::gain::ContactKind;
use crate::random::Random;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Number of draws of a round: quantiles of 95 % to a twentieth of the standard deviation.
const DRAWS: usize = 4000;

/// Most rounds, and the effective number of draws that ends them.
const ROUNDS: usize = 5;
const ENOUGH: f64 = 400.0;

/// Variance of the errors in the wider half of the proposals.
const WIDER: f64 = 3.0;

/// The linear problem with larger errors.
struct Wide {
    inverse: DMatrix<f64>,
    ln_evidence: f64,
}

impl Wide {
    fn of(of: &Solution, m: usize) -> Option<Self> {
        let l = of.unexplained.l();
        let all = of.at.by_unknowns.rows(0, m) * &of.gain + &l * l.transpose() * WIDER;
        let cholesky = Cholesky::new(all)?;
        let ln_evidence = ln_normal(&of.residual, &cholesky) - m as f64 * crate::normal::LN_SQRT_TAU;
        Some(Self { inverse: cholesky.inverse(), ln_evidence })
    }
}

/// One structure of the sample over pressure, with its contact.
#[derive(Clone, Debug)]
pub(super) struct SeriesDraw {
    /// Probability of this draw.
    pub(super) weight: f64,
    pub(super) kind: ContactKind,
    pub(super) preparation: usize,
    pub(super) noise: f64,
    /// At each pressure; empty for ε without directions.
    pub(super) z: Vec<f64>,
    pub(super) eps: Vec<f64>,
    pub(super) eps_stiffness: Vec<f64>,
    pub(super) stiffness_ratio: f64,
    pub(super) ln_crossover: f64,
    /// ln of the moduli over those of the law with the given material.
    pub(super) level: f64,
    /// ln of the speeds of the rows without one.
    pub(super) predicted: Vec<f64>,
    /// z of the bulk modulus less that of the shear modulus, at each pressure.
    pub(super) bulk_less_shear: Vec<f64>,
}

/// ln of the normal density but for its constant.
fn ln_normal(off: &DVector<f64>, cholesky: &Cholesky<f64, Dyn>) -> f64 {
    let ln_det: f64 = cholesky.l_dirty().diagonal().map(f64::ln).sum();
    -0.5 * off.dot(&cholesky.solve(off)) - ln_det
}

/// ln of the mean of numbers, from their logarithms.
fn mean_ln(ln: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
    let highest = ln.clone().fold(f64::NEG_INFINITY, f64::max);
    let count = ln.len() as f64;
    highest + (ln.map(|l| (l - highest).exp()).sum::<f64>() / count).ln()
}

pub(super) fn normal(random: &mut Random, n: usize) -> DVector<f64> {
    DVector::from_fn(n, |_, _| random.normal::<1>()[0])
}

/// So many copies of each place, in proportion to the weights.
fn places(weights: &[f64], random: &mut Random) -> Vec<usize> {
    let start = random.uniform();
    let mut sum = 0.0;
    let mut found = Vec::with_capacity(DRAWS);
    for (place, weight) in weights.iter().enumerate() {
        sum += weight * DRAWS as f64;
        while (found.len() as f64) + start < sum {
            found.push(place);
        }
    }
    found
}

impl Mixture<'_> {
    /// Draws from the posterior, and their effective number.
    pub(super) fn draws(&self, seed: u64) -> (Vec<SeriesDraw>, f64) {
        let mut random = Random::new(seed);
        let mut wide: Vec<Option<Wide>> = self.solutions.iter().map(|_| None).collect();
        let mut of = |place: usize, random: &mut Random| {
            let solution = &self.solutions[place];
            wide[place] = wide[place].take().or_else(|| Wide::of(solution, self.forward.measured));
            self.draw(solution, wide[place].as_ref()?, random)
        };
        let (mut all, mut weights, mut effective) = (Vec::new(), Vec::new(), 0.0);
        for _ in 0..ROUNDS {
            let places = places(&self.weights, &mut random);
            all.extend(places.into_iter().filter_map(|place| of(place, &mut random)));
            // No weight beyond √N times the mean (Ionides 2008).
            let cap = 0.5 * (all.len() as f64).ln() + mean_ln(all.iter().map(|(_, ln): &(_, f64)| *ln));
            weights = normalised(all.iter().map(|(_, ln)| ln.min(cap)));
            effective = 1.0 / weights.iter().map(|w| w * w).sum::<f64>();
            if effective > ENOUGH {
                break;
            }
        }
        all.iter_mut().zip(&weights).for_each(|((draw, _), w)| draw.weight = *w);
        (all.into_iter().map(|(draw, _)| draw).collect(), effective)
    }

    /// One draw of a component with ln of its weight; `None` where the model has no covariance.
    fn draw(&self, of: &Solution, wide: &Wide, random: &mut Random) -> Option<(SeriesDraw, f64)> {
        let (forward, m) = (&self.forward, self.forward.measured);
        let Component { kind, preparation, noise, .. } = of.component;
        let (mean, _, factor) = &*of.component.normal;
        let slopes = of.at.by_unknowns.rows(0, m);
        let about = |unknowns: &DVector<f64>| &self.data - &of.residual + slopes * (unknowns - mean);
        // Half of the draws are from a wider distribution, that of data with larger errors.
        let (inverse, scale) =
            if random.uniform() < 0.5 { (&of.inverse, 1.0) } else { (&wide.inverse, WIDER.sqrt()) };
        // A draw from the prior and simulated data, moved by what the data differ: exact for the linear problem.
        let unknowns = mean + factor * normal(random, mean.len());
        let simulated = about(&unknowns) + of.unexplained.l() * normal(random, m) * scale;
        let unknowns = unknowns + &of.gain * (inverse * (&self.data - simulated));
        let linear = ln_normal(&(&self.data - about(&unknowns)), &of.unexplained);
        let off = &self.data - about(&unknowns);
        let wider = linear + 0.5 * (1.0 - 1.0 / WIDER) * off.dot(&of.unexplained.solve(&off))
            - 0.5 * m as f64 * WIDER.ln()
            - wide.ln_evidence
            + of.ln_evidence;
        let highest = linear.max(wider);
        let proposed = highest + (0.5 * ((linear - highest).exp() + (wider - highest).exp())).ln();

        let at = forward.about(kind, preparation, &unknowns);
        let whole = forward.unexplained(&at, forward.rows.len(), noise);
        let cholesky = Cholesky::new(whole.view((0, 0), (m, m)).into_owned())?;
        let off = &self.data - at.ln_speed.rows(0, m);
        let ln_weight = ln_normal(&off, &cholesky) - proposed;
        let pull = cholesky.solve(&off);
        // A quantity with this covariance with the rows and this variance, given the rows.
        let mut given = |with: &DVector<f64>, variance: f64| {
            let left = variance - with.dot(&cholesky.solve(with));
            with.dot(&pull) + left.max(0.0).sqrt() * random.normal::<1>()[0]
        };
        let level = given(&(Forward::by_level(&at, m) * forward.level), forward.level);
        if unknowns[forward.ratio()] < forward.lowest_ratio() {
            return None;
        }
        let mut eps_stiffness = forward.eps_stiffness(kind, &unknowns);
        for (k, eps) in eps_stiffness.iter_mut().enumerate() {
            let (with, variance) = forward.with_eps_stiffness(&at, k, m);
            *eps += given(&with, variance);
        }
        let predict = |j: usize| {
            let with = whole.view((0, j), (m, 1)).column(0).into_owned();
            at.ln_speed[j] + given(&with, whole[(j, j)])
        };
        let predicted = (m..forward.rows.len()).map(predict).collect();
        let draw = SeriesDraw { level, eps_stiffness, predicted, ..self.at(&of.component, &unknowns) };
        ln_weight.is_finite().then_some((draw, ln_weight))
    }

    /// Draws from the prior, without predictions.
    pub(super) fn of_prior(&self, seed: u64) -> Vec<SeriesDraw> {
        let mut random = Random::new(seed);
        let prior = normalised(self.solutions.iter().map(|s| s.component.ln_prior));
        let draw = |place: usize| {
            let component = &self.solutions[place].component;
            let (mean, _, factor) = &*component.normal;
            let unknowns = mean + factor * normal(&mut random, mean.len());
            if unknowns[self.forward.ratio()] < self.forward.lowest_ratio() {
                return None;
            }
            let eps_stiffness = self.forward.eps_stiffness(component.kind, &unknowns);
            let level = self.forward.level.sqrt() * random.normal::<1>()[0];
            let weight = 1.0 / DRAWS as f64;
            Some(SeriesDraw { weight, level, eps_stiffness, ..self.at(component, &unknowns) })
        };
        let mut first = Random::new(seed ^ 1);
        places(&prior, &mut first).into_iter().filter_map(draw).collect()
    }

    fn at(&self, component: &Component, unknowns: &DVector<f64>) -> SeriesDraw {
        let forward = &self.forward;
        SeriesDraw {
            weight: 0.0,
            kind: component.kind,
            preparation: component.preparation,
            noise: component.noise,
            z: forward.z(unknowns),
            eps: forward.eps_of(unknowns),
            eps_stiffness: Vec::new(),
            stiffness_ratio: unknowns[forward.ratio()].min(forward.mindlin),
            ln_crossover: unknowns[forward.ratio() + 1],
            level: 0.0,
            predicted: Vec::new(),
            bulk_less_shear: forward.bulk_less_shear(unknowns),
        }
    }
}
