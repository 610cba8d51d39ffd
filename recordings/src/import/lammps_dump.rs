//! LAMMPS dump files in text form, one packing per frame.
//!
//! It reads the time step, the box (orthogonal or restricted triclinic, periodic), and from the columns `id`,
//! `radius` or `diameter`, positions as `x`, `xu`, `xs` or `xsu` …, `mass`, `vx` …, `omegax` …. Contacts are
//! found from positions, unless a `dump local` with their forces at the same steps is given
//! ([`ImportOptions::contact_forces`]).

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::iter::Peekable;
use std::ops::ControlFlow;

use grainlab_core::{Mat3, Vec3};

use super::assemble::{self, GrainTable, State};
use super::error::ImportError;
use super::imported::Imported;
use super::lammps_cell::lammps_cell;
use super::lammps_local::{self, Local};
use super::settings::{ImportOptions, Known};
use super::stated;
use super::text::{Line, lines, shown};

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
    let forces = options.contact_forces.as_deref();
    let mut frames = Frames::new(text);
    let mut number = 0;
    while let Some(frame) = frames.next()? {
        number += 1;
        let source =
            if count > 1 { format!("LAMMPS dump, frame {number} of {count}") } else { "LAMMPS dump".into() };
        let of_step = |text| lammps_local::contacts(text, &options.contact_columns, frame.step);
        let local = forces.map(of_step).transpose()?;
        let imported = frame.packing(options, local.as_ref(), source)?;
        local.as_ref().map_or(Ok(()), |local| local.whole(&imported.packing))?;
        if take(imported).is_break() {
            break;
        }
    }
    if number == 0 { Err(ImportError::empty()) } else { Ok(()) }
}

/// Forms of a position may differ by this fraction of the cell: numbers of six digits do.
const ROUNDING: f64 = 1e-5;

struct Frame<'a> {
    step: u64,
    /// s; 0 if the dump has none.
    time: f64,
    origin: Vec3,
    cell: Mat3,
    rows: Vec<Row<'a>>,
}

/// An atom before missing values are taken from the options.
struct Row<'a> {
    line: Line<'a>,
    coordinates: [&'a str; 3],
    id: u32,
    radius: Option<f64>,
    mass: Option<f64>,
    kind: Option<&'a str>,
    /// Forms of the position, and whether each is scaled by the cell.
    positions: Vec<(Vec3, bool)>,
    velocity: Vec3,
    spin: Vec3,
}

/// Reads the frames of a text one at a time: a dump may hold thousands.
struct Frames<'a, L: Iterator<Item = Line<'a>>> {
    lines: Peekable<L>,
}

impl<'a> Frames<'a, std::iter::Empty<Line<'a>>> {
    fn new(text: &'a str) -> Frames<'a, impl Iterator<Item = Line<'a>>> {
        Frames { lines: lines(text).filter(|l| !l.text.trim().is_empty()).peekable() }
    }
}

impl<'a, L: Iterator<Item = Line<'a>>> Frames<'a, L> {
    /// The next frame; `None` at the end of the text.
    fn next(&mut self) -> Result<Option<Frame<'a>>, ImportError> {
        let lines = &mut self.lines;
        let (mut step, mut time, mut count, mut cell) = (0, 0.0, None, None);
        while let Some(line) = lines.next() {
            let Some(item) = line.text.trim().strip_prefix("ITEM:").map(str::trim) else {
                return Err(line.error(format!("ITEM: … expected, found {}", shown(line.text))));
            };
            let mut follow =
                || lines.next().ok_or_else(|| line.error(format!("the file ends within ITEM: {item}")));
            if item == "TIMESTEP" {
                let value = follow()?;
                step = value.number("the time step", value.text)?;
            } else if item == "NUMBER OF ATOMS" {
                let value = follow()?;
                count = Some(value.number::<usize>("the number of atoms", value.text)?);
            } else if let Some(words) = item.strip_prefix("BOX BOUNDS") {
                cell = Some(bounds(&line, words, [follow()?, follow()?, follow()?])?);
            } else if item == "UNITS" {
                let value = follow()?;
                stated::lammps_units(value.number, value.text)?;
            } else if item == "TIME" {
                let value = follow()?;
                time = value.finite("the time", value.text)?;
            } else if let Some(names) = item.strip_prefix("ATOMS") {
                let (origin, cell) = cell.take().ok_or_else(|| line.error("ATOMS come before BOX BOUNDS"))?;
                let columns = Columns::new(&line, names)?;
                let mut rows = Vec::new();
                while let Some(row) = lines.next_if(|l| !l.text.starts_with("ITEM:")) {
                    rows.push(columns.row(&row, rows.len())?);
                }
                if let Some(expected) = count.filter(|n| *n != rows.len()) {
                    return Err(line.error(format!("{} atoms follow, {expected} were announced", rows.len())));
                }
                return Ok(Some(Frame { step, time, origin, cell, rows }));
            } else {
                while lines.next_if(|l| !l.text.starts_with("ITEM:")).is_some() {}
            }
        }
        Ok(None)
    }
}

/// Origin and edge vectors. LAMMPS writes the bounding box of a tilted cell, not its edges.
fn bounds(item: &Line<'_>, words: &str, rows: [Line<'_>; 3]) -> Result<(Vec3, Mat3), ImportError> {
    let words: Vec<&str> = words.split_whitespace().collect();
    let general = words.starts_with(&["abc", "origin"]);
    let tilted = words.starts_with(&["xy", "xz", "yz"]);
    let boundaries = &words[if general {
        2
    } else if tilted {
        3
    } else {
        0
    }..];
    if let Some(other) = boundaries.iter().find(|b| **b != "pp") {
        let reason = "the cell must be periodic in all directions (pp)";
        return Err(ImportError::unsupported(item.number, format!("boundary {other}"), reason));
    }
    if general {
        return edges(rows);
    }
    let (mut low, mut high, mut tilt) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    for (k, row) in rows.iter().enumerate() {
        match (row.words().as_slice(), tilted) {
            ([lo, hi], false) => {
                (low[k], high[k]) = (row.number("lower bound", lo)?, row.number("upper bound", hi)?)
            }
            ([lo, hi, t], true) => {
                (low[k], high[k]) = (row.number("lower bound", lo)?, row.number("upper bound", hi)?);
                tilt[k] = row.number("tilt", t)?;
            }
            (words, _) => {
                let n = if tilted { 3 } else { 2 };
                return Err(row.error(format!("a bound has {n} numbers, not {}", words.len())));
            }
        }
    }
    let [xy, xz, yz] = tilt;
    let spread = |values: &[f64]| values.iter().fold((0.0f64, 0.0f64), |(a, b), v| (a.min(*v), b.max(*v)));
    for (k, values) in [vec![xy, xz, xy + xz], vec![yz], vec![]].iter().enumerate() {
        let (least, most) = spread(values);
        (low[k], high[k]) = (low[k] - least, high[k] - most);
    }
    Ok((low.into(), lammps_cell(std::array::from_fn(|k| high[k] - low[k]), tilt)))
}

/// The column of each quantity.
struct Columns {
    names: BTreeMap<String, usize>,
    id: Option<usize>,
    /// Columns of the position, and whether it is scaled by the cell: one or more forms.
    positions: Vec<([usize; 3], bool)>,
}

impl Columns {
    fn new(line: &Line<'_>, names: &str) -> Result<Self, ImportError> {
        let announced = names.split_whitespace().count();
        let names: BTreeMap<String, usize> =
            names.split_whitespace().enumerate().map(|(k, n)| (n.to_owned(), k)).collect();
        // It is unknown which of the two is meant.
        if names.len() != announced {
            return Err(line.error("a column occurs twice: dump each quantity once"));
        }
        if let Some(shape) = names.keys().find(|name| name.starts_with("shape")) {
            let what = format!("the column {shape}");
            return Err(ImportError::unsupported(line.number, what, "grains must be single spheres"));
        }
        let three = |form: &str| {
            let find = |axis: &str| names.get(&format!("{axis}{form}")).copied();
            Some([find("x")?, find("y")?, find("z")?])
        };
        let forms = [("", false), ("u", false), ("s", true), ("su", true)];
        let positions: Vec<_> =
            forms.iter().filter_map(|(form, scaled)| Some((three(form)?, *scaled))).collect();
        if positions.is_empty() {
            return Err(
                line.error("there are no positions: columns x y z, xu yu zu, xs ys zs or xsu ysu zsu")
            );
        }
        Ok(Self { id: names.get("id").copied(), names, positions })
    }

    fn row<'a>(&self, line: &Line<'a>, before: usize) -> Result<Row<'a>, ImportError> {
        let words = line.words();
        if words.len() != self.names.len() {
            return Err(line.error(format!("{} columns, {} were announced", words.len(), self.names.len())));
        }
        let number = |name: &str| self.names.get(name).map(|&k| line.finite(name, words[k])).transpose();
        let vector = |name: &str| match ["x", "y", "z"].map(|axis| self.names.get(&format!("{name}{axis}"))) {
            [Some(&x), Some(&y), Some(&z)] => line.vector(name, [words[x], words[y], words[z]]),
            _ => Ok(Vec3::zeros()),
        };
        let radius = stated::radius(line, number("radius")?, number("diameter")?)?;
        let of_density = |(density, radius): (f64, f64)| 4.0 / 3.0 * PI * density * radius.powi(3);
        let of_density = number("density")?.zip(radius).map(of_density);
        let mass = number("mass")?;
        stated::same(line, "mass and that of density and radius", mass, of_density)?;
        Ok(Row {
            line: *line,
            coordinates: self.positions[0].0.map(|k| words[k]),
            // Without an id column, the row number is the id.
            id: self.id.map_or(Ok(before as u32 + 1), |k| line.id("id", words[k]))?,
            radius,
            mass: mass.or(of_density),
            kind: self.names.get("type").map(|&k| words[k]),
            positions: self
                .positions
                .iter()
                .map(|(columns, scaled)| Ok((line.vector("position", columns.map(|k| words[k]))?, *scaled)))
                .collect::<Result<_, ImportError>>()?,
            velocity: vector("v")?,
            spin: vector("omega")?,
        })
    }
}

impl Frame<'_> {
    fn packing(
        &self,
        options: &ImportOptions,
        forces: Option<&Local<'_>>,
        source: String,
    ) -> Result<Imported, ImportError> {
        let mut grains = GrainTable::default();
        let at = |&(r, scaled): &(Vec3, bool)| if scaled { self.origin + self.cell * r } else { r };
        for row in &self.rows {
            let radius = grains.radius(row.radius, options)?;
            let position = at(&row.positions[0]);
            if !row.positions[0].1 {
                grains.printed(row.coordinates);
            }
            grains.push(&row.line, row.id, radius, [position, row.velocity, row.spin])?;
            grains.masses.extend(row.mass);
            grains.kinds.extend(row.kind.map(str::to_owned));
        }
        let density = grains.density();
        let settings = Known { cell: Some(self.cell), density, ..Known::default() }.complete(options)?;
        for (row, other) in self.rows.iter().flat_map(|row| row.positions[1..].iter().map(move |r| (row, r)))
        {
            let off = assemble::apart_in_cell(&settings.cell, &(at(other) - at(&row.positions[0])));
            if assemble::is_beyond(off, ROUNDING * self.cell.amax()) {
                return Err(row.line.error(format!("two forms of its position are {off:.3e} m apart")));
            }
        }
        let grains = grains.sorted_by_id().folded_if_far(&settings.cell);
        forces.map_or(Ok(()), |forces| forces.check(&grains, &settings.cell))?;
        let contacts = forces.map(|forces| forces.contacts.as_slice());
        let state = State { time: self.time, ..State::at(self.step) };
        assemble::packing(grains, &settings, contacts, state, source, Vec::new())
    }
}

/// Origin and edge vectors of a general triclinic box: one edge a line, followed by a component of the origin.
fn edges(rows: [Line<'_>; 3]) -> Result<(Vec3, Mat3), ImportError> {
    let (mut origin, mut cell) = (Vec3::zeros(), Mat3::zeros());
    for (k, row) in rows.iter().enumerate() {
        let [x, y, z, o] = *row.words().as_slice() else {
            return Err(
                row.error(format!("an edge has 4 numbers with its origin, not {}", row.words().len()))
            );
        };
        cell.set_column(k, &row.vector("edge vector", [x, y, z])?);
        origin[k] = row.number("origin", o)?;
    }
    Ok((origin, cell))
}
