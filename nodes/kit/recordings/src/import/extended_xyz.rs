//! Extended XYZ, as OVITO, ASE and `grainlab bag export` write it.
//!
//! Each frame is the number of grains, a comment with `Lattice="..."` and `Properties=...`, and a line per grain. Columns that are
//! read: `pos:R:3`, `radius:R:1` or `diameter:R:1`, and where they are `id:I:1`, `mass:R:1`, `density:R:1`, `velo:R:3`, `angular_velocity:R:3`; SI units. Of the comment also
//! `shear_modulus`, `poisson_ratio`, `density`, `friction`, `contact_law`, `contact_law_parameters`, `Time` and `step`; `units` and
//! `pbc` must be SI and periodic in all directions. Contacts are found from positions.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use grainlab_core::Mat3;
use grainlab_core::contact::ContactLaw;

use super::assemble::{self, GrainTable, Moment};
use super::columns::{Columns, Names, three};
use super::error::ImportError;
use super::imported::Imported;
use super::settings::{ImportOptions, Known};
use super::stated;
use super::text::{Line, lines, shown};

pub(super) fn is_comment(line: &str) -> bool {
    line.contains("Properties=") || line.contains("Lattice=")
}

/// Passes the packings of all frames to `take` one by one, until it stops.
///
/// # Errors
/// If a frame is invalid, or a quantity is missing.
pub fn each(
    text: &str,
    options: &ImportOptions,
    take: &mut dyn FnMut(Imported) -> ControlFlow<()>,
) -> Result<(), ImportError> {
    let mut text = lines(text);
    let mut any = false;
    while let Some(first) = text.find(|l| !l.text.trim().is_empty()) {
        let number = first.text.trim();
        let count: usize =
            number.parse().map_err(|_| first.error(format!("{number:?} is not a number of grains")))?;
        let comment = text.next().ok_or_else(|| first.error("the file ends after the number of grains"))?;
        let frame = Frame::of(&comment)?;
        let mut grains = GrainTable::default();
        for read in 0..count {
            let missing = || first.error(format!("the frame has {read} of {count} grains"));
            frame.grain(&text.next().ok_or_else(missing)?, options, &mut grains)?;
        }
        any = true;
        let density = frame.known.density.or_else(|| grains.density());
        let settings = Known { density, ..frame.known }.complete(options)?;
        let source = format!("extended XYZ, step {}", frame.state.step);
        if take(assemble::packing(grains, &settings, None, frame.state, source, frame.notes)?).is_break() {
            break;
        }
    }
    if any { Ok(()) } else { Err(ImportError::empty()) }
}

const MOST_FIELDS: usize = 1000;

const NAMES: Names = Names {
    first_id: 0,
    radius: "radius",
    density: "density",
    masses: ["mass", "masses"],
    kind: "species",
    velocity: ["velo:0", "velo:1", "velo:2"],
    spin: ["angular_velocity:0", "angular_velocity:1", "angular_velocity:2"],
};

/// The comment of a frame.
struct Frame {
    known: Known,
    state: Moment,
    columns: Columns,
    /// Places of the position.
    position: [usize; 3],
    /// Notes on columns that are not read.
    notes: Vec<String>,
}

impl Frame {
    fn of(line: &Line<'_>) -> Result<Self, ImportError> {
        let entries = entries(line)?;
        let number = |key: &str| entries.get(key).map(|value| line.number(key, value)).transpose();
        let cell = match entries.get("Lattice") {
            None => None,
            Some(text) => {
                let numbers = text.split_whitespace().map(|word| line.number("Lattice", word));
                let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
                if numbers.len() != 9 {
                    return Err(line.error(format!("Lattice has {} numbers; it must have 9", numbers.len())));
                }
                // The edge vectors one after the other. In another order they span the same cell: a left-handed one is turned.
                let mut cell = Mat3::from_column_slice(&numbers);
                if cell.determinant() < 0.0 {
                    cell.swap_columns(1, 2);
                }
                Some(cell)
            }
        };
        let properties = entries.get("Properties").ok_or_else(|| line.error("Properties= is missing"))?;
        // One name for each field: those of a column of several have a number.
        let (mut bases, mut names) = (Vec::new(), Vec::new());
        let parts: Vec<&str> = properties.split(':').collect();
        for column in parts.chunks(3) {
            let [name, _, width] = *column else {
                return Err(line.error("Properties must be a list of name:type:width"));
            };
            // A few bytes could state any number of fields.
            let left = MOST_FIELDS - names.len();
            let width = width.parse().ok().filter(|w| (1..=left).contains(w));
            let width: usize = width.ok_or_else(|| line.error(format!("the width of {name} is invalid")))?;
            if bases.contains(&name) {
                return Err(line.error(format!("the column {name} occurs twice in Properties")));
            }
            bases.push(name);
            match width {
                1 => names.push(name.to_owned()),
                _ => names.extend((0..width).map(|k| format!("{name}:{k}"))),
            }
        }
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let position = three(&names, ["pos:0", "pos:1", "pos:2"]).filter(|_| !names.contains(&"pos:3"));
        entries.get("units").map_or(Ok(()), |units| stated::units(line.number, units))?;
        entries.get("pbc").map_or(Ok(()), |pbc| stated::periodic(line.number, pbc))?;
        let step: Option<u64> = entries.get("step").map(|value| line.number("step", value)).transpose()?;
        Ok(Self {
            known: Known {
                cell,
                shear_modulus: number("shear_modulus")?,
                poisson_ratio: number("poisson_ratio")?,
                density: number("density")?,
                law: law(line, &entries)?,
                friction: number("friction")?,
            },
            state: Moment { time: number("Time")?.unwrap_or(0.0), ..Moment::at(step.unwrap_or(0)) },
            columns: Columns::new(line, &names, &NAMES)?,
            position: position.ok_or_else(|| line.error("Properties has no column pos:R:3"))?,
            notes: unread(&bases),
        })
    }

    fn grain(
        &self,
        line: &Line<'_>,
        options: &ImportOptions,
        grains: &mut GrainTable,
    ) -> Result<(), ImportError> {
        let words = self.columns.words(line)?;
        let position = self.position.map(|k| words[k]);
        grains.printed.note(position, 1.0);
        self.columns.grain(line, &words, line.vector("pos", position)?, options, grains)
    }
}

/// Properties that all grains share: a column of them is not read.
const SHARED: [&str; 3] = ["shear_modulus", "poisson_ratio", "friction"];

/// Notes on columns that are not read: of velocities under other names, and of properties that all grains share.
fn unread(names: &[&str]) -> Vec<String> {
    let is_other = |name: &&&str| {
        let name = name.to_lowercase();
        ["vel", "moment"].iter().any(|of_motion| name.starts_with(of_motion)) && name != "velo"
    };
    let other = names.iter().filter(is_other).filter(|_| !names.contains(&"velo"));
    let other =
        other.map(|name| format!("the column {name} is not read: velocities, velo:R:3, are taken as 0"));
    let shared = names.iter().filter(|name| SHARED.contains(name));
    let shared = shared.map(|name| format!("the column {name} is not read: all grains have the same {name}"));
    other.chain(shared).collect()
}

fn law(line: &Line<'_>, entries: &BTreeMap<&str, &str>) -> Result<Option<ContactLaw>, ImportError> {
    let Some(name) = entries.get("contact_law") else { return Ok(None) };
    let parameters =
        entries.get("contact_law_parameters").into_iter().flat_map(|text| text.split_whitespace());
    let parameters: Vec<f64> =
        parameters.map(|word| line.number("contact_law_parameters", word)).collect::<Result<_, _>>()?;
    ContactLaw::new(name, &parameters).map(Some).map_err(|e| line.error(e.to_string()))
}

/// `key=value` and `key="value with spaces"`, each key once.
fn entries<'a>(line: &Line<'a>) -> Result<BTreeMap<&'a str, &'a str>, ImportError> {
    let mut found = BTreeMap::new();
    let mut rest = line.text.trim();
    while let Some((key, after)) = rest.split_once('=') {
        let key = key.rsplit(char::is_whitespace).next().unwrap_or(key);
        let (value, left) = match after.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"').unwrap_or((quoted, "")),
            None => after.split_once(char::is_whitespace).unwrap_or((after, "")),
        };
        if found.insert(key, value).is_some() {
            return Err(line.error(format!("{} occurs twice", shown(key))));
        }
        rest = left.trim_start();
    }
    Ok(found)
}
