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

use super::assemble::{self, GrainTable, State};
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
    let mut columns = Columns::of(&first, name)?;
    let (mut cell, mut grains, mut materials) = (None, GrainTable::default(), Vec::new());
    for line in lines {
        if line.text.trim_start().starts_with('#') {
            // With attributes YADE joins the lines of a comment.
            for comment in line.text.split('#').map(str::trim) {
                if let Some(numbers) = comment.strip_prefix("cell") {
                    if cell.replace(edges(&line, numbers)?).is_some() {
                        return Err(line.error("the cell occurs twice"));
                    }
                } else if let Some(names) = comment.strip_prefix("x y z r") {
                    columns.attributes(names);
                }
            }
            continue;
        }
        let material = columns.grain(&line, options, &mut grains)?;
        if !materials.contains(&material) {
            materials.push(material);
        }
    }
    let settings = Known { cell, ..Known::default() }.complete(options)?;
    let mut notes = Vec::new();
    if materials.len() > 1 {
        notes.push(format!(
            "{} materials are in the file; the one given is used for all grains",
            materials.len()
        ));
    }
    let grains = grains.sorted_by_id().folded_if_far(&settings.cell);
    let source = format!("YADE export, {name}");
    assemble::packing(grains, &settings, None, State::at(0), source, notes)
}

/// The column of each quantity.
struct Columns {
    id: Option<usize>,
    /// Column of x; y, z and r follow.
    x: usize,
    material: Option<usize>,
    velocity: Option<usize>,
    spin: Option<usize>,
    /// Number of columns, if the format defines it.
    count: Option<usize>,
}

impl Columns {
    fn of(line: &Line<'_>, format: &str) -> Result<Self, ImportError> {
        let plain = Self { id: None, x: 0, material: None, velocity: None, spin: None, count: None };
        let reason = match format {
            "x_y_z_r" => return Ok(Self { count: Some(4), ..plain }),
            "x_y_z_r_matId" => return Ok(Self { material: Some(4), count: Some(5), ..plain }),
            "id_x_y_z_r_matId" => {
                return Ok(Self { id: Some(0), x: 1, material: Some(5), count: Some(6), ..plain });
            }
            "x_y_z_r_attrs" => return Ok(plain),
            "x_y_z_r_clumpId" => "grains must be single spheres",
            _ => {
                "export with textExt in the format x_y_z_r, x_y_z_r_matId, id_x_y_z_r_matId or x_y_z_r_attrs"
            }
        };
        Err(ImportError::unsupported(line.number, format!("#format {}", cut(format)), reason))
    }

    /// The columns after x, y, z and r, from the comment.
    fn attributes(&mut self, names: &str) {
        let names: Vec<&str> = names.split_whitespace().collect();
        let three = |wanted: [&str; 3]| names.windows(3).position(|w| *w == wanted).map(|k| k + 4);
        self.velocity = three(["vx", "vy", "vz"]);
        self.spin = three(["wx", "wy", "wz"]);
        self.count = (!names.is_empty()).then_some(4 + names.len());
    }

    /// Adds the grain of a row; returns the name of its material.
    fn grain<'a>(
        &self,
        line: &Line<'a>,
        options: &ImportOptions,
        grains: &mut GrainTable,
    ) -> Result<Option<&'a str>, ImportError> {
        let words = line.words();
        let expected = self.count.unwrap_or(words.len().max(4));
        if words.len() != expected {
            return Err(line.error(format!("{} columns, {expected} were announced", words.len())));
        }
        let vector = |name: &str, at: usize| line.vector(name, [words[at], words[at + 1], words[at + 2]]);
        let moving = |name: &str, at: Option<usize>| at.map_or(Ok(Vec3::zeros()), |at| vector(name, at));
        // YADE counts bodies from 0.
        let id = self.id.map_or(Ok(grains.ids.len() as u32), |k| line.id("id", words[k]))?;
        let radius = grains.radius(Some(line.number("radius", words[self.x + 3])?), options)?;
        let vectors = [
            vector("position", self.x)?,
            moving("velocity", self.velocity)?,
            moving("angular velocity", self.spin)?,
        ];
        grains.printed([words[self.x], words[self.x + 1], words[self.x + 2]]);
        grains.push(line, id, radius, vectors)?;
        Ok(self.material.map(|k| words[k]))
    }
}

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
