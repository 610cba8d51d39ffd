//! Samples that the model itself makes: what was put in is found as often as stated.

use super::component::{Component, Mixture, cells};
use super::draws::normal;
use super::forward::Forward;
use super::gain::ContactKind;
use super::plan::{series_stddev, simulate_series};
use super::prior::SeriesPrior;
use super::sample::{SeriesRow, SpeedMode, SpeedSeries};
use crate::calibration::Calibration;
use crate::random::Random;
use grainlab_core::Material;
use hammer_and_sample::{MinChainLen, Model, Serial, Stretch, sample};
use nalgebra::{Cholesky, DVector};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng;

/// P and S at six pressures, along and across an axis or without direction.
fn template(has_directions: bool) -> SpeedSeries {
    let across = Some(std::f64::consts::FRAC_PI_2);
    let waves = match has_directions {
        false => vec![(SpeedMode::P, None), (SpeedMode::Sv, None)],
        true => vec![
            (SpeedMode::P, Some(0.0)),
            (SpeedMode::Sv, Some(0.0)),
            (SpeedMode::P, across),
            (SpeedMode::Sv, across),
            (SpeedMode::Sh, across),
        ],
    };
    let row = |pressure: f64, (mode, angle): (SpeedMode, Option<f64>)| SeriesRow {
        pressure,
        density: 1600.0,
        mode,
        angle,
        speed: Some(1.0),
        stddev: 0.01,
        common_stddev: 0.0,
    };
    let pressures = [50e3, 150e3, 500e3, 1.5e6, 5e6, 15e6].into_iter();
    let rows = pressures.flat_map(|p| waves.iter().map(move |wave| row(p, *wave))).collect();
    let size_variance = [0.01, 0.0];
    SpeedSeries {
        shear_modulus_stddev: 0.05,
        density_stddev: 0.01,
        size_variance,
        ..SpeedSeries::of(rows, Material::GLASS)
    }
}

/// A sample from the prior, with the place of its z, k_t/k_n, ε and ε weighted by stiffness among the draws.
fn simulated(series: &mut SpeedSeries, prior: &SeriesPrior, random: &mut Random) -> Vec<f64> {
    let network = Calibration::builtin("grainlab").unwrap().network.as_ref().unwrap();
    let seed = (random.uniform() * 1e9) as u64;
    let of = simulate_series(series, network, prior, None, seed).unwrap();
    let all = |name: &str| of.iter().filter(|q| q.name == name).map(|q| q.value).collect::<Vec<_>>();
    let names = ["z", "stiffness_ratio", "eps", "eps_stiffness"];
    let truth: Vec<f64> =
        names.iter().filter_map(|name| Some(*all(name).get(3).or(all(name).last())?)).collect();
    let mixture = Mixture::of(Forward::new(series, network, prior), series.ln_crossover);
    let (draws, _) = mixture.draws((random.uniform() * 1e9) as u64);
    let mut found = Vec::new();
    for (n, truth) in truth.iter().enumerate() {
        let value = |d: &super::draws::SeriesDraw| match n {
            0 => d.z[3],
            1 => d.stiffness_ratio,
            2 => d.eps[3],
            _ => d.eps_stiffness[3],
        };
        let below: f64 = draws.iter().filter(|d| value(d) < *truth).map(|d| d.weight).sum();
        let equal: f64 = draws.iter().filter(|d| value(d) == *truth).map(|d| d.weight).sum();
        found.push(below + equal * random.uniform());
    }
    found
}

/// Probability of a largest distance of the ranks from uniform ones (Kolmogorov and Smirnov).
fn uniform(mut ranks: Vec<f64>) -> f64 {
    ranks.sort_by(f64::total_cmp);
    let n = ranks.len() as f64;
    let off = |(i, r): (usize, &f64)| (r - i as f64 / n).abs().max((r - (i + 1) as f64 / n).abs());
    let scaled = (n.sqrt() + 0.12 + 0.11 / n.sqrt()) * ranks.iter().enumerate().map(off).fold(0.0, f64::max);
    let term = |k: i32| (-1f64).powi(k - 1) * (-2.0 * (f64::from(k) * scaled).powi(2)).exp();
    2.0 * (1..50).map(term).sum::<f64>()
}

const SAMPLES: usize = 24;

#[test]
fn true_values_rank_uniformly_among_draws() {
    let mut random = Random::new(3);
    for directions in [false, true] {
        let mut sample = || simulated(&mut template(directions), SeriesPrior::builtin(), &mut random);
        let all: Vec<Vec<f64>> = (0..SAMPLES).map(|_| sample()).collect();
        for q in 0..all[0].len() {
            let ranks: Vec<f64> = all.iter().map(|a| a[q]).collect();
            let inside =
                ranks.iter().filter(|r| (0.025..=0.975).contains(*r)).count() as f64 / SAMPLES as f64;
            let p = uniform(ranks);
            assert!(p > 0.01 && inside > 0.8, "directions {directions}, quantity {q}: {inside} {p}");
        }
    }
}

/// An isotropic sand whose speeds scatter by 0.2 %: P and SV along the axis, then P, SH and SV across it, which are `off` too fast.
fn isotropic_sand(off: f64, [stddev, common_stddev]: [f64; 2]) -> SpeedSeries {
    let mut random = Random::new(5);
    let across = std::f64::consts::FRAC_PI_2;
    let (p, sv, sh) = (SpeedMode::P, SpeedMode::Sv, SpeedMode::Sh);
    let waves =
        [(p, 0.0, 372.0), (p, across, 372.0), (sv, 0.0, 230.0), (sh, across, 230.0), (sv, across, 230.0)];
    let mut row = |pressure: f64, (mode, angle, speed): (SpeedMode, f64, f64)| {
        let scale = (pressure / 1e5).powf(0.25) * (1.0 + 0.002 * random.normal::<1>()[0]);
        let speed = speed * scale * if angle > 0.0 { 1.0 + off } else { 1.0 };
        SeriesRow {
            pressure,
            density: 1600.0,
            mode,
            angle: Some(angle),
            speed: Some(speed),
            stddev,
            common_stddev,
        }
    };
    let pressures = [50e3, 100e3, 200e3, 400e3].into_iter();
    let rows = pressures.flat_map(|pressure| waves.map(|wave| row(pressure, wave))).collect();
    SpeedSeries {
        size_variance: [0.01, 0.0],
        ..SpeedSeries::of(rows, Material { shear_modulus: 44e9, poisson_ratio: 0.08, density: 2650.0 })
    }
}

/// The distance across the axis is wrong by its error: in all rows, which agree better than their errors, or by a stated common error.
#[test]
fn an_error_that_rows_of_a_direction_share_is_in_that_of_eps() {
    let network = Calibration::builtin("grainlab").unwrap().network.as_ref().unwrap();
    for errors in [[0.025, 0.0], [0.003, 0.025], [0.01, 0.025]] {
        let series = isotropic_sand(0.025, errors);
        let found = super::estimate::infer_series(&series, network, SeriesPrior::builtin()).unwrap();
        for at in &found.pressures {
            let eps = at.eps.unwrap();
            assert!(eps.mean.abs() < 1.5 * eps.stddev && eps.stddev > 0.025, "{errors:?}: {eps:?}");
        }
    }
}

#[test]
fn waves_of_one_modulus_do_not_determine_eps_and_are_named_where_they_differ() {
    let unequal = isotropic_sand(0.033, [0.01, 0.0]);
    let of = |wanted: &[SpeedMode]| {
        let mut series = unequal.clone();
        series.rows.retain(|row| wanted.contains(&row.mode));
        series
    };
    let sv = of(&[SpeedMode::Sv]);
    assert!(!sv.has_directions() && of(&[SpeedMode::P]).has_directions());
    assert!(of(&[SpeedMode::Sv, SpeedMode::Sh]).has_directions());
    assert!((sv.unequal_twins().unwrap() - 0.033).abs() < 0.003, "{:?}", sv.unequal_twins());
    assert_eq!(isotropic_sand(0.0, [0.01, 0.0]).unequal_twins(), None);
    assert_eq!(isotropic_sand(0.033, [0.01, 0.033]).unequal_twins(), None);
}

/// The posterior of rough contacts and one preparation, by the model itself: the components give the prior alone.
struct OfRough<'a> {
    mixture: &'a Mixture<'a>,
    cells: Vec<(Component, Cholesky<f64, nalgebra::Dyn>)>,
}

impl Model for OfRough<'_> {
    type Params = Vec<f64>;

    fn log_prob(&self, unknowns: &Vec<f64>) -> f64 {
        let unknowns = DVector::from_column_slice(unknowns);
        let forward = &self.mixture.forward;
        if unknowns[forward.ratio()] < forward.lowest_ratio() {
            return f64::NEG_INFINITY;
        }
        let ln_normal = |off: &DVector<f64>, c: &Cholesky<f64, nalgebra::Dyn>| {
            -0.5 * off.dot(&c.solve(off)) - c.l_dirty().diagonal().map(f64::ln).sum()
        };
        let prior: f64 = self
            .cells
            .iter()
            .map(|(c, root)| (c.ln_prior + ln_normal(&(&unknowns - &c.normal.0), root)).exp())
            .sum();
        let at = forward.about(ContactKind::Rough, 0, &unknowns);
        let m = forward.measured;
        let own = Cholesky::new(forward.unexplained(&at, m, 1.0));
        own.map_or(f64::NEG_INFINITY, |own| {
            prior.ln() + ln_normal(&(&self.mixture.data - at.ln_speed.rows(0, m)), &own)
        })
    }
}

/// Means differ by less than a tenth of the standard deviations, and these by less than a tenth.
#[test]
fn an_ensemble_sampler_finds_the_same_posterior() {
    let mut prior = SeriesPrior::builtin().of_law(ContactKind::Rough);
    prior.preparation.truncate(1);
    (prior.level, prior.noise, prior.mindlin) = (0.1, [0.999, 1.001], 0.0);
    let mut series = template(false);
    series.rows.retain(|row| [50e3, 500e3, 1.5e6, 5e6].contains(&row.pressure));
    simulated(&mut series, &prior, &mut Random::new(8));
    let network = Calibration::builtin("grainlab").unwrap().network.as_ref().unwrap();
    let mixture = Mixture::of(Forward::new(&series, network, &prior), None);
    let (ours, _) = mixture.draws(1);
    let root = |c: Component| Some((c.clone(), Cholesky::new(c.normal.1.clone())?));
    let cells = cells(&mixture.forward, &prior, None).into_iter().filter_map(root).collect();
    let target = OfRough { mixture: &mixture, cells };
    let start = |seed: u64| {
        let mut random = Random::new(seed);
        let (c, root) = &target.cells[seed as usize % target.cells.len()];
        let at = &c.normal.0 + root.l() * normal(&mut random, c.normal.0.len());
        (at.as_slice().to_vec(), Pcg64::seed_from_u64(seed))
    };
    const WALKERS: usize = 48;
    let walkers = (0..WALKERS as u64).map(start);
    let (chain, _) = sample(&target, &Stretch::default(), walkers, MinChainLen(WALKERS * 3000), Serial);
    let moments = |all: &[(f64, f64)]| {
        let sum: f64 = all.iter().map(|(_, w)| w).sum();
        let mean = all.iter().map(|(v, w)| v * w).sum::<f64>() / sum;
        let square = all.iter().map(|(v, w)| (v - mean).powi(2) * w).sum::<f64>() / sum;
        (mean, square.sqrt())
    };
    let ratio = mixture.forward.ratio();
    for at in 0..=ratio + 1 {
        let of_draw = |d: &super::draws::SeriesDraw| match at {
            k if k < ratio => d.z[k],
            k if k == ratio => d.stiffness_ratio,
            _ => d.ln_crossover,
        };
        let of_chain = |v: &Vec<f64>| match at {
            k if k < ratio => Forward::z_of(v[k])[0],
            k if k == ratio => v[k].min(mixture.forward.mindlin),
            k => v[k],
        };
        let (mean, stddev) = moments(&ours.iter().map(|d| (of_draw(d), d.weight)).collect::<Vec<_>>());
        let theirs: Vec<_> = chain[WALKERS * 500..].iter().map(|v| (of_chain(v), 1.0)).collect();
        let (their_mean, their_stddev) = moments(&theirs);
        let found = format!("{at}: {mean} +- {stddev}, {their_mean} +- {their_stddev}");
        assert!(
            (mean - their_mean).abs() < 0.1 * stddev && (stddev / their_stddev - 1.0).abs() < 0.1,
            "{found}"
        );
    }
}

/// Root mean squares of 200 standard deviations and of the errors of 200 other experiments by the whole inversion.
#[test]
fn planned_errors_are_those_of_experiments() {
    let network = Calibration::builtin("grainlab").unwrap().network.as_ref().unwrap();
    let prior = SeriesPrior::builtin();
    let rms = |all: &[f64]| (all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64).sqrt();
    let mut series = template(true);
    series.rows.retain(|row| row.pressure == 150e3);
    let mut planned = |seed| {
        simulate_series(&mut series, network, prior, Some(1.0), seed).unwrap();
        let [found, _] = series_stddev(&series, network, prior).unwrap();
        found.iter().map(|q| q.value).collect()
    };
    let planned: Vec<Vec<f64>> = (0..200).map(&mut planned).collect();
    let mut error = |seed| {
        let truth = simulate_series(&mut series, network, prior, Some(1.0), seed).unwrap();
        let found = super::estimate::infer_series(&series, network, prior).unwrap();
        let at = &&found.pressures[0];
        let [eps, eps_stiffness] = [at.eps.unwrap(), at.eps_stiffness.unwrap()];
        let means = [at.z.mean, eps.mean, eps_stiffness.mean, found.stiffness_ratio.mean, found.level.mean];
        truth.iter().zip(means).map(|(truth, mean)| mean - truth.value).collect()
    };
    let errors: Vec<Vec<f64>> = (1000..1200).map(&mut error).collect();
    for k in 0..5 {
        let of = |all: &[Vec<f64>]| rms(&all.iter().map(|a| a[k]).collect::<Vec<_>>());
        let ratio = of(&planned) / of(&errors);
        assert!((0.9..=1.1).contains(&ratio), "{k}: {ratio}");
    }
}
