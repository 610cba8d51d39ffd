//! Text exports of YADE: `export.text` and `export.textExt`.
//!
//! The first line names the format: `x_y_z_r`, `x_y_z_r_matId`, `id_x_y_z_r_matId`, and `x_y_z_r_attrs` with
//! the columns in its comment (`vx vy vz`, `wx wy wz` are velocities, others are ignored). The file contains
//! no cell unless it is in the comment, as three edges or as the nine numbers of `O.cell.hSize`:
//!
//! ```python
//! export.textExt('grains.txt', 'id_x_y_z_r_matId', comment='cell ' + str(O.cell.hSize))
//! ```
//!
//! Material and friction are given by options. Contacts are found from positions, and YADE prints six digits:
//! [`EXPORTER`] is a script for YADE that writes all data, including contact forces, as
//! [CSV](crate::import::csv).

use grainlab_core::{Mat3, Vec3};

use super::assemble::{self, GrainTable, Moment};
use super::columns::{Columns, Names, three};
use super::error::ImportError;
use super::imported::Imported;
use super::settings::{ImportOptions, Known};
use super::text::{Line, cut, lines, shown};

/// A script that, run within YADE, writes a packing with its contacts and forces as CSV and JSON.
pub const EXPORTER: &str = include_str!("yade/grainlab_export.py");

/// The packing of an export.
///
/// # Errors
/// If the text is invalid or of another format, or settings are missing.
pub fn packing(text: &str, options: &ImportOptions) -> Result<Imported, ImportError> {
    let mut lines = lines(text).filter(|l| !l.text.trim().is_empty());
    let first = lines.next().ok_or_else(ImportError::empty)?;
    let Some(name) = first.text.trim().strip_prefix("#format").map(str::trim) else {
        return Err(first.error(format!("#format … expected, found {}", shown(first.text))));
    };
    let known = FORMATS.iter().find(|(format, _)| *format == name);
    let mut names = known.map(|(_, names)| names.to_vec()).ok_or_else(|| {
        let reason = match name {
            "x_y_z_r_clumpId" => "grains must be single spheres",
            _ => {
                "export with textExt in the format x_y_z_r, x_y_z_r_matId, id_x_y_z_r_matId or x_y_z_r_attrs"
            }
        };
        ImportError::unsupported(first.number, format_args!("#format {}", cut(name)), reason)
    })?;
    let (mut cell, mut grains, mut columns) = (None, GrainTable::default(), None);
    for line in lines {
        if line.text.trim_start().starts_with('#') {
            // With attributes YADE joins the lines of a comment.
            for comment in line.text.split('#').map(str::trim) {
                if let Some(numbers) = comment.strip_prefix("cell") {
                    if cell.replace(edges(&line, numbers)?).is_some() {
                        return Err(line.error("the cell occurs twice"));
                    }
                } else if let Some(attributes) = comment.strip_prefix("x y z r")
                    && name == "x_y_z_r_attrs"
                {
                    names.truncate(4);
                    names.extend(attributes.split_whitespace());
                    columns = None;
                }
            }
            continue;
        }
        let (columns, place) = match &mut columns {
            Some(known) => known,
            unknown => {
                // Attributes need no names, and are then not read.
                let all = if name.ends_with("attrs") && names.len() == 4 { line.words().len() } else { 0 };
                let more: Vec<String> = (4..all).map(|k| format!("column {k}")).collect();
                let all: Vec<&str> = names.iter().copied().chain(more.iter().map(String::as_str)).collect();
                let place = three(&all, ["x", "y", "z"]).unwrap_or_default();
                unknown.insert((Columns::new(&first, &all, &NAMES)?, place))
            }
        };
        let words = columns.words(&line)?;
        let position = place.map(|k| words[k]);
        grains.printed.note(position, 1.0);
        columns.grain(&line, &words, line.vector("position", position)?, options, &mut grains)?;
    }
    let settings = Known { cell, ..Known::default() }.complete(options)?;
    let grains = grains.sorted_by_id().folded_if_far(&settings.cell);
    let source = format!("YADE export, {name}");
    assemble::packing(grains, &settings, None, Moment::at(0), source, Vec::new())
}

/// Formats and their columns; the names of attributes are in a comment.
const FORMATS: [(&str, &[&str]); 4] = [
    ("x_y_z_r", &["x", "y", "z", "r"]),
    ("x_y_z_r_matId", &["x", "y", "z", "r", "matId"]),
    ("id_x_y_z_r_matId", &["id", "x", "y", "z", "r", "matId"]),
    ("x_y_z_r_attrs", &["x", "y", "z", "r"]),
];

const NAMES: Names = Names {
    // YADE counts bodies from 0.
    first_id: 0,
    radius: "r",
    density: "",
    masses: ["", ""],
    kind: "matId",
    velocity: ["vx", "vy", "vz"],
    spin: ["wx", "wy", "wz"],
};

/// The cell in a comment, with any brackets of Python.
fn edges(line: &Line<'_>, text: &str) -> Result<Mat3, ImportError> {
    let words = text.split(|c: char| c.is_whitespace() || "()[]{},;:=".contains(c));
    let words: Vec<&str> = words.filter(|w| !w.is_empty() && !w.starts_with(char::is_alphabetic)).collect();
    let numbers = words.iter().map(|w| line.finite("cell", w)).collect::<Result<Vec<_>, _>>()?;
    match numbers.as_slice() {
        [x, y, z] => Ok(Mat3::from_diagonal(&Vec3::new(*x, *y, *z))),
        nine if nine.len() == 9 => Ok(Mat3::from_row_slice(nine)),
        other => Err(line.error(format!("a cell has 3 or 9 numbers, not {}", other.len()))),
    }
}
