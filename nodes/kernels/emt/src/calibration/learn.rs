//! From packings to constants.

use super::ensemble::Sample;
use super::isotropic::Isotropic;
use super::network::{Amplitude, ISOSTATIC, Law, Network, SCATTERED};
use super::regression::{linear, minimum};
use super::{Calibration, CalibrationError, Discrepancy};
use crate::conditions::{Gamma, GammaSource};
use crate::error::EmtError;
use crate::invariants::Invariants;
use crate::model::{Model, models};
use crate::structure::Quantity;
use grainlab_core::Material;
use std::collections::BTreeSet;

/// Pressure that the laws refer to, Pa.
const REFERENCE_PRESSURE: f64 = 1e5;

/// Different preparations that the model of relaxed networks needs: it is judged on each by the others.
const PREPARATIONS: usize = 3;

/// Constants from packings that are isotropic, and from packings that are not. Without the latter there are Eqs. 21 and 22
/// alone. All must be of one material.
pub fn learn(
    name: &str,
    isotropic: &[Sample],
    anisotropic: &[Sample],
) -> Result<Calibration, CalibrationError> {
    let all: Vec<&Sample> = isotropic.iter().chain(anisotropic).collect();
    let material = material(&all)?;
    let (low, high) = bounds(all.iter().map(|s| s.pressure));
    let mut calibration = Calibration {
        other: Some(of_isotropic(isotropic, Quantity::Z)?),
        pressures: Some([low, high]),
        ..Calibration::of_isotropic(name.to_owned(), of_isotropic(isotropic, Quantity::K)?, material)
    };
    if !anisotropic.is_empty() {
        calibration.network = Some(Box::new(network(isotropic, anisotropic, &material)?));
        calibration.discrepancies = discrepancies(isotropic, anisotropic, &calibration);
    }
    Ok(calibration)
}

fn material(samples: &[&Sample]) -> Result<Material, CalibrationError> {
    let first =
        samples.first().ok_or(CalibrationError::Packings { what: "packings", found: 0, needed: 3 })?;
    for s in samples {
        if !s.is_finite() {
            let requirement = "every number of a packing must be finite, and all moduli known and positive";
            return Err(CalibrationError::Constant { field: "a packing", value: s.pressure, requirement });
        }
        for (field, value, reference) in [
            ("shear modulus of the grains", s.material.shear_modulus, first.material.shear_modulus),
            ("Poisson ratio of the grains", s.material.poisson_ratio, first.material.poisson_ratio),
        ] {
            if value != reference {
                let requirement = "all packings of a calibration must be of one material";
                return Err(CalibrationError::Constant { field, value, requirement });
            }
        }
    }
    Ok(first.material)
}

fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// Eqs. 21 and 22 by relative residuals. States of one packing at several pressures are no independent data: the
/// covariance is that of as many data as there are packings.
fn of_isotropic(samples: &[Sample], abscissa: Quantity) -> Result<Isotropic, CalibrationError> {
    let coordination = |s: &Sample| if abscissa == Quantity::Z { s.z } else { s.k };
    let packings = samples.iter().map(|s| &s.packing).collect::<BTreeSet<_>>().len();
    let fit = |modulus: fn(&Invariants) -> f64| {
        let rows: Vec<_> = samples
            .iter()
            .filter_map(|s| {
                let reduced = modulus(&Invariants::of(&s.moduli)?).exp() / 1e6 / (s.pressure / 1e6).cbrt();
                Some(([coordination(s), 1.0], reduced, 1.0 / reduced))
            })
            .collect();
        let line = linear(&rows, "isotropic packings")?;
        let independent = (packings as f64 - 2.0).max(1.0);
        let variance = line.squares / rows.len() as f64 * packings as f64 / independent;
        // From slope and intercept to slope and their ratio.
        let (slope, ratio) = (line.coefficients[0], line.coefficients[1] / line.coefficients[0]);
        let jacobian = nalgebra::Matrix2::new(1.0, 0.0, -ratio / slope, 1.0 / slope);
        let inverse =
            line.inverse.fixed_view::<2, 2>(0, 0).into_owned() * (rows.len() as f64 / packings as f64);
        let covariance = jacobian * inverse * jacobian.transpose() * variance;
        Ok((slope, ratio, covariance, (line.squares / rows.len() as f64).sqrt()))
    };
    let (alpha, beta, of_shear, shear_scatter) = fit(|i| i.ln_shear)?;
    let (rho, zeta, of_theta, theta_scatter) = fit(|i| i.ln_theta)?;
    let (low, high) = bounds(samples.iter().map(coordination));
    let mut isotropic = Isotropic::new([alpha, beta, rho, zeta], abscissa, [low, high])?;
    let mut covariance = [[0.0; 4]; 4];
    for i in 0..2 {
        for j in 0..2 {
            covariance[i][j] = of_shear[(i, j)];
            covariance[2 + i][2 + j] = of_theta[(i, j)];
        }
    }
    isotropic.covariance = Some(covariance);
    isotropic.scatter = Some([shear_scatter, theta_scatter]);
    Ok(isotropic)
}

/// One packing in the units of the laws.
struct Reduced<'a> {
    sample: &'a Sample,
    invariants: Invariants,
    ln_phi: f64,
    ln_p: f64,
    weight: f64,
}

fn network(
    isotropic: &[Sample],
    anisotropic: &[Sample],
    material: &Material,
) -> Result<Network, CalibrationError> {
    let preparations: BTreeSet<&str> =
        isotropic.iter().chain(anisotropic).map(|s| s.preparation.as_str()).collect();
    if preparations.len() < PREPARATIONS {
        let what = "different preparations";
        return Err(CalibrationError::Packings { what, found: preparations.len(), needed: PREPARATIONS });
    }
    let all = || isotropic.iter().chain(anisotropic);
    let count = (isotropic.len() + anisotropic.len()) as f64;
    let moments = |value: fn(&Sample) -> f64| {
        let mean = all().map(value).sum::<f64>() / count;
        [mean, (all().map(|s| (value(s) - mean).powi(2)).sum::<f64>() / count).sqrt()]
    };
    let solid_fraction = moments(|s| s.solid_fraction);
    let unit = |s: &Sample| material.effective_young().cbrt().powi(2) * s.pressure.cbrt();
    let reduced = |s: &'_ Sample| -> Option<(Invariants, f64, f64)> {
        let mut invariants = Invariants::of(&s.moduli)?;
        invariants.ln_theta -= unit(s).ln();
        invariants.ln_shear -= unit(s).ln();
        Some((
            invariants,
            (s.solid_fraction / solid_fraction[0]).ln(),
            (s.pressure / REFERENCE_PRESSURE).ln(),
        ))
    };
    let rows: Vec<Reduced<'_>> = all()
        .filter_map(|sample| {
            let (invariants, ln_phi, ln_p) = reduced(sample)?;
            Some(Reduced { sample, invariants, ln_phi, ln_p, weight: Network::excess(sample.z) })
        })
        .collect();
    let (z_low, z_high) = bounds(all().map(|s| s.z));
    let (eps_low, eps_high) = bounds(all().map(|s| s.eps));
    let (loosest, densest) = bounds(all().map(|s| s.solid_fraction));
    let ranges = Network {
        z: [z_low, z_high],
        eps: [eps_low, eps_high],
        eps_spread: moments(|s| s.eps),
        solid_fraction,
        solid_fractions: [loosest, densest],
        pressure: REFERENCE_PRESSURE,
        grains: all().map(|s| s.grains).min().unwrap_or(0),
        ..fitted(&rows.iter().collect::<Vec<_>>())?
    };
    // How the laws do on a preparation that they have not seen, wherever the others reach.
    let mut squares = [[0.0; SCATTERED]; SCATTERED];
    for preparation in preparations {
        let (left_out, kept): (Vec<_>, Vec<_>) =
            rows.iter().partition(|row| row.sample.preparation == preparation);
        let others = Network { solid_fraction, pressure: REFERENCE_PRESSURE, ..fitted(&kept)? };
        let (low, high) = bounds(kept.iter().map(|row| row.sample.z));
        for row in left_out {
            let reached = (low..=high).contains(&row.sample.z);
            let residual = residual(if reached { &others } else { &ranges }, row);
            for (i, a) in residual.iter().enumerate() {
                for (j, b) in residual.iter().enumerate() {
                    squares[i][j] += a * b / rows.len() as f64;
                }
            }
        }
    }
    Ok(Network { scatter: squares, ..ranges })
}

/// The laws; everything that is no law is left empty.
fn fitted(rows: &[&Reduced<'_>]) -> Result<Network, CalibrationError> {
    const WHAT: &str = "packings";
    let lowest = rows.iter().map(|r| r.sample.z).fold(f64::INFINITY, f64::min);
    if lowest <= ISOSTATIC {
        let requirement = "above the isostatic 4, where a network begins to be stiff";
        return Err(CalibrationError::Constant { field: "z of a packing", value: lowest, requirement });
    }
    let law = |value: fn(&Invariants) -> f64| {
        let at = |onset: f64| {
            let points: Vec<_> = rows
                .iter()
                .map(|r| {
                    let z = r.sample.z;
                    ([1.0, z.ln(), (z - onset).ln(), r.ln_phi, r.ln_p], value(&r.invariants), r.weight)
                })
                .collect();
            linear(&points, WHAT)
        };
        let onset = minimum(2.0, lowest - 0.05, |onset| at(onset).map_or(f64::INFINITY, |fit| fit.squares));
        let [level, by_z, by_excess, by_solid_fraction, by_pressure] = coefficients(&at(onset)?.coefficients);
        Ok(Law { level, by_z, by_excess, onset, by_solid_fraction, by_pressure })
    };
    let amplitude = |value: fn(&Reduced<'_>) -> f64| {
        let points: Vec<_> = rows
            .iter()
            .map(|r| {
                let (z, eps) = (r.sample.z, r.sample.eps);
                ([eps, eps * z / (z - ISOSTATIC)], value(r), r.weight)
            })
            .collect();
        let [constant, critical] = coefficients(&linear(&points, WHAT)?.coefficients);
        Ok(Amplitude { constant, critical })
    };
    let rattlers: Vec<_> = rows
        .iter()
        .filter(|r| r.sample.k < r.sample.z)
        .map(|r| {
            let share = 1.0 - r.sample.k / r.sample.z;
            // Relative errors of a small share are large: weighed by the share, all errors of k are alike.
            ([1.0, r.sample.z, r.ln_phi, r.ln_p], share.ln(), r.weight * share)
        })
        .collect();
    Ok(Network {
        theta: law(|i| i.ln_theta)?,
        shear: law(|i| i.ln_shear)?,
        dilatation: amplitude(|r| r.invariants.dilatation)?,
        voigt: amplitude(|r| r.invariants.voigt)?,
        harmonic: amplitude(|r| r.invariants.harmonic)?,
        eps_stiffness: amplitude(|r| r.sample.eps_stiffness)?,
        rattlers: coefficients(&linear(&rattlers, "packings with rattlers")?.coefficients),
        scatter: [[0.0; SCATTERED]; SCATTERED],
        z: [0.0; 2],
        eps: [0.0; 2],
        eps_spread: [0.0; 2],
        solid_fraction: [1.0, 0.0],
        solid_fractions: [0.0; 2],
        pressure: REFERENCE_PRESSURE,
        grains: 0,
    })
}

fn coefficients<const N: usize>(found: &[f64]) -> [f64; N] {
    std::array::from_fn(|i| found[i])
}

/// What a packing differs by from the laws, times (z − 4)/z.
fn residual(network: &Network, row: &Reduced<'_>) -> [f64; SCATTERED] {
    let Sample { k, z, eps, eps_stiffness, .. } = *row.sample;
    let i = &row.invariants;
    let off = [
        i.ln_theta - network.theta.value(z, row.ln_phi, row.ln_p),
        i.ln_shear - network.shear.value(z, row.ln_phi, row.ln_p),
        i.dilatation - network.dilatation.value(z) * eps,
        i.voigt - network.voigt.value(z) * eps,
        i.harmonic - network.harmonic.value(z) * eps,
        eps_stiffness - network.eps_stiffness.value(z) * eps,
        k - z * (1.0 - network.ln_rattlers(z, row.ln_phi, row.ln_p).exp()),
    ];
    off.map(|v| v * row.weight)
}

/// How far every model that has no scatter of its own is from the packings, by each γ/Δ and coordination number. Of
/// isotropic packings the errors of ε alone count: in the rest every model gets them right.
fn discrepancies(
    isotropic: &[Sample],
    anisotropic: &[Sample],
    calibration: &Calibration,
) -> Vec<Discrepancy> {
    const SOURCES: [GammaSource; 4] =
        [GammaSource::Zero, GammaSource::Total, GammaSource::Elastic, GammaSource::Contact];
    let mut learned = Vec::new();
    for abscissa in [Quantity::K, Quantity::Z] {
        let Some(calibration) = calibration.with_abscissa(abscissa) else { continue };
        for model in models() {
            let sources = if model.uses_gamma() { &SOURCES[..] } else { &SOURCES[..1] };
            for source in sources {
                let errors = |samples| errors(*model, samples, *source, abscissa, &calibration);
                let Some((without, errors)) = errors(isotropic).zip(errors(anisotropic)) else { continue };
                let mean = |i: usize, j: usize| {
                    errors.iter().map(|(_, e)| e[i] * e[j]).sum::<f64>() / errors.len() as f64
                };
                learned.push(Discrepancy {
                    model: model.name().to_owned(),
                    abscissa,
                    gamma: model.uses_gamma().then_some(*source),
                    mean_square: std::array::from_fn(|i| std::array::from_fn(|j| mean(i, j))),
                    by_eps: by_eps(&without, &errors),
                });
            }
        }
    }
    learned
}

/// ε inferred, and the errors of coordination number, k̂ and ε.
type Errors = Vec<(f64, [f64; 3])>;

/// `None` if the model does not solve nine in ten.
fn errors(
    model: &dyn Model,
    samples: &[Sample],
    gamma: GammaSource,
    abscissa: Quantity,
    calibration: &Calibration,
) -> Option<Errors> {
    let error = |s: &Sample| -> Result<Option<(f64, [f64; 3])>, EmtError> {
        let solution = model.solve(&s.observation(gamma).checked()?, calibration)?;
        if solution.discrepancy.is_some() {
            return Ok(None);
        }
        let found = solution.structure;
        let truth = if abscissa == Quantity::Z { s.z } else { s.k };
        let k_hat = found.k_hat.map_or(0.0, |k_hat| k_hat - truth);
        let both = found.get(abscissa).zip(found.eps);
        Ok(both.map(|(n, eps)| (eps, [n - truth, k_hat, eps - s.eps])))
    };
    let known = |s: &&Sample| gamma == GammaSource::Zero || Gamma::is_known(&s.gamma, gamma);
    let asked: Vec<_> = samples.iter().filter(known).collect();
    let errors: Errors = asked.iter().filter_map(|s| error(s).ok().flatten()).collect();
    (!errors.is_empty() && errors.len() * 10 >= asked.len() * 9).then_some(errors)
}

/// How the square of the error of ε grows with the ε inferred: f0 + f1 ε², f0 as packings without anisotropy have it and 1
/// in the mean of those with.
fn by_eps(without: &Errors, with: &Errors) -> [f64; 2] {
    let mean = |errors: &Errors, f: fn(f64, f64) -> f64| {
        errors.iter().map(|(eps, e)| f(*eps, e[2])).sum::<f64>() / errors.len() as f64
    };
    let error = mean(with, |_, e| e * e);
    let square = mean(with, |eps, _| eps * eps);
    let constant = (mean(without, |_, e| e * e) / error).min(1.0);
    if constant.is_finite() && square > 0.0 { [constant, (1.0 - constant) / square] } else { [1.0, 0.0] }
}
