//! The state of a row.

use super::Columns;
use crate::commands::invert::cells::cells;
use crate::commands::invert::lines::LONGEST;
use crate::commands::invert::state::State;
use emt::{Conditions, Measured, Moduli, Observation, Structure};
use grains::{Anisotropy, Stiffness};
use std::borrow::Cow;

/// A row that is a state.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) state: State,
    /// Cells of the columns to group by.
    pub(crate) group: Vec<String>,
}

/// A row that is none.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BadRow {
    pub(crate) sample: Option<String>,
    pub(crate) fault: String,
}

impl Columns {
    /// The state of a line; `None` of one that is blank or a comment.
    pub(crate) fn row(&self, line: &[u8]) -> Option<Result<Row, BadRow>> {
        if line.first() == Some(&b'#') || line.iter().all(u8::is_ascii_whitespace) {
            return None;
        }
        let anonymous = |fault: String| BadRow { sample: None, fault };
        if line.len() > LONGEST {
            return Some(Err(anonymous(format!("it is longer than {} kB", LONGEST >> 10))));
        }
        let split = std::str::from_utf8(line).map_err(|_| "it is no text (UTF-8)".to_owned()).and_then(cells);
        let cells = match split {
            Ok(cells) => cells,
            Err(fault) => return Some(Err(anonymous(fault))),
        };
        if cells.len() != self.names.len() {
            let fault = format!("{} cells under {} columns", cells.len(), self.names.len());
            return Some(Err(anonymous(fault)));
        }
        let cells = Cells { names: &self.names, cells: &cells };
        let state = self.state(&cells).map_err(|fault| BadRow { sample: self.sample(&cells), fault });
        let group = self.group.iter().map(|c| group_label(cells.text(*c))).collect();
        Some(state.map(|state| Row { state, group }))
    }

    fn sample(&self, cells: &Cells<'_>) -> Option<String> {
        if let Some(column) = self.sample {
            return Some(cells.text(column).to_owned());
        }
        let source = cells.text(self.source?);
        // One recording holds many packings.
        Some(match self.step {
            Some(step) => format!("{source} step {}", cells.text(step)),
            None => source.to_owned(),
        })
    }

    fn state(&self, cells: &Cells<'_>) -> Result<State, String> {
        let (column, unit) = self.pressure;
        let pressure = cells.number(column)?;
        let pressure = pressure.ok_or_else(|| format!("column {} is empty", self.names[column]))? * unit;
        let stddev = |column: Option<usize>| Ok::<_, String>(cells.positive(column)?.unwrap_or(0.0));
        let with_stddev = |value: Option<usize>, sigma: Option<usize>| -> Result<_, String> {
            let Some(value) = cells.optional(value)? else { return Ok(None) };
            Ok(Some(Measured { value, stddev: stddev(sigma)? }))
        };
        let mut state = State::at(Measured { value: pressure, stddev: stddev(self.pressure_sigma)? });
        (state.moduli, state.asymmetry) = self.moduli(cells, pressure)?;
        for (sigma, column) in state.sigma.iter_mut().zip(self.sigma) {
            *sigma = cells.positive(column)?;
        }
        let [total, elastic, contact] = cells.several(self.measured_gamma)?;
        Ok(State {
            sample: self.sample(cells),
            relative_error: self.defaults.relative_error,
            theta_printed: cells.optional(self.theta_printed)?,
            gamma: with_stddev(self.gamma, self.gamma_sigma)?,
            measured_gamma: Anisotropy { total, elastic, contact },
            phi: with_stddev(self.phi, self.phi_sigma)?,
            grain_shear_modulus: cells
                .optional(self.grain_shear_modulus)?
                .or(self.defaults.grain_shear_modulus),
            poisson: cells.optional(self.poisson)?.or(self.defaults.poisson),
            truth: Structure::of_values(cells.several(self.truth)?),
            ..state
        })
    }

    /// Those of the stiffness where it is there and not empty, else the ones given; and what is not isotropic about e3.
    fn moduli(&self, cells: &Cells<'_>, pressure: f64) -> Result<(Moduli, Option<f64>), String> {
        let given = Moduli::of_values(cells.several(self.moduli)?);
        let Some(stiffness) = &self.stiffness else { return Ok((given, None)) };
        let entries = cells.several(stiffness.map(Some))?;
        if let Some(empty) = entries.iter().position(Option::is_none) {
            if entries.iter().all(Option::is_none) {
                return Ok((given, None));
            }
            let name = &self.names[stiffness[empty]];
            return Err(format!("column {name} is empty: a stiffness has all its entries, or none"));
        }
        let entries = entries.map(Option::unwrap_or_default);
        let stiffness = Stiffness::from_row_major(&entries);
        let observation = Observation::of_stiffness(&stiffness, Conditions::at(pressure));
        Ok((observation.moduli, observation.asymmetry))
    }
}

/// A cell as the name of a group: a number that is not whole, a pressure as a servo leaves it, to three digits.
fn group_label(cell: &str) -> String {
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() && value.fract() != 0.0 => {
            let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
            rounded.to_string()
        }
        _ => cell.to_owned(),
    }
}

/// The cells of a row.
struct Cells<'a> {
    names: &'a [String],
    cells: &'a [Cow<'a, str>],
}

impl Cells<'_> {
    fn text(&self, column: usize) -> &str {
        &self.cells[column]
    }

    fn number(&self, column: usize) -> Result<Option<f64>, String> {
        let text = self.text(column);
        if text.is_empty() {
            return Ok(None);
        }
        text.parse().map(Some).map_err(|_| format!("column {}: {text:?} is not a number", self.names[column]))
    }

    fn optional(&self, column: Option<usize>) -> Result<Option<f64>, String> {
        column.map_or(Ok(None), |c| self.number(c))
    }

    /// A standard deviation.
    fn positive(&self, column: Option<usize>) -> Result<Option<f64>, String> {
        let Some(column) = column else { return Ok(None) };
        let value = self.number(column)?;
        match value.filter(|v| !(*v >= 0.0 && v.is_finite())) {
            Some(v) => Err(format!("column {}: {v} is no standard deviation", self.names[column])),
            None => Ok(value),
        }
    }

    fn several<const N: usize>(&self, columns: [Option<usize>; N]) -> Result<[Option<f64>; N], String> {
        let mut values = [None; N];
        for (value, column) in values.iter_mut().zip(columns) {
            *value = self.optional(column)?;
        }
        Ok(values)
    }
}
