//! The scaling laws of relaxed networks.

use super::regression::{linear, minimum};
use super::sample::{CalibrationSample, bounds};
use crate::calibration::{
    AmplitudeLaw, CalibrationError, ISOSTATIC, RelaxationCalibration, SCATTERED, ScalingLaw,
};
use crate::invariants::Invariants;
use grainlab_core::Material;
use std::collections::BTreeSet;

/// Reference pressure of the laws, Pa.
const REFERENCE_PRESSURE: f64 = 1e5;

/// Number of different preparations needed: the laws are tested on each with those learned from the others.
const PREPARATIONS: usize = 3;

/// One packing in the units of the laws, with its weight in the fits.
struct Reduced<'a> {
    sample: &'a CalibrationSample,
    invariants: Invariants,
    ln_phi: f64,
    ln_p: f64,
    weight: f64,
}

pub(super) fn network(
    isotropic: &[CalibrationSample],
    anisotropic: &[CalibrationSample],
    material: &Material,
) -> Result<RelaxationCalibration, CalibrationError> {
    let preparations: BTreeSet<&str> =
        isotropic.iter().chain(anisotropic).map(|s| s.preparation.as_str()).collect();
    if preparations.len() < PREPARATIONS {
        let what = "different preparations";
        return Err(CalibrationError::Packings { what, found: preparations.len(), needed: PREPARATIONS });
    }
    let all = || isotropic.iter().chain(anisotropic);
    let count = (isotropic.len() + anisotropic.len()) as f64;
    let moments = |value: fn(&CalibrationSample) -> f64| {
        let mean = all().map(value).sum::<f64>() / count;
        [mean, (all().map(|s| (value(s) - mean).powi(2)).sum::<f64>() / count).sqrt()]
    };
    let solid_fraction = moments(|s| s.solid_fraction);
    let unit = |s: &CalibrationSample| material.effective_young().cbrt().powi(2) * s.pressure.cbrt();
    let reduced = |s: &'_ CalibrationSample| -> Option<(Invariants, f64, f64)> {
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
            Some(Reduced {
                sample,
                invariants,
                ln_phi,
                ln_p,
                weight: RelaxationCalibration::excess(sample.z),
            })
        })
        .collect();
    let (z_low, z_high) = bounds(all().map(|s| s.z));
    let (eps_low, eps_high) = bounds(all().map(|s| s.eps));
    let (loosest, densest) = bounds(all().map(|s| s.solid_fraction));
    let ranges = RelaxationCalibration {
        z: [z_low, z_high],
        eps: [eps_low, eps_high],
        eps_spread: moments(|s| s.eps),
        solid_fraction,
        solid_fractions: [loosest, densest],
        pressure: REFERENCE_PRESSURE,
        grains: all().map(|s| s.grains).min().unwrap_or(0),
        ..fitted(&rows.iter().collect::<Vec<_>>())?
    };
    // Scatter on preparations left out of the fit, for each z within the range of the others.
    let mut squares = [[0.0; SCATTERED]; SCATTERED];
    for preparation in preparations {
        let (left_out, kept): (Vec<_>, Vec<_>) =
            rows.iter().partition(|row| row.sample.preparation == preparation);
        let others = RelaxationCalibration { solid_fraction, pressure: REFERENCE_PRESSURE, ..fitted(&kept)? };
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
    Ok(RelaxationCalibration { scatter: squares, ..ranges })
}

/// The laws alone; all other constants are zero.
fn fitted(rows: &[&Reduced<'_>]) -> Result<RelaxationCalibration, CalibrationError> {
    const WHAT: &str = "packings";
    let lowest = rows.iter().map(|r| r.sample.z).fold(f64::INFINITY, f64::min);
    if lowest <= ISOSTATIC {
        let requirement = "it must be above the isostatic 4, where a network becomes stiff";
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
        Ok(ScalingLaw { level, by_z, by_excess, onset, by_solid_fraction, by_pressure })
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
        Ok(AmplitudeLaw { constant, critical })
    };
    let rattlers: Vec<_> = rows
        .iter()
        .filter(|r| r.sample.k < r.sample.z)
        .map(|r| {
            let share = 1.0 - r.sample.k / r.sample.z;
            // Weighted by the fraction of rattlers, all errors of k count the same.
            ([1.0, r.sample.z, r.ln_phi, r.ln_p], share.ln(), r.weight * share)
        })
        .collect();
    Ok(RelaxationCalibration {
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

/// The difference between a packing and the laws, times (z − 4)/z.
fn residual(network: &RelaxationCalibration, row: &Reduced<'_>) -> [f64; SCATTERED] {
    let CalibrationSample { k, z, eps, eps_stiffness, .. } = *row.sample;
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
