//! The state of a row.

use super::Columns;
use crate::commands::invert::cells::cells;
use crate::commands::invert::lines::LONGEST;
use crate::commands::invert::state::State;
use grainlab_core::{Anisotropy, Stiffness, Vec3};
use grainlab_emt::{Measured, Moduli, Structure};
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
        (state.moduli, state.asymmetry) = self.moduli(cells)?;
        for (sigma, column) in state.sigma.iter_mut().zip(self.sigma) {
            *sigma = cells.positive(column)?;
        }
        let [total, elastic, contact] = cells.several(self.measured_gamma)?;
        Ok(State {
            sample: self.sample(cells),
            projected: self.projected,
            grains: cells.optional(self.grains)?,
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

    /// Those of the stiffness where it is there and not empty, else the ones given; and what is not isotropic about the
    /// reference axis.
    fn moduli(&self, cells: &Cells<'_>) -> Result<(Moduli, Option<f64>), String> {
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
        let medium = stiffness.transverse_isotropy_about(&self.axis(cells)?);
        Ok((Moduli::of_medium(&medium), Some(medium.residual)))
    }

    /// The reference axis, a unit vector; e3 where the row says none.
    fn axis(&self, cells: &Cells<'_>) -> Result<Vec3, String> {
        let Some(columns) = self.reference_axis else { return Ok(Vec3::z()) };
        let axis = cells.several(columns.map(Some))?;
        if axis == [None; 3] {
            return Ok(Vec3::z());
        }
        let axis = Vec3::from(axis.map(|c| c.unwrap_or(f64::NAN)));
        // As it is where it is e3: no rounding then.
        let unit = if axis == Vec3::z() { axis } else { axis.normalize() };
        if unit.iter().all(|c| c.is_finite()) {
            Ok(unit)
        } else {
            Err("columns reference_axis_x, reference_axis_y, reference_axis_z are no direction".to_owned())
        }
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

#[cfg(test)]
mod tests {
    use super::super::Defaults;
    use super::*;
    use grainlab_emt::Modulus;

    fn columns(header: &str) -> Columns {
        Columns::of_header(header.as_bytes(), &[], Defaults::default()).unwrap()
    }

    fn state(header: &str, row: &str) -> Result<State, String> {
        columns(header).row(row.as_bytes()).unwrap().map(|r| r.state).map_err(|bad| bad.fault)
    }

    fn matrix_names() -> Vec<String> {
        (0..36).map(|n| format!("c{}{}_pa", n / 6 + 1, n % 6 + 1)).collect()
    }

    #[test]
    fn three_constants_are_moduli_and_a_whole_stiffness_is_projected() {
        let few = state("p_pa,c11_pa,c33_pa,c13_pa", "5e4,300,200,100").unwrap();
        assert_eq!(few.moduli.values(), [None, None, None, Some(300.0), Some(200.0), Some(100.0)]);
        assert_eq!(few.asymmetry, None);

        // C11 ≠ C22: neither is the modulus of the medium.
        let mut entries = [0.0; 36];
        for (n, value) in [(0, 300.0), (7, 340.0), (14, 280.0), (21, 90.0), (28, 110.0), (35, 95.0)] {
            entries[n] = value;
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            (entries[6 * i + j], entries[6 * j + i]) = (120.0, 120.0);
        }
        let row = entries.map(|e| e.to_string()).join(",");
        let full = state(&format!("p_pa,{}", matrix_names().join(",")), &format!("5e4,{row}")).unwrap();
        let medium = Stiffness::from_row_major(&entries).transverse_isotropy();
        assert_eq!(full.moduli, Moduli::of_medium(&medium));
        assert_eq!(full.asymmetry, Some(medium.residual));
        assert_ne!(full.moduli.get(Modulus::C11), Some(300.0));

        // About the axis of the row, which a packing measured about it has in its columns.
        let axis = "reference_axis_x,reference_axis_y,reference_axis_z";
        let about = |cells: &str| {
            state(&format!("p_pa,{},{axis}", matrix_names().join(",")), &format!("5e4,{row},{cells}"))
        };
        let turned = Stiffness::from_row_major(&entries).transverse_isotropy_about(&Vec3::x());
        assert_eq!(about("2,0,0").unwrap().moduli, Moduli::of_medium(&turned));
        assert_eq!(about("0,0,1").unwrap().moduli, full.moduli);
        assert_eq!(about(",,").unwrap().moduli, full.moduli);
        assert!(about("0,0,0").unwrap_err().contains("no direction"));

        // One half of it says the same.
        let upper: Vec<usize> = (0..36).filter(|n| n / 6 <= n % 6).collect();
        let names = matrix_names();
        let header = upper.iter().map(|n| names[*n].clone()).collect::<Vec<_>>().join(",");
        let row = upper.iter().map(|n| entries[*n].to_string()).collect::<Vec<_>>().join(",");
        let half = state(&format!("p_pa,{header}"), &format!("5e4,{row}")).unwrap();
        assert_eq!(half, full);
    }

    #[test]
    fn the_projection_that_analyze_prints_is_that_of_a_stiffness() {
        let names = "p_pa,g12_pa,g13_pa,theta_pa,ti_c11_pa,ti_c33_pa,ti_c13_pa,c11_pa";
        let printed = state(names, "5e4,1,2,3,4,5,6,7").unwrap();
        assert_eq!(printed.moduli.values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(Some));
        assert!(printed.projected && !state("p_pa,c11_pa", "5e4,7").unwrap().projected);
    }

    #[test]
    fn a_packing_without_stiffness_is_a_row_without_moduli() {
        let header = format!("p_pa,phi,{}", matrix_names().join(","));
        let empty = state(&header, &format!("5e4,0.6{}", ",".repeat(36))).unwrap();
        assert_eq!(empty.moduli, Moduli::NONE);
        let torn = state(&header, &format!("5e4,0.6,1{}", ",".repeat(35))).unwrap_err();
        assert!(torn.contains("c12_pa is empty"), "{torn}");
    }

    #[test]
    fn pressures_are_in_the_unit_that_their_column_names() {
        for header in ["p_kpa,g12_pa", "p_pa,g12_pa", "pressure_pa,g12_pa"] {
            let unit = if header.starts_with("p_kpa") { 1e3 } else { 1.0 };
            assert_eq!(state(header, "50,1").unwrap().pressure.value, 50.0 * unit, "{header}");
        }
        assert!(state("p_pa,g12_pa", ",1").unwrap_err().contains("p_pa is empty"));
    }

    #[test]
    fn errors_are_no_negative_numbers() {
        let fault = state("p_pa,g12_pa,g12_sigma_pa", "5e4,1e8,-1e6").unwrap_err();
        assert!(fault.contains("g12_sigma_pa") && fault.contains("-1000000"), "{fault}");
    }

    #[test]
    fn blank_lines_and_comments_are_no_rows() {
        let columns = columns("p_pa,g12_pa");
        for line in ["", "   ", "# 5e4,1e8"] {
            assert!(columns.row(line.as_bytes()).is_none(), "{line:?}");
        }
        assert!(columns.row(b"\xff,1").unwrap().unwrap_err().fault.contains("UTF-8"));
    }

    #[test]
    fn pressures_as_a_servo_leaves_them_are_one_group_and_whole_numbers_stay() {
        for (cell, label) in [
            ("49998.31", "50000"),
            ("50012.7", "50000"),
            ("0.15", "0.15"),
            ("1017", "1017"),
            ("s1", "s1"),
            ("", ""),
        ] {
            assert_eq!(group_label(cell), label, "{cell}");
        }
    }
}
