//! The columns of a table, and the state of a row.

use super::inputs::{INPUTS, Input, Role};
use super::lines::LONGEST;
use super::state::State;
use csv_core::{ReadRecordResult, Terminator};
use grainlab_core::{Stiffness, Vec3};
use grainlab_emt::{Measured, Moduli};

/// Inputs common to all rows without their own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Defaults {
    pub(crate) relative_error: Option<f64>,
    pub(crate) grain_shear_modulus: Option<f64>,
    pub(crate) poisson: Option<f64>,
}

/// Positions of the inputs in a row. Other columns are ignored.
pub(crate) struct Columns {
    names: Vec<String>,
    /// Inputs with their column, and its unit in SI.
    inputs: Vec<(&'static Input, usize, f64)>,
    /// All 36 entries of a stiffness, row by row. With them, columns C11, C33 and C13 are entries of a
    /// matrix; the moduli are those of its projection.
    stiffness: Option<[usize; 36]>,
    /// Axis of the projection, to which moduli, strain ratios and truth refer, too; e3 by default.
    reference_axis: Option<[usize; 3]>,
    /// Whether the moduli have the names of the projection that `grainlab analyze` prints.
    projected: bool,
    contact_law: Option<usize>,
    sample: Option<usize>,
    source: Option<usize>,
    step: Option<usize>,
    group: Vec<usize>,
    defaults: Defaults,
}

/// A valid row.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) state: State,
    /// Cells of the columns to group by.
    pub(crate) group: Vec<String>,
}

/// An invalid row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BadRow {
    pub(crate) sample: Option<String>,
    pub(crate) fault: String,
}

impl Columns {
    /// From a header line; rows are grouped by the columns named in `by`.
    pub(crate) fn of_header(line: &[u8], by: &[String], defaults: Defaults) -> Result<Self, String> {
        let mut splitter = Splitter::new();
        let names = splitter.cells(line).map_err(|fault| format!("the header: {fault}"))?;
        let names: Vec<String> = names.iter().map(str::to_owned).collect();
        let find = |name: &str| -> Result<Option<usize>, String> {
            let mut at = names.iter().enumerate().filter(|(_, n)| *n == name).map(|(i, _)| i);
            match (at.next(), at.next()) {
                (found, None) => Ok(found),
                _ => Err(format!("column {name} is there twice")),
            }
        };
        let there = || format!("there are: {}", names.join(", "));
        let stiffness = stiffness_columns(&find)?;
        let mut inputs = Vec::new();
        for input in INPUTS {
            let mut found = Vec::new();
            for alias in input.names() {
                // With the entries of a stiffness, the aliases of a modulus are these entries.
                let is_entry = stiffness.is_some() && input.role == Role::Modulus && alias.name != input.key;
                if let Some(column) = find(alias.name)?.filter(|_| !is_entry) {
                    found.push((input, column, alias.factor));
                }
            }
            if let (Role::Pressure, [(_, one, _), (_, other, _), ..]) = (input.role, &found[..]) {
                let (one, other) = (&names[*one], &names[*other]);
                return Err(format!("columns {one} and {other} both contain the pressure: keep one of them"));
            }
            inputs.extend(found.into_iter().next());
        }
        let has = |role: Role| inputs.iter().any(|(input, ..)| input.role == role);
        if stiffness.is_none() && !has(Role::Modulus) {
            let moduli: Vec<&str> =
                INPUTS.iter().filter(|i| i.role == Role::Modulus).map(|i| i.key).collect();
            return Err(format!("no column of a modulus ({}); {}", moduli.join(", "), there()));
        }
        if !has(Role::Pressure) {
            return Err(format!("no column of the pressure (p_kpa, p_pa or pressure_pa); {}", there()));
        }
        let group = by
            .iter()
            .map(|name| find(name)?.ok_or_else(|| format!("no column {name} to group by; {}", there())));
        Ok(Self {
            inputs,
            projected: stiffness.is_some() || find("ti_c11_pa")?.is_some(),
            stiffness,
            reference_axis: axis_columns(&find)?,
            contact_law: find("contact_law")?,
            sample: find("sample")?,
            source: find("source")?,
            step: find("step")?,
            group: group.collect::<Result<_, String>>()?,
            defaults,
            names,
        })
    }

    /// Whether a column contains the truth of an estimate.
    pub(crate) fn has_truth(&self) -> bool {
        self.inputs.iter().any(|(input, ..)| input.role == Role::Truth)
    }

    /// The state of a line; `None` if it is blank or a comment.
    pub(crate) fn row(&self, line: &[u8], splitter: &mut Splitter) -> Option<Result<Row, BadRow>> {
        if line.first() == Some(&b'#') || line.iter().all(u8::is_ascii_whitespace) {
            return None;
        }
        let anonymous = |fault: String| BadRow { sample: None, fault };
        if line.len() > LONGEST {
            return Some(Err(anonymous(format!("it is longer than {} kB", LONGEST >> 10))));
        }
        let cells = match splitter.cells(line) {
            Ok(cells) => cells,
            Err(fault) => return Some(Err(anonymous(fault.to_owned()))),
        };
        if cells.len() != self.names.len() {
            let fault = format!("{} cells under {} columns", cells.len(), self.names.len());
            return Some(Err(anonymous(fault)));
        }
        let state = self.state(&cells).map_err(|fault| BadRow { sample: self.sample(&cells), fault });
        let group = self.group.iter().map(|c| group_label(cells.get(*c))).collect();
        Some(state.map(|state| Row { state, group }))
    }

    fn sample(&self, cells: &Cells<'_>) -> Option<String> {
        if let Some(column) = self.sample {
            return Some(cells.get(column).to_owned());
        }
        let source = cells.get(self.source?);
        // One recording may contain many packings.
        Some(match self.step {
            Some(step) => format!("{source} step {}", cells.get(step)),
            None => source.to_owned(),
        })
    }

    fn state(&self, cells: &Cells<'_>) -> Result<State, String> {
        let Defaults { relative_error, grain_shear_modulus, poisson } = self.defaults;
        let mut state = State {
            sample: self.sample(cells),
            projected: self.projected,
            relative_error,
            grain_shear_modulus,
            poisson,
            ..State::at(Measured::exact(0.0))
        };
        for (input, column, factor) in &self.inputs {
            let Some(value) = self.number(cells, *column)? else {
                if input.role == Role::Pressure {
                    return Err(format!("column {} is empty", self.names[*column]));
                }
                continue;
            };
            if input.role == Role::Stddev && !(value >= 0.0 && value.is_finite()) {
                return Err(format!("column {}: {value} is not a standard deviation", self.names[*column]));
            }
            (input.set)(&mut state, value * factor);
        }
        if let Some(text) = self.contact_law.map(|column| cells.get(column)).filter(|text| !text.is_empty()) {
            state.contact_law = Some(text.parse().map_err(|e| format!("column contact_law: {e}"))?);
        }
        if let Some(stiffness) = self.stiffness(cells)? {
            let medium = stiffness.transverse_isotropy_about(&self.axis(cells)?);
            (state.moduli, state.asymmetry) = (Moduli::of_medium(&medium), Some(medium.residual));
        }
        Ok(state)
    }

    fn number(&self, cells: &Cells<'_>, column: usize) -> Result<Option<f64>, String> {
        let text = cells.get(column);
        if text.is_empty() {
            return Ok(None);
        }
        text.parse().map(Some).map_err(|_| format!("column {}: {text:?} is not a number", self.names[column]))
    }

    fn numbers<const N: usize>(
        &self,
        cells: &Cells<'_>,
        columns: &[usize; N],
    ) -> Result<[Option<f64>; N], String> {
        let mut values = [None; N];
        for (value, column) in values.iter_mut().zip(columns) {
            *value = self.number(cells, *column)?;
        }
        Ok(values)
    }

    /// The stiffness, if its columns exist and are not empty.
    fn stiffness(&self, cells: &Cells<'_>) -> Result<Option<Stiffness>, String> {
        let Some(columns) = &self.stiffness else { return Ok(None) };
        let entries = self.numbers(cells, columns)?;
        if let Some(empty) = entries.iter().position(Option::is_none) {
            if entries.iter().all(Option::is_none) {
                return Ok(None);
            }
            let name = &self.names[columns[empty]];
            return Err(format!("column {name} is empty: a stiffness has all its entries, or none"));
        }
        Ok(Some(Stiffness::from_row_major(&entries.map(Option::unwrap_or_default))))
    }

    /// The reference axis, a unit vector; e3 by default.
    fn axis(&self, cells: &Cells<'_>) -> Result<Vec3, String> {
        let Some(columns) = &self.reference_axis else { return Ok(Vec3::z()) };
        let axis = self.numbers(cells, columns)?;
        if axis == [None; 3] {
            return Ok(Vec3::z());
        }
        let axis = Vec3::from(axis.map(|c| c.unwrap_or(f64::NAN)));
        // Unchanged if it is e3, so that there is no rounding.
        let unit = if axis == Vec3::z() { axis } else { axis.normalize() };
        if unit.iter().all(|c| c.is_finite()) {
            Ok(unit)
        } else {
            Err("columns reference_axis_x, reference_axis_y, reference_axis_z are not a direction".to_owned())
        }
    }
}

/// Columns reference_axis_x, _y, _z: all or none of them.
fn axis_columns(find: &impl Fn(&str) -> Result<Option<usize>, String>) -> Result<Option<[usize; 3]>, String> {
    let [x, y, z] = ["reference_axis_x", "reference_axis_y", "reference_axis_z"].map(find);
    match [x?, y?, z?] {
        [Some(x), Some(y), Some(z)] => Ok(Some([x, y, z])),
        [None, None, None] => Ok(None),
        _ => {
            Err("columns reference_axis_x, reference_axis_y, reference_axis_z: all three or none".to_owned())
        }
    }
}

/// Columns c11_pa to c66_pa if each entry exists, or its transposed one.
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

/// A cell as the name of a group: numbers that are not whole, such as the pressure at the end of a servoed
/// phase, to three digits.
fn group_label(cell: &str) -> String {
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() && value.fract() != 0.0 => {
            let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
            rounded.to_string()
        }
        _ => cell.to_owned(),
    }
}

/// Splits lines into cells. A cell in quotes may contain commas and doubled quotes, but no line break, so
/// that an invalid cell affects only its line. Space around a cell is ignored.
pub(crate) struct Splitter {
    reader: csv_core::Reader,
    text: Vec<u8>,
    ends: Vec<usize>,
}

/// The cells of a line.
struct Cells<'a> {
    text: &'a str,
    ends: &'a [usize],
}

impl Splitter {
    pub(crate) fn new() -> Self {
        let reader = csv_core::ReaderBuilder::new().terminator(Terminator::Any(b'\n')).build();
        Self { reader, text: Vec::new(), ends: Vec::new() }
    }

    fn cells(&mut self, line: &[u8]) -> Result<Cells<'_>, &'static str> {
        // One more place than needed, so that a full buffer is distinct from an empty one.
        self.text.resize(self.text.len().max(line.len() + 1), 0);
        let most = 2 + line.iter().filter(|b| **b == b',').count();
        self.ends.resize(self.ends.len().max(most), 0);
        self.reader.reset();
        let (_, _, written, ended) = self.reader.read_record(line, &mut self.text, &mut self.ends);
        let (result, _, more, last) =
            self.reader.read_record(b"\n", &mut self.text[written..], &mut self.ends[ended..]);
        if result != ReadRecordResult::Record {
            return Err("a quote is not closed on its line");
        }
        let text = std::str::from_utf8(&self.text[..written + more]).map_err(|_| "it is not UTF-8 text")?;
        Ok(Cells { text, ends: &self.ends[..ended + last] })
    }
}

impl<'a> Cells<'a> {
    fn len(&self) -> usize {
        self.ends.len()
    }

    fn get(&self, column: usize) -> &'a str {
        let start = column.checked_sub(1).map_or(0, |before| self.ends[before]);
        self.text[start..self.ends[column]].trim()
    }

    fn iter(&self) -> impl Iterator<Item = &'a str> + '_ {
        (0..self.len()).map(|column| self.get(column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_emt::Modulus;

    fn columns(header: &str) -> Columns {
        Columns::of_header(header.as_bytes(), &[], Defaults::default()).unwrap()
    }

    fn state(header: &str, row: &str) -> Result<State, String> {
        columns(header)
            .row(row.as_bytes(), &mut Splitter::new())
            .unwrap()
            .map(|r| r.state)
            .map_err(|bad| bad.fault)
    }

    fn matrix_names() -> Vec<String> {
        (0..36).map(|n| format!("c{}{}_pa", n / 6 + 1, n % 6 + 1)).collect()
    }

    #[test]
    fn three_constants_are_moduli_and_a_whole_stiffness_is_projected() {
        let few = state("p_pa,c11_pa,c33_pa,c13_pa", "5e4,300,200,100").unwrap();
        assert_eq!(few.moduli.values(), [None, None, None, Some(300.0), Some(200.0), Some(100.0)]);
        assert_eq!(few.asymmetry, None);

        // C11 ≠ C22: neither is the modulus of the projection.
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

        // About the axis of the row, which is in the columns of a packing measured about it.
        let axis = "reference_axis_x,reference_axis_y,reference_axis_z";
        let about = |cells: &str| {
            state(&format!("p_pa,{},{axis}", matrix_names().join(",")), &format!("5e4,{row},{cells}"))
        };
        let turned = Stiffness::from_row_major(&entries).transverse_isotropy_about(&Vec3::x());
        assert_eq!(about("2,0,0").unwrap().moduli, Moduli::of_medium(&turned));
        assert_eq!(about("0,0,1").unwrap().moduli, full.moduli);
        assert_eq!(about(",,").unwrap().moduli, full.moduli);
        assert!(about("0,0,0").unwrap_err().contains("not a direction"));

        // One half of the matrix suffices.
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
    fn negative_errors_are_refused() {
        let fault = state("p_pa,g12_pa,g12_sigma_pa", "5e4,1e8,-1e6").unwrap_err();
        assert!(fault.contains("g12_sigma_pa") && fault.contains("-1000000"), "{fault}");
    }

    #[test]
    fn blank_lines_and_comments_are_no_rows() {
        let columns = columns("p_pa,g12_pa");
        for line in ["", "   ", "# 5e4,1e8"] {
            assert!(columns.row(line.as_bytes(), &mut Splitter::new()).is_none(), "{line:?}");
        }
        assert!(columns.row(b"\xff,1", &mut Splitter::new()).unwrap().unwrap_err().fault.contains("UTF-8"));
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

    #[test]
    fn quoted_cells_hold_commas_and_quotes() {
        let mut splitter = Splitter::new();
        for (line, expected) in [
            ("a, b ,", &["a", "b", ""][..]),
            ("\"x, y\",1", &["x, y", "1"]),
            ("1,\"say \"\"no\"\"\",3", &["1", "say \"no\"", "3"]),
            ("\"\",", &["", ""]),
            ("1,a\"b,2", &["1", "a\"b", "2"]),
        ] {
            let cells = splitter.cells(line.as_bytes()).unwrap();
            assert_eq!(cells.iter().collect::<Vec<_>>(), expected, "{line}");
        }
        for line in ["\"a,b", "1,\"a\"\""] {
            assert!(splitter.cells(line.as_bytes()).is_err(), "{line}");
        }
        assert_eq!(splitter.cells(b"1,2").unwrap().len(), 2, "nothing is left of what was refused");
    }
}
