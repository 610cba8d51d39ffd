//! Grains in rows of named columns.

use grainlab_core::Vec3;
use std::collections::BTreeSet;
use std::f64::consts::PI;

use super::assemble::GrainTable;
use super::error::ImportError;
use super::settings::ImportOptions;
use super::stated;
use super::text::{Line, cut};

/// Names of the columns of a format; an empty one is that of no column.
pub(super) struct Names {
    /// Id of the first row where the file has none.
    pub(super) first_id: u32,
    pub(super) radius: &'static str,
    pub(super) density: &'static str,
    pub(super) masses: [&'static str; 2],
    pub(super) kind: &'static str,
    pub(super) velocity: [&'static str; 3],
    pub(super) spin: [&'static str; 3],
}

pub(super) struct Columns {
    count: usize,
    first_id: u32,
    id: Option<usize>,
    radii: [Option<usize>; 2],
    masses: [Option<usize>; 2],
    density: Option<usize>,
    kind: Option<usize>,
    motion: [Option<[usize; 3]>; 2],
}

pub(super) fn three(names: &[&str], wanted: [&str; 3]) -> Option<[usize; 3]> {
    let [x, y, z] = wanted.map(|wanted| names.iter().position(|name| *name == wanted));
    Some([x?, y?, z?])
}

impl Columns {
    pub(super) fn new(line: &Line<'_>, names: &[&str], format: &Names) -> Result<Self, ImportError> {
        // It is unknown which of the two is meant.
        let mut known = BTreeSet::new();
        if let Some(name) = names.iter().find(|name| !known.insert(**name)) {
            return Err(line.error(format!("the column {} occurs twice", cut(name))));
        }
        let place = |wanted: &str| names.iter().position(|name| *name == wanted);
        Ok(Self {
            count: names.len(),
            first_id: format.first_id,
            id: place("id"),
            radii: [format.radius, "diameter"].map(place),
            masses: format.masses.map(place),
            density: place(format.density),
            kind: place(format.kind),
            motion: [format.velocity, format.spin].map(|wanted| three(names, wanted)),
        })
    }

    /// The words of a row, as many as there are columns.
    pub(super) fn words<'a>(&self, line: &Line<'a>) -> Result<Vec<&'a str>, ImportError> {
        let words = line.words();
        if words.len() == self.count {
            return Ok(words);
        }
        Err(line.error(format!("{} columns, {} were announced", words.len(), self.count)))
    }

    pub(super) fn grain(
        &self,
        line: &Line<'_>,
        words: &[&str],
        position: Vec3,
        options: &ImportOptions,
        grains: &mut GrainTable,
    ) -> Result<(), ImportError> {
        let number = |name: &str, at: Option<usize>| at.map(|k| line.finite(name, words[k])).transpose();
        let vector = |name: &str, at: Option<[usize; 3]>| {
            at.map_or(Ok(Vec3::zeros()), |at| line.vector(name, at.map(|k| words[k])))
        };
        let stated =
            stated::radius(line, number("radius", self.radii[0])?, number("diameter", self.radii[1])?)?;
        let of_density = |(density, radius): (f64, f64)| 4.0 / 3.0 * PI * density * radius.powi(3);
        let of_density = number("density", self.density)?.zip(stated).map(of_density);
        let [mass, masses] = [number("mass", self.masses[0])?, number("masses", self.masses[1])?];
        stated::same(line, "mass and masses", mass, masses)?;
        let mass = mass.or(masses);
        stated::same(line, "mass and that of density and radius", mass, of_density)?;
        grains.masses.extend(mass.or(of_density));
        grains.kinds.extend(self.kind.map(|k| words[k].to_owned()));
        let row = self.first_id + grains.ids.len() as u32;
        let id = self.id.map_or(Ok(row), |k| line.id("id", words[k]))?;
        let radius = grains.radius(stated, options)?;
        let [velocity, spin] = self.motion;
        let moving = [vector("velocity", velocity)?, vector("angular velocity", spin)?];
        grains.push(line, id, radius, [position, moving[0], moving[1]])
    }
}
