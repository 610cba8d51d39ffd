//! What the columns of a table mean.
//!
//! - [`row`]: the state of each row

mod row;

use super::cells::cells;
use super::state::{MODULUS_KEYS, SIGMA_KEYS};
use grainlab_emt::{Modulus, Quantity};
pub(crate) use row::{BadRow, Row};
use std::borrow::Cow;

/// What holds for every row that does not say otherwise.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Defaults {
    pub(crate) relative_error: Option<f64>,
    pub(crate) grain_shear_modulus: Option<f64>,
    pub(crate) poisson: Option<f64>,
}

/// Where in a row everything is. A column that is not named here is none of ours.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    names: Vec<String>,
    /// Column of the pressure, and its unit in Pa.
    pressure: (usize, f64),
    pressure_sigma: Option<usize>,
    moduli: [Option<usize>; grainlab_emt::MODULI],
    sigma: [Option<usize>; grainlab_emt::MODULI],
    /// All 36 entries of a stiffness, row by row. With them C11, C33 and C13 are entries of a matrix and no moduli of a
    /// medium: those are then its projection.
    stiffness: Option<[usize; 36]>,
    /// Axis that the stiffness is projected about, which moduli, strain ratios and truth are about, too; e3 without.
    reference_axis: Option<[usize; 3]>,
    /// Whether the moduli are named as those that `grainlab analyze` projects a stiffness on.
    projected: bool,
    theta_printed: Option<usize>,
    gamma: Option<usize>,
    gamma_sigma: Option<usize>,
    measured_gamma: [Option<usize>; 3],
    phi: Option<usize>,
    phi_sigma: Option<usize>,
    grain_shear_modulus: Option<usize>,
    poisson: Option<usize>,
    truth: [Option<usize>; grainlab_emt::QUANTITIES],
    sample: Option<usize>,
    source: Option<usize>,
    step: Option<usize>,
    group: Vec<usize>,
    grains: Option<usize>,
    defaults: Defaults,
}

impl Columns {
    /// Of a header line; rows are grouped by the columns named in `by`.
    pub(crate) fn of_header(line: &[u8], by: &[String], defaults: Defaults) -> Result<Self, String> {
        let text = std::str::from_utf8(line).map_err(|_| "the header is no text (UTF-8)")?;
        let names: Vec<String> = cells(text)?.into_iter().map(Cow::into_owned).collect();
        let find = |name: &str| -> Result<Option<usize>, String> {
            let mut at = names.iter().enumerate().filter(|(_, n)| *n == name).map(|(i, _)| i);
            match (at.next(), at.next()) {
                (found, None) => Ok(found),
                _ => Err(format!("column {name} is there twice")),
            }
        };
        let there = || format!("there are: {}", names.join(", "));
        let mut pressure = None;
        for (name, unit) in [("pressure_pa", 1.0), ("p_pa", 1.0), ("p_kpa", 1e3)] {
            let Some(column) = find(name)? else { continue };
            if let Some((other, _)) = pressure {
                let other: &String = &names[other];
                return Err(format!("columns {other} and {name} both say the pressure: which one is meant?"));
            }
            pressure = Some((column, unit));
        }
        let group = by
            .iter()
            .map(|name| find(name)?.ok_or_else(|| format!("no column {name} to group by; {}", there())));
        let stiffness = stiffness_columns(&find)?;
        let mut moduli = find_all(&find, MODULUS_KEYS)?;
        if stiffness.is_none() {
            // The same moduli by their place in the matrix.
            moduli[Modulus::G12 as usize] = moduli[Modulus::G12 as usize].or(find("c66_pa")?);
            moduli[Modulus::G13 as usize] = moduli[Modulus::G13 as usize].or(find("c44_pa")?);
            for modulus in [Modulus::C11, Modulus::C33, Modulus::C13] {
                let at = modulus as usize;
                moduli[at] = find(&format!("ti_{}", MODULUS_KEYS[at]))?.or(moduli[at]);
            }
            if moduli.iter().all(Option::is_none) {
                return Err(format!("no column of a modulus ({}); {}", MODULUS_KEYS.join(", "), there()));
            }
        }
        Ok(Self {
            pressure: pressure.ok_or_else(|| {
                format!("no column of the pressure (p_kpa, p_pa or pressure_pa); {}", there())
            })?,
            pressure_sigma: find("pressure_sigma_pa")?,
            moduli,
            sigma: find_all(&find, SIGMA_KEYS)?,
            projected: stiffness.is_some() || find("ti_c11_pa")?.is_some(),
            stiffness,
            reference_axis: axis_columns(&find)?,
            theta_printed: find("theta_printed_pa")?,
            gamma: find("gamma_over_delta")?,
            gamma_sigma: find("gamma_over_delta_sigma")?,
            measured_gamma: find_all(&find, ["g_total", "g_elastic", "g_contact"])?,
            phi: find("phi")?,
            phi_sigma: find("phi_sigma")?,
            grain_shear_modulus: find("grain_shear_modulus_pa")?,
            poisson: find("poisson")?,
            truth: find_all(&find, Quantity::ALL.map(Quantity::name))?,
            sample: find("sample")?,
            source: find("source")?,
            step: find("step")?,
            group: group.collect::<Result<_, String>>()?,
            grains: find("grains")?,
            defaults,
            names,
        })
    }

    /// Whether a column says what one of these is.
    pub(crate) fn has_truth(&self) -> bool {
        self.truth.iter().any(Option::is_some)
    }
}

/// Columns reference_axis_x, _y, _z: all or none.
fn axis_columns(find: &impl Fn(&str) -> Result<Option<usize>, String>) -> Result<Option<[usize; 3]>, String> {
    let columns = find_all(find, ["reference_axis_x", "reference_axis_y", "reference_axis_z"])?;
    match columns {
        [Some(x), Some(y), Some(z)] => Ok(Some([x, y, z])),
        [None, None, None] => Ok(None),
        _ => {
            Err("columns reference_axis_x, reference_axis_y, reference_axis_z: all three or none".to_owned())
        }
    }
}

/// Columns c11_pa to c66_pa if each entry is there, or its mirror image.
fn stiffness_columns(
    find: &impl Fn(&str) -> Result<Option<usize>, String>,
) -> Result<Option<[usize; 36]>, String> {
    let mut columns = [0; 36];
    for (n, column) in columns.iter_mut().enumerate() {
        let (i, j) = (n / 6 + 1, n % 6 + 1);
        let Some(found) = find(&format!("c{i}{j}_pa"))?.or(find(&format!("c{j}{i}_pa"))?) else {
            return Ok(None);
        };
        *column = found;
    }
    Ok(Some(columns))
}

fn find_all<const N: usize>(
    find: &impl Fn(&str) -> Result<Option<usize>, String>,
    names: [&str; N],
) -> Result<[Option<usize>; N], String> {
    let mut columns = [None; N];
    for (column, name) in columns.iter_mut().zip(names) {
        *column = find(name)?;
    }
    Ok(columns)
}
