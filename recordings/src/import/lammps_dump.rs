//! LAMMPS dump files in text form, one packing a frame.
//!
//! Taken: the time step, the box (orthogonal or restricted triclinic, periodic), and from the columns `id`,
//! `radius` or `diameter`, positions as `x`, `xu`, `xs` or `xsu` …, `mass`, `vx` …, `omegax` …. Contacts are
//! found from positions, unless a `dump local` with their forces is given beside a single frame
//! ([`ImportOptions::contact_forces`]).

use std::collections::BTreeMap;
use std::iter::Peekable;

use grains::{Mat3, Vec3};

use super::assemble::{self, GrainTable, State};
use super::error::ImportError;
use super::settings::{ImportOptions, Known, Setting};
use super::text::{Line, lines};
use super::{Imported, lammps_cell, lammps_local};

/// The packings of a dump, in order.
///
/// # Errors
/// If the text is malformed, not periodic or not in SI units, or settings are missing.
pub fn packings(text: &str, options: &ImportOptions) -> Result<Vec<Imported>, ImportError> {
    let frames = frames(text)?;
    let several = frames.len() > 1;
    if let (Some(_), true) = (&options.contact_forces, several) {
        let (line, what) = (1, format!("a dump of {} frames with contact forces", frames.len()));
        return Err(ImportError::Unsupported {
            line,
            what,
            reason: "give the forces with one frame at a time",
        });
    }
    let local = options.contact_forces.as_deref().map(lammps_local::contacts).transpose()?;
    let count = frames.len();
    let packing = |(k, frame): (usize, Frame)| {
        let source =
            if several { format!("LAMMPS dump, frame {} of {count}", k + 1) } else { "LAMMPS dump".into() };
        frame.packing(options, local.as_deref(), source)
    };
    frames.into_iter().enumerate().map(packing).collect()
}

struct Frame {
    step: u64,
    origin: Vec3,
    cell: Mat3,
    rows: Vec<Row>,
}

/// An atom before options complete it.
struct Row {
    id: u32,
    radius: Option<f64>,
    mass: Option<f64>,
    position: Vec3,
    scaled: bool,
    velocity: Vec3,
    spin: Vec3,
}

fn frames(text: &str) -> Result<Vec<Frame>, ImportError> {
    let mut frames = Vec::new();
    let mut lines = lines(text).filter(|l| !l.text.trim().is_empty()).peekable();
    let (mut step, mut count, mut cell) = (0, None, None);
    while let Some(line) = lines.next() {
        let Some(item) = line.text.trim().strip_prefix("ITEM:").map(str::trim) else {
            return Err(line.error(format!("ITEM: … expected, found {:?}", line.text)));
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
            if value.text.trim() != "si" {
                let (line, what) = (value.number, format!("units {}", value.text.trim()));
                return Err(ImportError::Unsupported { line, what, reason: "only SI units are (units si)" });
            }
        } else if item == "TIME" {
            follow()?;
        } else if let Some(names) = item.strip_prefix("ATOMS") {
            let (origin, cell) = cell.take().ok_or_else(|| line.error("ATOMS come before BOX BOUNDS"))?;
            let columns = Columns::new(&line, names)?;
            let mut rows = Vec::new();
            while let Some(row) = lines.next_if(|l| !l.text.starts_with("ITEM:")) {
                rows.push(columns.row(&row, rows.len())?);
            }
            if let Some(expected) = count.take().filter(|n| *n != rows.len()) {
                return Err(line.error(format!("{} atoms follow, {expected} were announced", rows.len())));
            }
            frames.push(Frame { step, origin, cell, rows });
        } else {
            skip(&mut lines);
        }
    }
    if frames.is_empty() { Err(ImportError::Empty) } else { Ok(frames) }
}

fn skip<'a>(lines: &mut Peekable<impl Iterator<Item = Line<'a>>>) {
    while lines.next_if(|l| !l.text.starts_with("ITEM:")).is_some() {}
}

/// Origin and edge vectors. LAMMPS writes the bounding box of a tilted cell, not its edges.
fn bounds(item: &Line<'_>, words: &str, rows: [Line<'_>; 3]) -> Result<(Vec3, Mat3), ImportError> {
    let words: Vec<&str> = words.split_whitespace().collect();
    if words.contains(&"abc") {
        let (line, what) = (item.number, "a general triclinic box".into());
        let reason = "dump a restricted triclinic one (dump_modify triclinic/general no)";
        return Err(ImportError::Unsupported { line, what, reason });
    }
    let tilted = words.starts_with(&["xy", "xz", "yz"]);
    let boundaries = &words[if tilted { 3 } else { 0 }..];
    if let Some(other) = boundaries.iter().find(|b| **b != "pp") {
        let (line, what) = (item.number, format!("boundary {other}"));
        return Err(ImportError::Unsupported {
            line,
            what,
            reason: "the cell must be periodic in all directions (pp)",
        });
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

/// Which column holds what.
struct Columns {
    names: BTreeMap<String, usize>,
    id: Option<usize>,
    position: [usize; 3],
    scaled: bool,
}

impl Columns {
    fn new(line: &Line<'_>, names: &str) -> Result<Self, ImportError> {
        let names: BTreeMap<String, usize> =
            names.split_whitespace().enumerate().map(|(k, n)| (n.to_owned(), k)).collect();
        let three = |form: &str| {
            let find = |axis: &str| names.get(&format!("{axis}{form}")).copied();
            Some([find("x")?, find("y")?, find("z")?])
        };
        let forms = [("", false), ("u", false), ("s", true), ("su", true)];
        let Some((position, scaled)) = forms.iter().find_map(|(f, scaled)| Some((three(f)?, *scaled))) else {
            return Err(
                line.error("there are no positions: columns x y z, xu yu zu, xs ys zs or xsu ysu zsu")
            );
        };
        Ok(Self { id: names.get("id").copied(), names, position, scaled })
    }

    fn row(&self, line: &Line<'_>, before: usize) -> Result<Row, ImportError> {
        let words = line.words();
        if words.len() != self.names.len() {
            return Err(line.error(format!("{} columns, {} were announced", words.len(), self.names.len())));
        }
        let number =
            |name: &str| self.names.get(name).map(|&k| line.number::<f64>(name, words[k])).transpose();
        let vector = |name: &str| match ["x", "y", "z"].map(|axis| self.names.get(&format!("{name}{axis}"))) {
            [Some(&x), Some(&y), Some(&z)] => line.vector(name, [words[x], words[y], words[z]]),
            _ => Ok(Vec3::zeros()),
        };
        let radius = number("radius")?.or(number("diameter")?.map(|d| 0.5 * d));
        Ok(Row {
            // Without an id column the order of the rows stands for it.
            id: self.id.map_or(Ok(before as u32 + 1), |k| line.id("id", words[k]))?,
            radius,
            mass: number("mass")?,
            position: line.vector("position", self.position.map(|k| words[k]))?,
            scaled: self.scaled,
            velocity: vector("v")?,
            spin: vector("omega")?,
        })
    }
}

impl Frame {
    fn packing(
        &self,
        options: &ImportOptions,
        contacts: Option<&[assemble::ListedContact]>,
        source: String,
    ) -> Result<Imported, ImportError> {
        let mut grains = GrainTable::default();
        let mut densities = Vec::new();
        for row in &self.rows {
            let radius =
                row.radius.or(options.radius).ok_or_else(|| ImportError::Missing(vec![Setting::Radius]))?;
            let position = if row.scaled { self.origin + self.cell * row.position } else { row.position };
            grains.push(row.id, radius, [position, row.velocity, row.spin]);
            densities.extend(row.mass.map(|m| m / (4.0 / 3.0 * std::f64::consts::PI * radius.powi(3))));
        }
        // Masses give the density if they agree on one to what 6 printed digits allow.
        let density =
            densities.first().copied().filter(|d| densities.iter().all(|e| (e / d - 1.0).abs() < 1e-5));
        let settings = Known { cell: Some(self.cell), density, ..Known::default() }.complete(options)?;
        let grains = grains.sorted_by_id().folded_if_far(&settings.cell);
        assemble::packing(grains, &settings, contacts, State::at(self.step), source, Vec::new())
    }
}
