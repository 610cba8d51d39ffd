//! Supercells: a packing repeated along the normal of its lattice planes.
//!
//! A periodic packing is periodic along any of its lattice vectors, so that a cell whose first two edges lie in the
//! planes (h k l) and whose third crosses `copies` of them contains the packing `copies` times, for any planes.

pub(crate) mod lattice;

use crate::error::{AcousticsError, setting};
use grainlab_core::{Contact, Packing, Vec3};
use grainlab_engine::EngineError;
use lattice::Layers;

const MAX_GRAINS: usize = 20_000_000;

/// Largest image number of the engine.
const MAX_IMAGE: i64 = 100;

/// Largest magnitude of an index of lattice planes.
const MAX_INDEX: u32 = 1000;

/// A packing repeated along a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Supercell {
    /// All copies in order: grain `g` of the `n` of the packing has the index and id `c n + g` in copy `c`.
    /// Positions are in the cell. Contacts keep their forces.
    pub packing: Packing,
    /// Period along the path, m: number of copies times the spacing of the planes.
    pub path: f64,
    /// Position of each grain along the path, in [0, path), m.
    pub along: Vec<f64>,
}

/// Repeats `packing` `copies` times (1 or more) along the normal of its lattice planes (h k l), divided by their common
/// divisor: see [`crate::Ray::normal`].
///
/// The copies are stacked by the lattice vector nearest to the normal, and the edges across it are the shortest
/// possible, so that the cell has the least skew.
pub fn supercell(packing: &Packing, indices: [i32; 3], copies: u32) -> Result<Supercell, AcousticsError> {
    packing.check().map_err(EngineError::from)?;
    let n = packing.grains();
    let grains = (copies as usize).saturating_mul(n);
    let fits = copies > 0 && grains <= MAX_GRAINS;
    setting("copies", f64::from(copies), fits, "1 or more, and at most 20,000,000 grains in all")?;
    for k in indices {
        setting("indices", f64::from(k), k.unsigned_abs() <= MAX_INDEX, "between -1000 and 1000")?;
    }
    let no_plane = AcousticsError::NoLatticePlane { direction: indices.map(f64::from) };
    let layers = lattice::layers(&packing.cell, indices, copies).ok_or(no_plane)?;
    let path = f64::from(copies) * lattice::spacing(&packing.cell, &layers.plane);

    // Every grain of every copy, wrapped into the cell, and the lattice vector by which it was moved.
    let step = packing.cell.matrix() * layers.step.cast::<f64>();
    let mut positions = Vec::with_capacity(grains);
    let mut along = Vec::with_capacity(grains);
    let mut taken = Vec::with_capacity(grains);
    for copy in 0..copies {
        for x in &packing.positions {
            let x = x + step * f64::from(copy);
            let whole = layers.cell.fractional(&x).map(f64::floor);
            let x = x - layers.cell.matrix() * whole;
            positions.push(x);
            // Only the third edge crosses planes.
            let place = layers.cell.fractional(&x).z * path;
            along.push(if (0.0..path).contains(&place) { place } else { 0.0 });
            taken.push(whole.map(|w| w as i64));
        }
    }
    let mut contacts = Vec::with_capacity(copies as usize * packing.contacts.len());
    for copy in 0..copies {
        for c in &packing.contacts {
            contacts.push(contact(c, n, copy, copies, &layers, &taken)?);
        }
    }
    contacts.sort_unstable_by_key(|c| (c.i, c.j, c.image));

    let times = |v: &[Vec3]| v.repeat(copies as usize);
    let repeated = Packing {
        cell: layers.cell,
        ids: (0..grains as u32).collect(),
        radii: packing.radii.repeat(copies as usize),
        velocities: times(&packing.velocities),
        spins: times(&packing.spins),
        positions,
        contacts,
        path: None,
        ..*packing
    };
    Ok(Supercell { packing: repeated, path, along })
}

/// Contact `c` of a packing of `n` grains, in copy `copy`.
fn contact(
    c: &Contact,
    n: usize,
    copy: u32,
    copies: u32,
    layers: &Layers,
    taken: &[nalgebra::Vector3<i64>],
) -> Result<Contact, AcousticsError> {
    let image = nalgebra::Vector3::from(c.image.map(i64::from));
    let (other, image) = layers.image(i64::from(copy), &image, i64::from(copies));
    let i = copy as usize * n + c.i as usize;
    let j = other as usize * n + c.j as usize;
    let image = image + taken[j] - taken[i];
    if image.iter().any(|k| k.abs() > MAX_IMAGE) {
        return Err(EngineError::Image { grain: c.i }.into());
    }
    let image: [i8; 3] = image.map(|k| k as i8).into();
    Ok(c.named(i as u32, j as u32, image))
}
