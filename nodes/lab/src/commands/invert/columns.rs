//! The columns of a table, and the state of a row.

use super::inputs::{INPUTS, Input, Role};
use super::lines::LONGEST;
use super::slips;
use super::splitter::{Cells, Splitter};
use super::state::{Defaults, State};
use grainlab_core::results::QUANTITIES;
use grainlab_core::{Stiffness, Vec3};
use grainlab_emt::{Measured, Moduli};

/// Share of the largest entry of a stiffness up to which two values of one entry are the same, rounded to four digits.
const SAME: f64 = 1e-3;

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
    smooth: Option<usize>,
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
            if let [(_, one, _), (_, other, _), ..] = &found[..] {
                let (one, other) = (&names[*one], &names[*other]);
                return Err(format!(
                    "columns {one} and {other} both contain {}: keep one of them",
                    input.key
                ));
            }
            inputs.extend(found.into_iter().next());
        }
        no_slips(&names, by, stiffness.is_some())?;
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
            smooth: find("smooth")?,
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
        let mut state = State {
            sample: self.sample(cells),
            projected: self.projected,
            ..State::of_defaults(Measured::exact(0.0), &self.defaults)
        };
        for (input, column, factor) in &self.inputs {
            let Some(value) = self.number(cells, *column)? else {
                if input.role == Role::Pressure {
                    return Err(format!("column {} is empty", self.names[*column]));
                }
                continue;
            };
            if input.role == Role::Truth && !value.is_finite() {
                return Err(format!("column {}: {value} is not finite", self.names[*column]));
            }
            if input.role == Role::Stddev && !(value >= 0.0 && value.is_finite()) {
                return Err(format!("column {}: {value} is not a standard deviation", self.names[*column]));
            }
            (input.set)(&mut state, value * factor);
        }
        if let Some(text) = self.contact_law.map(|column| cells.get(column)).filter(|text| !text.is_empty()) {
            state.contact_law = Some(text.parse().map_err(|e| format!("column contact_law: {e}"))?);
        }
        state.smooth = match self.smooth.map_or("", |column| cells.get(column)) {
            "" | "false" => false,
            "true" => true,
            other => return Err(format!("column smooth: {other:?} is not true or false")),
        };
        if let Some(grains) =
            state.grains.filter(|n| !(1.0..=f64::from(u32::MAX)).contains(n) || n.fract() != 0.0)
        {
            return Err(format!("column grains: {grains} is not a number of grains"));
        }
        if let Some(stiffness) = self.stiffness(cells)? {
            self.project(&mut state, &stiffness, &self.axis(cells)?)?;
        }
        for (input, column, _) in self.inputs.iter().filter(|(input, ..)| input.role == Role::Stddev) {
            if !cells.get(*column).is_empty() && (input.get)(&state).is_none() {
                let name = &self.names[*column];
                return Err(format!("column {name} is a standard deviation of a quantity that is not there"));
            }
        }
        Ok(state)
    }

    /// The moduli of a whole stiffness; those in columns of their own must be the same.
    fn project(&self, state: &mut State, stiffness: &Stiffness, axis: &Vec3) -> Result<(), String> {
        let medium = stiffness.transverse_isotropy_about(axis);
        let moduli = Moduli::of_medium(&medium);
        for (modulus, given) in state.moduli.known() {
            let projected = moduli.get(modulus).unwrap_or(f64::NAN);
            if (given - projected).abs() > SAME * stiffness.0.amax() {
                return Err(format!(
                    "{modulus} = {given:e} Pa is not that of the stiffness, {projected:e} Pa: leave one of them out"
                ));
            }
        }
        let skew = 0.5 * (stiffness.0 - stiffness.0.transpose()).amax() / stiffness.0.amax();
        if skew > SAME {
            state.notes.push(format!(
                "the stiffness is not symmetric, by {:.1} % of its largest entry: its symmetric part is used",
                100.0 * skew
            ));
        }
        let symmetric = 0.5 * (stiffness.0 + stiffness.0.transpose());
        if symmetric.symmetric_eigenvalues().min() < -SAME * symmetric.amax() {
            return Err("the stiffness is not positive definite: no stable medium has it".to_owned());
        }
        (state.moduli, state.asymmetry) = (moduli, Some(medium.residual));
        Ok(())
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

/// Refuses a column that is not read, is not to group by, and is named almost like one that is read, or is one of a part of
/// the entries of a stiffness.
fn no_slips(names: &[String], by: &[String], has_stiffness: bool) -> Result<(), String> {
    let entries: Vec<String> = (0..36).map(|n| format!("c{}{}_pa", n / 6 + 1, n % 6 + 1)).collect();
    let mut read: Vec<&str> = INPUTS.iter().flat_map(|i| i.names()).map(|alias| alias.name).collect();
    read.extend(["contact_law", "smooth", "reference_axis_x", "reference_axis_y", "reference_axis_z"]);
    let printed: Vec<String> = QUANTITIES.iter().flat_map(|q| q.columns()).collect();
    let labels = ["sample", "source", "step"];
    for name in names {
        let is_known = labels.contains(&name.as_str()) || read.contains(&name.as_str());
        if is_known || by.contains(name) {
            continue;
        }
        if entries.contains(name) && !has_stiffness {
            return Err(format!(
                "column {name} is an entry of a stiffness, which is read only with all 36 or with one half: rename it to _{name} to \
                 leave it out"
            ));
        }
        let Some(meant) = slips::meant(name, &read) else { continue };
        // An axis changes nothing but a stiffness: moduli of a medium are given about it.
        if meant.starts_with("reference_axis") && !has_stiffness {
            continue;
        }
        // An analysis prints q_over_p beside axial_q_over_p: alone it is probably meant for that.
        let is_there = |alias: &str| names.iter().any(|n| n == alias);
        let names_of_meant = INPUTS.iter().map(|i| i.names()).find(|all| all.iter().any(|a| a.name == meant));
        let meant_is_there =
            is_there(meant) || names_of_meant.is_some_and(|all| all.iter().any(|a| is_there(a.name)));
        if !(printed.contains(name) && meant_is_there) {
            return Err(format!(
                "column {name} is not read, and its name is almost {meant}: rename it, to _{name} if it is something else"
            ));
        }
    }
    Ok(())
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
        let names = "p_pa,g12_pa,g13_pa,theta_pa,ti_c11_pa,ti_c33_pa,ti_c13_pa";
        let printed = state(names, "5e4,1,2,3,4,5,6").unwrap();
        assert_eq!(printed.moduli.values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(Some));
        assert!(printed.projected && !state("p_pa,c11_pa", "5e4,7").unwrap().projected);
    }

    #[test]
    fn a_stiffness_that_contradicts_a_modulus_or_itself_is_refused_or_noted() {
        let mut entries = [0.0; 36];
        for i in 0..3 {
            (0..3).for_each(|j| entries[6 * i + j] = if i == j { 3e8 } else { 1e8 });
            entries[7 * (i + 3)] = 1e8;
        }
        let row = |entries: &[f64; 36], more: &str| {
            let cells: Vec<String> = entries.iter().map(f64::to_string).collect();
            state(
                &format!("p_pa,{},g12_pa", matrix_names().join(",")),
                &format!("5e4,{},{more}", cells.join(",")),
            )
        };
        let g12 = row(&entries, "").unwrap().moduli.get(Modulus::G12).unwrap();
        assert!(row(&entries, &g12.to_string()).unwrap().notes.is_empty());
        assert!(row(&entries, "1e6").unwrap_err().contains("is not that of the stiffness"));
        entries[1] *= 1.05;
        assert!(row(&entries, "").unwrap().notes[0].contains("not symmetric"));
        (entries[4], entries[24]) = (1e9, 1e9);
        assert!(row(&entries, "").unwrap_err().contains("not positive definite"));
    }

    #[test]
    fn grains_are_counted_and_the_truth_is_a_number() {
        for grains in ["0", "-3", "2.5", "nan", "inf"] {
            assert!(
                state("p_pa,g12_pa,grains", &format!("5e4,1,{grains}"))
                    .unwrap_err()
                    .contains("number of grains")
            );
        }
        assert!(state("p_pa,g12_pa,k", "5e4,1,nan").unwrap_err().contains("column k"));
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

    fn refused(header: &str) -> String {
        Columns::of_header(header.as_bytes(), &[], Defaults::default()).err().unwrap_or_default()
    }

    #[test]
    fn two_columns_of_one_modulus_are_refused_unless_one_is_an_entry_of_a_whole_stiffness() {
        let twice = refused("p_pa,g12_pa,c66_pa");
        assert!(twice.contains("g12_pa and c66_pa both contain g12_pa"), "{twice}");
        assert!(refused("p_pa,ti_c11_pa,c11_pa").contains("both contain"));
        assert!(refused("p_kpa,pressure_pa,g12_pa").contains("both contain"));
        assert_eq!(refused(&format!("p_pa,g12_pa,ti_c11_pa,{}", matrix_names().join(","))), "");
    }

    #[test]
    fn a_column_that_is_almost_one_that_is_read_is_refused_by_both_names() {
        for (column, meant) in
            [("G13_PA", "g13_pa"), ("g12_sigma", "g12_sigma_pa"), ("q_over_p", "axial_q_over_p")]
        {
            let fault = refused(&format!("p_pa,g12_pa,{column}"));
            assert!(fault.contains(column) && fault.contains(&format!("almost {meant}:")), "{fault}");
            assert_eq!(refused(&format!("p_pa,g12_pa,_{column}")), "");
        }
        assert_eq!(refused("name,operator,mu2,p_pa,g12_pa,stddev_c11_pa"), "");
        assert!(refused("p_pa,c11_pa,c12_pa").contains("c12_pa is an entry of a stiffness"));
    }

    #[test]
    fn smooth_grains_of_an_analysis_and_errors_of_what_is_not_there_are_not_overlooked() {
        assert!(state("p_pa,g12_pa,smooth", "5e4,1e8,true").unwrap().smooth);
        assert!(!state("p_pa,g12_pa,smooth", "5e4,1e8,").unwrap().smooth);
        assert!(state("p_pa,g12_pa,smooth", "5e4,1e8,maybe").unwrap_err().contains("not true or false"));
        let lonely = state("p_pa,g12_pa,axial_q_over_p,axial_q_over_p_sigma", "5e4,1e8,,0.1").unwrap_err();
        assert!(lonely.contains("column axial_q_over_p_sigma is a standard deviation"), "{lonely}");
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
}
