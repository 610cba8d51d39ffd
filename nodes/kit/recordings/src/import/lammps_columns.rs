//! Check that the columns of a LAMMPS `dump local` are what they are taken for: a normal force is along the line between the
//! centres, a tangential one across it.

use std::collections::BTreeMap;

use grainlab_core::{Cell, Vec3};

use super::assemble::GrainTable;
use super::error::ImportError;

/// Forces may be off their direction by this fraction: rounding of six digits is less.
const SKEW: f64 = 1e-3;

/// Rows that are looked at to find the columns that are meant.
const SAMPLE: usize = 2000;

/// A row: the ids and the columns of the forces as numbers, and its text.
pub(super) struct ForceRow<'a> {
    pub(super) ids: (u32, u32),
    /// On the first grain, N.
    pub(super) normal: Vec3,
    pub(super) tangential: Vec3,
    pub(super) text: &'a str,
}

struct Directions<'g> {
    grains: &'g GrainTable,
    cell: &'g Cell,
    index: BTreeMap<u32, usize>,
}

impl Directions<'_> {
    /// From the second grain to the first, to its nearest image; `None` if they do not exist.
    fn of(&self, (a, b): (u32, u32)) -> Option<Vec3> {
        let at = |id| self.index.get(&id).map(|k| self.grains.positions[*k]);
        let apart = at(a)? - at(b)?;
        let shortest = apart - self.cell.matrix() * (self.cell.inverse() * apart).map(f64::round);
        shortest.try_normalize(0.0)
    }
}

fn is_along(force: &Vec3, direction: &Vec3) -> bool {
    force.cross(direction).norm() <= SKEW * force.norm()
}

fn is_across(force: &Vec3, direction: &Vec3, whole: f64) -> bool {
    force.dot(direction).abs() <= SKEW * whole
}

/// Refuses columns that are not those of a normal and a tangential force, and names those that are. `columns` are the names of
/// the ids, of the normal and of the tangential force, and `names` those of all columns.
pub(super) fn check(
    rows: &[ForceRow<'_>],
    (columns, names): (&[&str], &[&str]),
    (grains, cell): (&GrainTable, &Cell),
) -> Result<(), ImportError> {
    let index = grains.ids.iter().enumerate().map(|(k, id)| (*id, k)).collect();
    let directions = Directions { grains, cell, index };
    let known: Vec<(&ForceRow<'_>, Vec3)> =
        rows.iter().filter_map(|r| Some((r, directions.of(r.ids)?))).collect();
    let skew = |part: &str, count: usize, columns: &[&str]| {
        (count > 0).then(|| format!("{part} ({}) in {count} of {} contacts", columns.join(" "), known.len()))
    };
    let refused = |problem: &str| {
        let likely = likely(&known[..known.len().min(SAMPLE)], names, columns);
        ImportError::Invalid(format!("contact forces: {problem}; {likely}"))
    };
    if columns.len() < 8 {
        // The whole force need not be along the line, but it presses the grains apart.
        let pulling = known.iter().filter(|(r, d)| r.normal.dot(d) <= 0.0).count();
        if 2 * pulling < known.len() || known.is_empty() {
            return Ok(());
        }
        let problem = skew("the force does not press the grains apart", pulling, &columns[2..5]);
        if 10 * pulling >= 9 * known.len() {
            return Err(ImportError::Invalid(format!(
                "contact forces: {}: they act on the second grain of each contact; exchange the columns of the two ids by \
                 --contact-columns",
                problem.unwrap_or_default()
            )));
        }
        return Err(refused(&problem.unwrap_or_default()));
    }
    let off = known.iter().filter(|(r, d)| !is_along(&r.normal, d)).count();
    let whole = |r: &ForceRow<'_>| r.normal.norm() + r.tangential.norm();
    let along = known.iter().filter(|(r, d)| !is_across(&r.tangential, d, whole(r))).count();
    let faults: Vec<String> = [
        skew("the normal force is not along the line between the centres", off, &columns[2..5]),
        skew("the tangential force is not across it", along, &columns[5..8]),
    ]
    .into_iter()
    .flatten()
    .collect();
    if faults.is_empty() {
        return Ok(());
    }
    Err(refused(&faults.join(", and ")))
}

/// The columns that fit: three in a row along the line between the centres, and three in a row across it that are no part of
/// the normal force.
fn likely(rows: &[(&ForceRow<'_>, Vec3)], names: &[&str], columns: &[&str]) -> String {
    let numbers: Vec<(Vec<f64>, Vec3)> = rows
        .iter()
        .map(|(r, d)| (r.text.split_whitespace().map(|w| w.parse().unwrap_or(f64::NAN)).collect(), *d))
        .collect();
    let vector = |row: &[f64], k: usize| Vec3::new(row[k], row[k + 1], row[k + 2]);
    let fits = |test: &dyn Fn(&Vec3, &Vec3) -> bool| -> Vec<usize> {
        let last = names.len().saturating_sub(2);
        let fits = |k: &usize| {
            let all = numbers.iter().filter(|(row, _)| row.len() == names.len());
            let mut some = false;
            all.clone().all(|(row, d)| {
                let force = vector(row, *k);
                some |= force.norm() > 0.0;
                test(&force, d)
            }) && some
        };
        (0..last).filter(fits).collect()
    };
    let normal = fits(&|force, d| is_along(force, d));
    let tangential = fits(&|force, d| is_across(force, d, force.norm()));
    let three = |k: usize| names[k..k + 3].join(",");
    let ids = columns[..2].join(",");
    match (normal.as_slice(), tangential.as_slice()) {
        ([n, ..], [t, ..]) => {
            format!("columns that fit: --contact-columns '{ids},{},{}'", three(*n), three(*t))
        }
        ([n, ..], []) => format!("{} is along it, and no three columns in a row are across it", three(*n)),
        _ => format!(
            "no three columns in a row are along it: are {ids} the ids of the two grains, and of these grains?"
        ),
    }
}
