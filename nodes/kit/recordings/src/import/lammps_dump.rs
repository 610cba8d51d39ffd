//! LAMMPS dump files in text form, one packing per frame.
//!
//! It reads the time step, the box (orthogonal or restricted triclinic, periodic), and from the columns `id`,
//! `radius` or `diameter`, positions as `x`, `xu`, `xs` or `xsu` …, `mass`, `vx` …, `omegax` …. Contacts are
//! found from positions, unless a `dump local` with their forces at the same steps is given
//! ([`ImportOptions::contact_forces`]).

use std::ops::ControlFlow;

use grainlab_core::{Cell, Mat3, Vec3};

use super::assemble::{self, GrainTable, Moment};
use super::columns::{Columns, Names, three};
use super::error::ImportError;
use super::imported::Imported;
use super::lammps_items::{Frame, full_lines, lammps_cell, next_frame};
use super::lammps_local;
use super::settings::{Frames, ImportOptions, Known};
use super::text::Line;

/// The packings of a dump, in order.
///
/// # Errors
/// If the text is invalid, not periodic or not in SI units, or settings are missing.
pub fn packings(text: &str, options: &ImportOptions) -> Result<Vec<Imported>, ImportError> {
    let mut all = Vec::new();
    each(text, options, &mut |imported| {
        all.push(imported);
        ControlFlow::Continue(())
    })?;
    Ok(all)
}

/// Passes the packings of a dump to `take` one by one, in order, until it stops.
///
/// # Errors
/// As [`packings`]; `take` has received the packings before the error.
pub fn each(
    text: &str,
    options: &ImportOptions,
    take: &mut dyn FnMut(Imported) -> ControlFlow<()>,
) -> Result<(), ImportError> {
    let count = text.matches("ITEM: ATOMS").count();
    let mut lines = full_lines(text);
    let mut number = 0;
    while let Some(frame) = next_frame(&mut lines, "ATOMS")? {
        number += 1;
        let is_read = match options.frames {
            Frames::All => true,
            Frames::Last => number == count,
            Frames::Step(step) => frame.step.unwrap_or(0) == step,
        };
        if !is_read {
            continue;
        }
        let source =
            if count > 1 { format!("LAMMPS dump, frame {number} of {count}") } else { "LAMMPS dump".into() };
        if take(packing(&frame, options, source)?).is_break() {
            break;
        }
    }
    if number == 0 { Err(ImportError::empty()) } else { Ok(()) }
}

/// Forms of a position may differ by this fraction of the cell: numbers of six digits do.
const ROUNDING: f64 = 1e-5;

const NAMES: Names = Names {
    first_id: 1,
    radius: "radius",
    density: "density",
    masses: ["mass", ""],
    kind: "type",
    velocity: ["vx", "vy", "vz"],
    spin: ["omegax", "omegay", "omegaz"],
};

/// Forms of a position, and whether each is scaled by the cell.
const FORMS: [([&str; 3], bool); 4] = [
    (["x", "y", "z"], false),
    (["xu", "yu", "zu"], false),
    (["xs", "ys", "zs"], true),
    (["xsu", "ysu", "zsu"], true),
];

/// Origin and edge vectors. LAMMPS writes the bounding box of a tilted cell, not its edges.
fn bounds(item: &Line<'_>, words: &str, rows: &[Line<'_>; 3]) -> Result<(Vec3, Mat3), ImportError> {
    let words: Vec<&str> = words.split_whitespace().collect();
    // A line has the bounds of one direction and its tilt, or an edge vector and a component of the origin.
    let (width, boundaries) = match words[..] {
        ["abc", "origin", ref rest @ ..] => (4, rest),
        ["xy", "xz", "yz", ref rest @ ..] => (3, rest),
        ref rest => (2, rest),
    };
    if let Some(other) = boundaries.iter().find(|b| **b != "pp") {
        let reason = "the cell must be periodic in all directions (pp)";
        return Err(ImportError::unsupported(item.number, format!("boundary {other}"), reason));
    }
    let mut numbers = [[0.0; 4]; 3];
    for (row, numbers) in rows.iter().zip(&mut numbers) {
        let words = row.words();
        if words.len() != width {
            return Err(row.error(format!("a bound has {width} numbers, not {}", words.len())));
        }
        for (word, number) in words.iter().zip(numbers) {
            *number = row.finite("a bound", word)?;
        }
    }
    if width == 4 {
        return Ok((numbers.map(|n| n[3]).into(), Mat3::from_fn(|r, c| numbers[c][r])));
    }
    let (mut low, mut high, tilt) = (numbers.map(|n| n[0]), numbers.map(|n| n[1]), numbers.map(|n| n[2]));
    let [xy, xz, yz] = tilt;
    let spread = |values: &[f64]| values.iter().fold((0.0f64, 0.0f64), |(a, b), v| (a.min(*v), b.max(*v)));
    for (k, values) in [vec![xy, xz, xy + xz], vec![yz], vec![]].iter().enumerate() {
        let (least, most) = spread(values);
        (low[k], high[k]) = (low[k] - least, high[k] - most);
    }
    Ok((low.into(), lammps_cell(std::array::from_fn(|k| high[k] - low[k]), tilt)))
}

fn packing(frame: &Frame<'_>, options: &ImportOptions, source: String) -> Result<Imported, ImportError> {
    let Frame { step, time, bounds: stated, head, names, rows } = frame;
    let (line, form, sides) = stated.as_ref().ok_or_else(|| head.error("ATOMS come before BOX BOUNDS"))?;
    let (origin, matrix) = bounds(line, form, sides)?;
    if let Some(shape) = names.iter().find(|name| name.starts_with("shape")) {
        let reason = "grains must be single spheres";
        return Err(ImportError::unsupported(head.number, format!("the column {shape}"), reason));
    }
    let columns = Columns::new(head, names, &NAMES)?;
    let forms: Vec<_> = FORMS.iter().filter_map(|(form, s)| Some((three(names, *form)?, *s))).collect();
    let Some(((place, is_scaled), others)) = forms.split_first() else {
        return Err(head.error("there are no positions: columns x y z, xu yu zu, xs ys zs or xsu ysu zsu"));
    };
    let (cell, mut grains) = (Cell::new(matrix), GrainTable::default());
    for line in rows {
        let words = columns.words(line)?;
        let at = |place: &[usize; 3], is_scaled: bool| {
            let given = line.vector("position", place.map(|k| words[k]))?;
            Ok::<_, ImportError>(if is_scaled { origin + matrix * given } else { given })
        };
        let position = at(place, *is_scaled)?;
        for (place, is_scaled) in others {
            let apart = at(place, *is_scaled)? - position;
            let off = cell.map_or(0.0, |cell| assemble::apart_in_cell(&cell, &apart));
            if assemble::is_beyond(off, ROUNDING * matrix.amax()) {
                return Err(line.error(format!("two forms of its position are {off:.3e} m apart")));
            }
        }
        grains.printed.note(place.map(|k| words[k]), if *is_scaled { matrix.amax() } else { 1.0 });
        columns.grain(line, &words, position, options, &mut grains)?;
    }
    let density = grains.density();
    let settings = Known { cell: Some(matrix), density, ..Known::default() }.complete(options)?;
    let grains = grains.sorted_by_id().folded_if_far(&settings.cell);
    let state = Moment { time: *time, ..Moment::at(step.unwrap_or(0)) };
    lammps_local::packing(grains, &settings, options, state, source)
}
