//! Draws, evidence, predictive checks and ranks.

use crate::ours;
use crate::simulated::{BINS, simulated_ranks};
use grainlab_core::Material;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{
    Conditions, Density, EmtError, Measured, Model, Moduli, Modulus, Observation, Posterior,
    PosteriorSettings, Prior, Relaxed, StrainRatio,
};
use grainlab_testkit::{Random, nightly};
use nalgebra::{DMatrix, DVector};

const SETTINGS: PosteriorSettings = PosteriorSettings { points: 65_536, seed: 1 };

fn conditions() -> Conditions {
    Conditions {
        stress_ratio: Some(Measured::exact(0.0)),
        size_spread: Some(0.0),
        material: Some(Material { shear_modulus: 35.3e9, poisson_ratio: 0.212, ..Material::GLASS }),
        ..Conditions::at(5e4)
    }
}

fn observation() -> Observation {
    let moduli = Moduli::of_values([74.2e6, 81.8e6, 137.0e6, 226.7e6, 264.8e6, 89.5e6].map(Some));
    Observation::new(moduli, conditions()).with_relative_error(0.01)
}

fn paper_moduli() -> Observation {
    Observation::from_g12_g13_theta(74.2e6, 81.8e6, 137.0e6, 5e4, StrainRatio::ZERO).with_relative_error(0.01)
}

/// Normal priors and a likelihood that is normal in the unknowns: the evidence is a normal density.
#[test]
fn the_evidence_of_a_linear_model_is_that_of_the_closed_form() {
    let model = grainlab_emt::model("ratio").unwrap();
    let estimate = model.infer(&paper_moduli(), ours()).unwrap();
    let quantities = [InferredQuantity::K, InferredQuantity::KHat, InferredQuantity::Eps];
    let [k, k_hat, eps] = quantities.map(|q| estimate.structure.get(q).unwrap());
    let priors = [[k + 0.2, 0.3], [k_hat - 0.1, 0.2], [eps + 0.05, 0.04]];
    let prior = quantities.into_iter().zip(priors).fold(Prior::default(), |all, (q, [mean, stddev])| {
        all.with(q, Density::normal(mean, stddev).unwrap())
    });
    let posterior = Posterior::new(model, &paper_moduli(), ours(), &prior, SETTINGS).unwrap();
    let found = posterior.evidence().unwrap();

    let moduli = [74.2, 81.8, 137.0];
    let of_moduli = DMatrix::from_fn(3, 3, |i, j| estimate.jacobian[(quantities[i] as usize, j)] / moduli[j]);
    let covariance = estimate.covariance().unwrap();
    let total = DMatrix::from_fn(3, 3, |i, j| {
        let own = if i == j { priors[i][1].powi(2) } else { 0.0 };
        covariance[(quantities[i] as usize, quantities[j] as usize)] + own
    });
    let off = DVector::from_fn(3, |i, _| [k, k_hat, eps][i] - priors[i][0]);
    let square = off.dot(&(total.clone().try_inverse().unwrap() * &off));
    let tau = std::f64::consts::TAU;
    let expected =
        of_moduli.determinant().abs().ln() - 0.5 * (square + total.determinant().ln() + 3.0 * tau.ln());
    assert!((found.ln - expected).abs() < 1e-3, "{found:?} {expected}");
    assert!(found.stderr < 1e-3, "{found:?}");
    // The posterior of the same closed form.
    let gain = &DMatrix::from_fn(3, 3, |i, j| covariance[(quantities[i] as usize, quantities[j] as usize)])
        * total.try_inverse().unwrap();
    let mean = DVector::from_row_slice(&[k, k_hat, eps]) - gain * off;
    for (i, q) in quantities.into_iter().enumerate() {
        let sigma = posterior.stddev().get(q).unwrap();
        assert!((posterior.mean().get(q).unwrap() - mean[i]).abs() < 0.01 * sigma, "{q}");
    }
}

/// A sum over a fine grid of z and ε.
#[test]
fn the_evidence_of_the_relaxed_network_is_the_mean_likelihood_over_the_prior() {
    let likelihood = Relaxed.likelihood(&observation(), ours()).unwrap();
    let (z, eps) = ([4.4, 5.0], [0.0, 0.2]);
    let prior = Prior::default()
        .with(InferredQuantity::Z, Density::uniform(z[0], z[1]).unwrap())
        .with(InferredQuantity::Eps, Density::uniform(eps[0], eps[1]).unwrap());
    let n = 600;
    let at = |[low, high]: [f64; 2], i: u32| low + (high - low) * (f64::from(i) + 0.5) / f64::from(n);
    let sum: f64 = (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .map(|(i, j)| likelihood.at(&[at(z, i), at(eps, j)]).map_or(0.0, |p| p.ln().exp()))
        .sum();
    let expected = (sum / f64::from(n * n)).ln();
    let found =
        Posterior::new(&Relaxed, &observation(), ours(), &prior, SETTINGS).unwrap().evidence().unwrap();
    assert!((found.ln - expected).abs() < 1e-3 && found.stderr < 1e-3, "{found:?} {expected}");
}

#[test]
fn draws_have_the_moments_of_the_integral_and_of_the_estimate_and_a_seed_repeats_them() {
    let posterior = Posterior::new(&Relaxed, &observation(), ours(), &Prior::default(), SETTINGS).unwrap();
    let draws = posterior.draws(8000).unwrap();
    assert_eq!(draws.draws.len(), 8000);
    assert!(draws.acceptance > 0.3, "{}", draws.acceptance);
    let estimate = Relaxed.infer(&observation(), ours()).unwrap();
    for q in posterior.quantities() {
        let values: Vec<f64> = draws.draws.iter().map(|d| d.structure.get(q).unwrap()).collect();
        let mean = values.iter().sum::<f64>() / 8000.0;
        let sigma = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 7999.0).sqrt();
        let (integral, spread) = (posterior.mean().get(q).unwrap(), posterior.stddev().get(q).unwrap());
        // The mean of 8,000 draws is accurate to 1.1 % of σ, σ itself to .8 %.
        assert!((mean - integral).abs() < 0.045 * spread && (sigma / spread - 1.0).abs() < 0.035, "{q}");
        let (linear, error) = (estimate.structure.get(q).unwrap(), estimate.stddev(q).unwrap());
        assert!(
            (mean - linear).abs() < 0.3 * error && (0.8..1.1).contains(&(sigma / error)),
            "{q}: {mean} {sigma}"
        );
    }
    assert_eq!(posterior.draws(8000).unwrap(), draws);
    let other = PosteriorSettings { seed: 2, ..SETTINGS };
    let other = Posterior::new(&Relaxed, &observation(), ours(), &Prior::default(), other).unwrap();
    assert_ne!(other.draws(10).unwrap().draws, draws.draws[..10]);
}

/// Chain rule: the density of all moduli is that of one given the others times that of the others.
#[test]
fn the_density_of_a_modulus_given_the_others_is_the_ratio_of_joint_densities() {
    let observation = paper_moduli();
    let without = Observation { moduli: observation.moduli.without(Modulus::G13), ..observation.clone() };
    let posterior = Posterior::new(&Relaxed, &observation, ours(), &Prior::default(), SETTINGS).unwrap();
    let likelihood = Relaxed.likelihood(&without, ours()).unwrap();
    for draw in posterior.draws(20).unwrap().draws {
        let others = likelihood.at(&[draw.structure.z.unwrap(), draw.structure.eps.unwrap()]).unwrap().ln();
        let expected = draw.ln_likelihood - others;
        assert!((draw.ln_likelihood_by_modulus[1] - expected).abs() < 1e-9, "{draw:?} {expected}");
    }
}

#[test]
fn a_prior_of_k_moves_all_and_has_no_evidence() {
    let free = Posterior::new(&Relaxed, &observation(), ours(), &Prior::default(), SETTINGS).unwrap();
    let k = free.mean().k.unwrap() + 0.1;
    let prior = Prior::default().with(InferredQuantity::K, Density::normal(k, 1e-6).unwrap());
    let posterior = Posterior::new(&Relaxed, &observation(), ours(), &prior, SETTINGS).unwrap();
    assert!((posterior.mean().k.unwrap() - k).abs() < 1e-5 && posterior.stddev().k.unwrap() < 1.1e-6);
    assert!(posterior.mean().z.unwrap() > free.mean().z.unwrap() + 0.01);
    assert!(matches!(posterior.evidence(), Err(EmtError::NoLikelihood { .. })));
    let narrow = Prior::default().with(InferredQuantity::K, Density::uniform(k, k + 0.01).unwrap());
    let posterior = Posterior::new(&Relaxed, &observation(), ours(), &narrow, SETTINGS).unwrap();
    let draws = posterior.draws(500).unwrap();
    assert!(draws.draws.iter().all(|d| (k..=k + 0.01).contains(&d.structure.k.unwrap())));
}

#[test]
fn models_that_state_no_error_of_these_moduli_say_so() {
    let settings = PosteriorSettings { points: 1024, seed: 0 };
    let reason = |model: &str, observation: &Observation, calibration| {
        let model = grainlab_emt::model(model).unwrap();
        match Posterior::new(model, observation, calibration, &Prior::default(), settings) {
            Err(EmtError::NoLikelihood { reason, .. }) => reason,
            other => panic!("{:?}", other.map(|_| ())),
        }
    };
    assert!(reason("directional", &paper_moduli(), ours()).contains("fewer"));
    let two = Observation { moduli: paper_moduli().moduli.without(Modulus::Theta), ..paper_moduli() };
    assert!(reason("ratio", &two, ours()).contains("give more"));
}

/// One modulus 15 % off.
#[test]
fn an_observation_unlike_any_packing_is_improbable_and_an_ordinary_one_is_not() {
    let check = |observation: &Observation| {
        Posterior::new(&Relaxed, observation, ours(), &Prior::default(), SETTINGS).unwrap().check()
    };
    let ordinary = check(&observation());
    assert!(
        !ordinary.is_unlikely() && ordinary.moduli.iter().all(|m| m.left_out.unwrap() > 0.01),
        "{ordinary:?}"
    );
    let moduli = observation().moduli.with(Modulus::C11, 226.7e6 * 1.15);
    let odd = check(&Observation { moduli, ..observation() });
    assert!(odd.is_unlikely() && odd.chi_square < ordinary.chi_square, "{odd:?}");
    assert!(odd.least().unwrap().left_out.unwrap() < 1e-10, "{odd:?}");
}

/// 600 structures from the ranges of the calibration, or a fifth of them; χ² of 20 bins. `--nocapture` prints χ².
#[test]
fn ranks_of_true_values_among_draws_are_uniform_for_the_scatter_that_the_model_states() {
    let prior = Prior::default()
        .with(InferredQuantity::Z, Density::uniform(4.2, 6.4).unwrap())
        .with(InferredQuantity::Eps, Density::uniform(-0.08, 0.13).unwrap());
    let mut counts = vec![[0.0; BINS]; 4];
    let mut random = Random::new(1);
    let count = nightly(120, 600);
    for _ in 0..count {
        let ranks = simulated_ranks(&Relaxed, ours(), &prior, conditions(), &mut random).unwrap();
        assert_eq!(ranks.len(), counts.len());
        for (counts, share) in counts.iter_mut().zip(&ranks) {
            counts[((share * BINS as f64) as usize).min(BINS - 1)] += 1.0;
        }
    }
    for (counts, q) in counts.iter().zip(["z", "eps", "eps_stiffness", "k"]) {
        let expected = f64::from(count) / BINS as f64;
        let chi_square: f64 = counts.iter().map(|c| (c - expected).powi(2) / expected).sum();
        eprintln!("{q}: chi-square {chi_square:.1}, {counts:?}");
        // A larger one comes by chance in 0.0125 of all, four quantities in 0.05.
        assert!(chi_square < 35.39, "{q}: {chi_square}");
    }
}
