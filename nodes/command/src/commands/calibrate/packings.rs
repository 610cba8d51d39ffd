//! From the rows of a table to the packings that a calibration is learned from.

use crate::commands::invert::{BadRow, Row, Rows, State};
use grainlab_calibration::CalibrationSample;
use grainlab_console::{Failure, say};
use grainlab_core::Material;
use grainlab_core::contact::SpringLaw;
use grainlab_emt::{Conditions, Modulus};
use std::path::Path;

/// Largest median of |eps| of isotropic packings, and what chance makes of it over the root of the number of grains: .27 in
/// those of the built-in calibration.
const ISOTROPIC: f64 = 0.03;
const CHANCE: f64 = 0.7;

/// The columns that identify packings.
pub(super) struct Naming<'a> {
    pub(super) preparation: &'a [String],
    pub(super) packing: &'a [String],
}

/// Every packing of a table. An invalid row is reported, and the calibration is refused, because it would not
/// include that row.
pub(super) fn read(path: &Path, naming: &Naming<'_>) -> Result<Vec<CalibrationSample>, Failure> {
    let by = [naming.preparation, naming.packing].concat();
    let mut rows = Rows::open(path, &by, State::default())?;
    let (mut samples, mut bad) = (Vec::new(), 0);
    let work = |number: u64, row: Result<Row, BadRow>| match row {
        Ok(row) => sample(&row, naming.preparation.len()).map_err(|fault| format!("line {number}: {fault}")),
        Err(row) => Err(format!("line {number}: {}", row.fault)),
    };
    while let Some(piece) = rows.next(work)? {
        for found in piece {
            match found {
                Ok(sample) => samples.push(sample),
                Err(fault) => {
                    say!("grainlab: {}: {fault}", rows.name());
                    bad += 1;
                }
            }
        }
    }
    let name = rows.name();
    if bad > 0 {
        return Err(Failure::usage(format!("{name}: {bad} rows are not valid packings")));
    }
    if samples.is_empty() {
        return Err(Failure::usage(format!("{name}: there is no packing below the header")));
    }
    Ok(samples)
}

/// Refuses packings most of which are anisotropic: the laws of isotropic ones are fitted to them.
pub(super) fn check_isotropic(samples: &[CalibrationSample]) -> Result<(), String> {
    let median = |of: fn(&CalibrationSample) -> f64| {
        let mut values: Vec<f64> = samples.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let (eps, grains) = (median(|s| s.eps.abs()), median(|s| f64::from(s.grains)));
    let limit = ISOTROPIC.max(CHANCE / grains.sqrt());
    if eps <= limit {
        return Ok(());
    }
    Err(format!(
        "these packings are not isotropic: the median of |eps| is {eps:.3}, and at most {limit:.3} is expected; are the tables of \
         --isotropic and --anisotropic exchanged?"
    ))
}

/// The first `preparation` cells grouped by identify the preparation, those after them the packing.
fn sample(row: &Row, preparation: usize) -> Result<CalibrationSample, String> {
    let State { moduli, truth, conditions, grains, grain_shear_modulus, poisson, .. } = &row.state;
    let Conditions { pressure, solid_fraction, stress_ratio, size_spread, contact_law, smooth, .. } =
        conditions;
    let need = |value: Option<f64>, name: &str| match value {
        Some(value) if value.is_finite() => Ok(value),
        Some(value) => Err(format!("{name} = {value} is not finite")),
        None => Err(format!("{name} is not known")),
    };
    for modulus in Modulus::ALL {
        if need(moduli.get(modulus), modulus.name())? <= 0.0 {
            return Err(format!("{modulus} is not positive: there is no network"));
        }
    }
    need(Some(pressure.value), "the pressure")?;
    if let Some(spread) = size_spread.filter(|s| !(0.0..=1.0).contains(s)) {
        return Err(format!("size_spread = {spread} is outside [0, 1]"));
    }
    if let Some(ratio) = stress_ratio.filter(|r| !(-1.5..=3.0).contains(&r.value)) {
        return Err(format!("axial_q_over_p = {} is outside [-1.5, 3]", ratio.value));
    }
    if *smooth {
        return Err("its moduli are those without tangential springs, which no model is for".to_owned());
    }
    if let Some(law) = contact_law.filter(|law| law.springs != SpringLaw::HertzMindlin) {
        return Err(format!("its contact law is {law}, and every model is for Hertz-Mindlin contacts"));
    }
    let (preparation, packing) = row.group.split_at(preparation);
    Ok(CalibrationSample {
        preparation: preparation.join(" "),
        packing: packing.join(" "),
        grains: need(*grains, "grains")? as u32,
        material: Material {
            shear_modulus: grain_shear_modulus.unwrap_or(Material::GLASS.shear_modulus),
            poisson_ratio: poisson.unwrap_or(Material::GLASS.poisson_ratio),
            ..Material::GLASS
        },
        pressure: pressure.value,
        solid_fraction: need(solid_fraction.map(|p| p.value), "phi")?,
        // Tables without them are of equal grains in an isotropic stress.
        stress_ratio: need(Some(stress_ratio.map_or(0.0, |ratio| ratio.value)), "axial_q_over_p")?,
        size_spread: need(Some(size_spread.unwrap_or(0.0)), "size_spread")?,
        moduli: *moduli,
        gamma: row.state.measured_gamma,
        k: need(truth.k, "k")?,
        z: need(truth.z, "z")?,
        eps: need(truth.eps, "eps")?,
        eps_stiffness: need(truth.eps_stiffness, "eps_stiffness")?,
    })
}
