//! Frames of a text dump of LAMMPS, which are sections of `ITEM:`, and the cell of dump and data files.

use std::iter::Peekable;

use grainlab_core::Mat3;

use super::error::ImportError;
use super::stated;
use super::text::{Line, lines, shown};

pub(super) struct Frame<'a> {
    pub(super) step: Option<u64>,
    /// s; 0 if the dump has none.
    pub(super) time: f64,
    /// Line of the box, its form and boundaries, and its three lines.
    pub(super) bounds: Option<(Line<'a>, &'a str, [Line<'a>; 3])>,
    /// Line with the names of the columns.
    pub(super) head: Line<'a>,
    pub(super) names: Vec<&'a str>,
    pub(super) rows: Vec<Line<'a>>,
}

/// Lines of a dump that are not empty.
pub(super) fn full_lines(text: &str) -> Peekable<impl Iterator<Item = Line<'_>>> {
    lines(text).filter(|l| !l.text.trim().is_empty()).peekable()
}

/// The next frame with rows of this kind, `ATOMS` or `ENTRIES`; `None` at the end of the text. A dump may hold thousands.
pub(super) fn next_frame<'a>(
    lines: &mut Peekable<impl Iterator<Item = Line<'a>>>,
    kind: &str,
) -> Result<Option<Frame<'a>>, ImportError> {
    let (mut step, mut time, mut count, mut bounds) = (None, 0.0, None, None);
    while let Some(head) = lines.next() {
        let Some(item) = head.text.trim().strip_prefix("ITEM:").map(str::trim) else {
            return Err(head.error(format!("ITEM: … expected, found {}", shown(head.text))));
        };
        let mut follow =
            || lines.next().ok_or_else(|| head.error(format!("the file ends within ITEM: {item}")));
        if item == "TIMESTEP" {
            let value = follow()?;
            step = Some(value.number("the time step", value.text)?);
        } else if item.starts_with("NUMBER OF") {
            let value = follow()?;
            count = Some(value.number::<usize>("the number of rows", value.text)?);
        } else if let Some(form) = item.strip_prefix("BOX BOUNDS") {
            bounds = Some((head, form, [follow()?, follow()?, follow()?]));
        } else if item == "UNITS" {
            let value = follow()?;
            stated::lammps_units(value.number, value.text)?;
        } else if item == "TIME" {
            let value = follow()?;
            time = value.finite("the time", value.text)?;
        } else {
            let mut rows = Vec::new();
            while let Some(row) = lines.next_if(|l| !l.text.starts_with("ITEM:")) {
                rows.push(row);
            }
            let Some(names) = item.strip_prefix(kind) else { continue };
            if let Some(expected) = count.filter(|n| *n != rows.len()) {
                let (found, kind) = (rows.len(), kind.to_lowercase());
                let why = if found < expected { ": the file is truncated" } else { "" };
                return Err(head.error(format!("{found} {kind} follow, {expected} were announced{why}")));
            }
            let names = names.split_whitespace().collect();
            return Ok(Some(Frame { step, time, bounds, head, names, rows }));
        }
    }
    Ok(None)
}

/// The cell of LAMMPS with edge vectors a = (lx, 0, 0), b = (xy, ly, 0), c = (xz, yz, lz), m.
pub(super) fn lammps_cell(lengths: [f64; 3], [xy, xz, yz]: [f64; 3]) -> Mat3 {
    let [lx, ly, lz] = lengths;
    Mat3::new(
        lx, xy, xz, //
        0.0, ly, yz, //
        0.0, 0.0, lz,
    )
}
