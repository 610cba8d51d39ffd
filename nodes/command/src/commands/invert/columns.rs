//! The columns of a table, and the state of a row.

use super::inputs::{INPUTS, Input, Role};
use super::slips;
use super::state::State;
use csv::{ReaderBuilder, StringRecord, Terminator};
use grainlab_console::separated;
use grainlab_core::notes::Note;
use grainlab_core::results::QUANTITIES;
use grainlab_core::{Stiffness, Vec3};
use grainlab_emt::{Moduli, Modulus, Probe, check_structure};
use std::io::Read as _;
use std::sync::LazyLock;

/// Share of the largest entry of a stiffness up to which two values of one entry are the same, rounded to four digits.
const SAME: f64 = 1e-3;

/// Longest line of a table, bytes.
const LONGEST: usize = 1 << 20;

/// Columns that describe a row, and set no number of its state.
const LABELS: [&str; 10] = [
    "contact_law",
    "method",
    "probe",
    "smooth",
    "axis_found",
    "friction",
    "sample",
    "source",
    "member",
    "step",
];

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
    /// True if the moduli have the names of the projection that `grainlab analyze` prints.
    projected: bool,
    /// True if `grainlab analyze` or `grainlab probe` wrote the table, as its columns show.
    is_ours: bool,
    /// The columns of [`LABELS`] that are there.
    labels: Vec<(&'static str, usize)>,
    group: Vec<usize>,
    defaults: State,
}

#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) state: State,
    pub(crate) group: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BadRow {
    pub(crate) sample: Option<String>,
    pub(crate) fault: String,
}

impl Columns {
    /// From a header line; rows are grouped by the columns of the first group of `by` that is there, else of the last.
    pub(crate) fn of_header(line: &[u8], by: &[&[String]], defaults: State) -> Result<Self, String> {
        let names = cells(line).map_err(|fault| format!("the header: {fault}"))?;
        let names: Vec<String> = names.iter().map(str::to_owned).collect();
        if names.iter().any(|name| name == "pressure_pa_mean") {
            return Err("the rows are means over seeds (groups.csv): use states.csv beside it".to_owned());
        }
        let by = by.iter().find(|by| by.iter().all(|name| names.contains(name))).or(by.last());
        let by = by.copied().unwrap_or_default();
        let find = |name: &str| -> Result<Option<usize>, String> {
            let mut at = names.iter().enumerate().filter(|(_, n)| *n == name).map(|(i, _)| i);
            match (at.next(), at.next()) {
                (found, None) => Ok(found),
                _ => Err(format!("column {name} is there twice")),
            }
        };
        let mut labels = Vec::new();
        for name in LABELS {
            labels.extend(find(name)?.map(|at| (name, at)));
        }
        let there = || format!("there are: {}", names.join(", "));
        let stiffness = stiffness_columns(&find)?;
        let (entries, ..) = &*NAMES;
        let mut inputs = Vec::new();
        for input in INPUTS.iter() {
            let mut found = Vec::new();
            for alias in input.names() {
                // A column of a whole stiffness is one of its entries, and no modulus of its projection.
                let is_entry = stiffness.is_some() && entries.iter().any(|entry| entry == alias.name);
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
        for (flag, key) in defaults.flags() {
            if let Some((_, column, _)) = inputs.iter().find(|(input, ..)| input.key == key) {
                return Err(format!(
                    "--{flag} contradicts the column {}: leave one of them out",
                    names[*column]
                ));
            }
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
        if defaults.probe.is_some() && labels.iter().any(|(name, _)| *name == "probe") {
            return Err("--probe contradicts the column probe: leave one of them out".to_owned());
        }
        let is_projection = find("ti_c11_pa")?.is_some();
        Ok(Self {
            inputs,
            projected: stiffness.is_some() || is_projection,
            is_ours: find("axis_found")?.is_some() || is_projection && find("eps_stiffness")?.is_some(),
            stiffness,
            reference_axis: axis_columns(&find)?,
            labels,
            group: group.collect::<Result<_, String>>()?,
            defaults,
            names,
        })
    }

    /// Those of these inputs, separated by spaces, that no column contains.
    #[cfg(feature = "studio")]
    pub(crate) fn missing<'a>(&self, keys: &'a str) -> Vec<&'a str> {
        let is_there = |key: &&str| {
            let key = key.trim_start_matches("ti_");
            let of_stiffness = self.stiffness.is_some() && key.ends_with("_pa");
            of_stiffness || self.inputs.iter().any(|(input, ..)| input.key == key)
        };
        keys.split(' ').filter(|key| !is_there(key)).collect()
    }

    pub(crate) fn has_truth(&self) -> bool {
        self.inputs.iter().any(|(input, ..)| matches!(input.role, Role::Truth(_)))
    }

    /// The state of a line; `None` if it is blank or a comment.
    pub(crate) fn row(&self, line: &[u8]) -> Option<Result<Row, BadRow>> {
        if line.first() == Some(&b'#') || line.iter().all(u8::is_ascii_whitespace) {
            return None;
        }
        let anonymous = |fault: String| BadRow { sample: None, fault };
        if line.len() > LONGEST {
            return Some(Err(anonymous(format!("it is longer than {} kB", LONGEST >> 10))));
        }
        let cells = match cells(line) {
            Ok(cells) => cells,
            Err(fault) => return Some(Err(anonymous(fault.to_owned()))),
        };
        if cells.len() != self.names.len() {
            let fault = format!("{} cells under {} columns", cells.len(), self.names.len());
            return Some(Err(anonymous(fault)));
        }
        let state = self.state(&cells).map_err(|fault| BadRow { sample: self.sample(&cells), fault });
        let group = self.group.iter().map(|c| group_label(&cells[*c])).collect();
        Some(state.map(|state| Row { state, group }))
    }

    /// The cell of one of [`LABELS`]; `None` without the column.
    fn label<'a>(&self, cells: &'a StringRecord, name: &str) -> Option<&'a str> {
        self.labels.iter().find(|(label, _)| *label == name).map(|(_, at)| &cells[*at])
    }

    fn sample(&self, cells: &StringRecord) -> Option<String> {
        let label = |name| self.label(cells, name);
        // One recording may contain many packings, as may a member of a campaign.
        let of_source = |source: &str| match label("step") {
            // A table of numbers may have it as 200.0.
            Some(step) => format!("{source} step {}", step.strip_suffix(".0").unwrap_or(step)),
            None => source.to_owned(),
        };
        label("sample").map(str::to_owned).or_else(|| label("source").or(label("member")).map(of_source))
    }

    fn state(&self, cells: &StringRecord) -> Result<State, String> {
        let mut state =
            State { sample: self.sample(cells), projected: self.projected, ..self.defaults.clone() };
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
            input.set(&mut state, value * factor);
            if matches!(input.role, Role::Truth(_)) {
                check_structure(&state.truth).map_err(|e| format!("column {}: {e}", self.names[*column]))?;
            }
        }
        if let Some(text) = self.label(cells, "contact_law").filter(|text| !text.is_empty()) {
            state.conditions.contact_law =
                Some(text.parse().map_err(|e| format!("column contact_law: {e}"))?);
        }
        if let Some(text) = self.label(cells, "probe").filter(|text| !text.is_empty()) {
            state.probe = Some(text.parse().map_err(|e| format!("column probe: {e}"))?);
        } else if self.is_ours && state.probe.is_none() && self.label(cells, "method") != Some("probe") {
            // In a frozen network and in a wave no contact slides. A strain of unknown size may be too large.
            state.probe = Some(Probe::Sticking);
        }
        let smooth = flag(self.label(cells, "smooth"), "smooth")?;
        let friction = self.label(cells, "friction").and_then(|text| text.parse().ok());
        if smooth.is_none() && friction == Some(0.0) {
            let reason =
                "contacts without friction have no tangential springs, and no model can invert their moduli";
            return Err(format!(
                "column friction is 0: {reason}; if springs were added, say so by a column smooth, false"
            ));
        }
        state.conditions.smooth = smooth.unwrap_or(false);
        if flag(self.label(cells, "axis_found"), "axis_found")? == Some(false) {
            let note = "no axis stood out in the wave speeds: the moduli are about e3, which need not be an axis of symmetry";
            state.notes.push(Note::remark(note));
        }
        if let Some(grains) =
            state.grains.filter(|n| !(1.0..=f64::from(u32::MAX)).contains(n) || n.fract() != 0.0)
        {
            return Err(format!("column grains: {grains} is not a number of grains"));
        }
        if let Some(stiffness) = self.stiffness(cells)? {
            self.project(&mut state, &stiffness, &self.axis(cells)?)?;
        } else {
            self.about_e3(cells)?;
        }
        for (input, column, _) in self.inputs.iter().filter(|(input, ..)| input.role == Role::Stddev) {
            if !cells[*column].is_empty() && input.get(&state).is_none() {
                let name = &self.names[*column];
                return Err(format!("column {name} is a standard deviation of a quantity that is not there"));
            }
        }
        let improbable = INPUTS.iter().filter_map(|input| input.improbable_error(&state));
        let remarks: Vec<Note> =
            state.taken_as_exact().into_iter().chain(improbable).map(Note::remark).collect();
        state.notes.extend(remarks);
        Ok(state)
    }

    /// The moduli of a whole stiffness; those in columns of their own must be the same.
    fn project(&self, state: &mut State, stiffness: &Stiffness, axis: &Vec3) -> Result<(), String> {
        let medium = stiffness.transverse_isotropy_about(axis);
        let moduli = Moduli::of_medium(&medium);
        for modulus in Modulus::ALL {
            let Some(given) = state.moduli.get(modulus) else { continue };
            let projected = moduli.get(modulus).unwrap_or(f64::NAN);
            if (given - projected).abs() > SAME * stiffness.0.amax() {
                return Err(format!(
                    "{modulus} = {given:e} Pa is not that of the stiffness, {projected:e} Pa: leave one of them out"
                ));
            }
        }
        let skew = 0.5 * (stiffness.0 - stiffness.0.transpose()).amax() / stiffness.0.amax();
        if skew > SAME {
            state.notes.push(Note::remark(format!(
                "the stiffness is not symmetric, by {:.1} % of its largest entry: its symmetric part is used",
                100.0 * skew
            )));
        }
        let symmetric = 0.5 * (stiffness.0 + stiffness.0.transpose());
        if symmetric.symmetric_eigenvalues().min() < -SAME * symmetric.amax() {
            return Err("the stiffness is not positive definite: no stable medium has it".to_owned());
        }
        (state.moduli, state.asymmetry) = (moduli, Some(medium.residual));
        Ok(())
    }

    /// Refuses entries of a stiffness, which are in the frame of the cell, as moduli about another axis than e3.
    fn about_e3(&self, cells: &StringRecord) -> Result<(), String> {
        let axis = self.axis(cells)?;
        let in_cell = [
            ("c11_pa", "ti_c11_pa"),
            ("c33_pa", "ti_c33_pa"),
            ("c13_pa", "ti_c13_pa"),
            ("c44_pa", "g13_pa"),
            ("c66_pa", "g12_pa"),
        ];
        let given = |column: usize| {
            in_cell.iter().find(|(name, _)| *name == self.names[column] && !cells[column].is_empty())
        };
        match self.inputs.iter().find_map(|(_, column, _)| given(*column)) {
            Some((entry, about_axis)) if axis.xy().norm() > SAME => Err(format!(
                "column {entry} is in the frame of the cell, and the reference axis is ({:.3}, {:.3}, {:.3}): give {about_axis}, which \
                 is about that axis, or all 36 entries of the stiffness",
                axis.x, axis.y, axis.z
            )),
            _ => Ok(()),
        }
    }

    fn number(&self, cells: &StringRecord, column: usize) -> Result<Option<f64>, String> {
        let text = &cells[column];
        if text.is_empty() {
            return Ok(None);
        }
        text.parse().map(Some).map_err(|_| format!("column {}: {text:?} is not a number", self.names[column]))
    }

    fn numbers<const N: usize>(
        &self,
        cells: &StringRecord,
        columns: &[usize; N],
    ) -> Result<[Option<f64>; N], String> {
        let mut values = [None; N];
        for (value, column) in values.iter_mut().zip(columns) {
            *value = self.number(cells, *column)?;
        }
        Ok(values)
    }

    /// The stiffness, if its columns exist and are not empty.
    fn stiffness(&self, cells: &StringRecord) -> Result<Option<Stiffness>, String> {
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
    fn axis(&self, cells: &StringRecord) -> Result<Vec3, String> {
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

/// The cells of a line, without space around them. A cell in quotes may contain commas and doubled quotes, but no line break,
/// so that an invalid cell affects only its line.
fn cells(line: &[u8]) -> Result<StringRecord, &'static str> {
    let text = std::str::from_utf8(line).map_err(|_| separated::NOT_UTF8)?;
    let mut record = StringRecord::with_capacity(line.len(), line.len() / 4);
    if !text.contains('"') {
        text.split(',').for_each(|cell| record.push_field(cell.trim()));
        return Ok(record);
    }
    // A quote that is not closed takes the line end into its cell.
    let reader = ReaderBuilder::new()
        .has_headers(false)
        .terminator(Terminator::Any(b'\n'))
        .from_reader(line.chain(&b"\n"[..]))
        .read_record(&mut record);
    if reader.is_err() || record.iter().any(|cell| cell.contains('\n')) {
        return Err("a quote is not closed on its line");
    }
    record.trim();
    Ok(record)
}

/// A cell that is true or false, in any case; `None` if it is empty or not there.
fn flag(cell: Option<&str>, name: &str) -> Result<Option<bool>, String> {
    match cell.unwrap_or_default().to_ascii_lowercase().as_str() {
        "" => Ok(None),
        "false" => Ok(Some(false)),
        "true" => Ok(Some(true)),
        other => Err(format!("column {name}: {other:?} is not true or false")),
    }
}

/// The names of the entries of a stiffness, row by row.
fn entries() -> Vec<String> {
    (0..36).map(|n| format!("c{}{}_pa", n / 6 + 1, n % 6 + 1)).collect()
}

/// Entries of a stiffness, columns that are read, and columns that an analysis prints.
static NAMES: LazyLock<(Vec<String>, Vec<&str>, Vec<String>)> = LazyLock::new(|| {
    let of_inputs = INPUTS.iter().flat_map(Input::names).map(|alias| alias.name);
    let others = ["contact_law", "probe", "smooth", "axis_found"];
    let axis = ["reference_axis_x", "reference_axis_y", "reference_axis_z"];
    let read = of_inputs.chain(others).chain(axis).collect();
    (entries(), read, QUANTITIES.iter().flat_map(|q| q.columns()).collect())
});

/// Refuses a column that is not read, is not to group by, and is named almost like one that is read, or is one of a part of
/// the entries of a stiffness.
fn no_slips(names: &[String], by: &[String], has_stiffness: bool) -> Result<(), String> {
    let (entries, read, printed) = &*NAMES;
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
        let extended = || slips::extended(name, read).filter(|_| !printed.contains(name));
        let Some(meant) = slips::meant(name, read).or_else(extended) else { continue };
        // An axis changes nothing but a stiffness: moduli of a medium are given about it.
        if meant.starts_with("reference_axis") && !has_stiffness {
            continue;
        }
        // An analysis prints q_over_p and axial_q_over_p: the first alone is probably meant for the second.
        let is_there = |alias: &str| names.iter().any(|n| n == alias);
        let names_of_meant = INPUTS.iter().map(|i| i.names()).find(|all| all.iter().any(|a| a.name == meant));
        let meant_is_there =
            is_there(meant) || names_of_meant.is_some_and(|all| all.iter().any(|a| is_there(a.name)));
        // The errors of a stiffness that an analysis prints are those of the solver.
        if !(printed.contains(name) && (meant_is_there || name.starts_with("stddev_"))) {
            let convert = slips::converted(name, meant).map_or_else(String::new, |(unit, factor)| {
                format!("multiply its values, in {unit}, by {factor} and ")
            });
            return Err(format!(
                "column {name} is not read, and its name is almost {meant}: {convert}rename it, to _{name} if it is something else"
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

/// A cell as a group's name: numbers that are not whole, such as the pressure after a servoed phase, to three digits.
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
mod tests;
