//! From the rows of a table to the packings that a calibration is learned from.

use crate::commands::invert::{BadRow, Row, Rows, State};
use grainlab_calibration::CalibrationSample;
use grainlab_console::{Failure, count, say};
use grainlab_core::Material;
use grainlab_core::contact::SpringLaw;
use grainlab_emt::{Conditions, Modulus};
use std::path::Path;

/// Columns without which a row is no packing to learn from.
const NEEDED: &str = "g12_pa g13_pa theta_pa ti_c11_pa ti_c33_pa ti_c13_pa phi grains k z eps eps_stiffness";

/// Every packing of a table. An invalid row is reported, and the calibration is refused, because it would not
/// include that row. The first `recipe` columns of each `by` identify the preparation, those after them the packing.
pub(super) fn read(path: &Path, recipe: usize, by: &[&[String]]) -> Result<Vec<CalibrationSample>, Failure> {
    let mut rows = Rows::open(path, by, State::default())?;
    let (name, missing) = (rows.name(), rows.columns.missing(NEEDED).join(", "));
    if !missing.is_empty() {
        return Err(Failure::usage(format!(
            "{name}: the header: no column {missing}, which `grainlab analyze` prints"
        )));
    }
    let (mut samples, mut bad) = (Vec::new(), 0);
    let work = |number: u64, row: Result<Row, BadRow>| match row {
        Ok(row) => sample(&row, recipe, path, number)
            .and_then(|sample| sample.check().map(|()| sample).map_err(|e| e.to_string()))
            .map_err(|fault| format!("line {number}: {fault}")),
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

pub(super) fn counted(path: &Path, samples: &[CalibrationSample]) -> String {
    let states = count(samples.len(), "state");
    format!("{} ({states}) of {}", count(grainlab_calibration::packings(samples), "packing"), path.display())
}

/// Name of a member of a campaign without its pressure: one seed gives almost the same packing at each.
fn without_pressure(member: &str) -> String {
    let Some((before, after)) = member.split_once("-pressure=") else { return member.to_owned() };
    let rest = after.find('-').map_or("", |end| &after[end..]);
    format!("{before}{rest}")
}

/// The first `preparation` cells grouped by identify the preparation, those after them the packing.
fn sample(row: &Row, preparation: usize, path: &Path, line: u64) -> Result<CalibrationSample, String> {
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
        packing: without_pressure(&packing.join(" ")),
        file: path.display().to_string(),
        place: format!("{}, line {line}", path.display()),
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
