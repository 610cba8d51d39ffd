//! A packing as it is drawn.

use grainlab_core::{Packing, Vec3, non_rattlers};

/// A packing as it is drawn: grains within the cell, each with its contacts.
#[derive(Clone, Debug)]
pub struct Drawn<'a> {
    /// Packing that is drawn.
    pub packing: &'a Packing,
    /// Positions in units of the cell vectors, 0 or more and less than 1.
    pub places: Vec<Vec3>,
    /// Contacts of each grain that are not with rattlers.
    pub coordination: Vec<u32>,
    /// True for each grain that is a rattler.
    pub rattler: Vec<bool>,
    /// Mean normal force of the contacts of each grain, N; 0 without contacts.
    pub force: Vec<f64>,
    /// The contacts, sorted by their first grain.
    pub contacts: Vec<DrawnContact>,
}

/// A contact of grains at their places within the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnContact {
    /// Index of the first grain.
    pub i: u32,
    /// Index of the second grain.
    pub j: u32,
    /// Cell vectors added to the place of `j`.
    pub image: [i32; 3],
    /// Normal force, N, 0 or more.
    pub force: f64,
}

impl<'a> Drawn<'a> {
    /// The packing, which must be validated.
    pub fn new(packing: &'a Packing) -> Self {
        let n = packing.grains();
        let fractional: Vec<Vec3> = packing.positions.iter().map(|x| packing.cell.fractional(x)).collect();
        let carries = non_rattlers(packing);
        let (mut coordination, mut touching, mut force) = (vec![0; n], vec![0u32; n], vec![0.0; n]);
        let mut contacts = Vec::with_capacity(packing.contacts.len());
        for c in &packing.contacts {
            let (i, j) = (c.i as usize, c.j as usize);
            for g in [i, j] {
                touching[g] += 1;
                force[g] += c.normal_force;
                coordination[g] += u32::from(carries[i] && carries[j]);
            }
            // The image belongs to positions as held; those drawn are folded into the cell.
            let cells = |grain: usize, k: usize| fractional[grain][k].floor() as i32;
            let image = std::array::from_fn(|k| {
                i32::from(c.image[k]).saturating_add(cells(j, k)).saturating_sub(cells(i, k))
            });
            contacts.push(DrawnContact { i: c.i, j: c.j, image, force: c.normal_force.max(0.0) });
        }
        force.iter_mut().zip(&touching).for_each(|(f, n)| *f /= f64::from((*n).max(1)));
        Self {
            packing,
            places: fractional.iter().map(|f| f.map(|v| (v - v.floor()).min(1.0 - f64::EPSILON))).collect(),
            coordination,
            rattler: carries.iter().map(|c| !c).collect(),
            force,
            contacts,
        }
    }

    /// The force that has the last colour of the ramp: three times the mean of the contacts, N.
    pub fn force_of_full_colour(&self) -> f64 {
        let sum: f64 = self.contacts.iter().map(|c| c.force).sum();
        if self.contacts.is_empty() { 0.0 } else { 3.0 * sum / self.contacts.len() as f64 }
    }

    /// The centre of a grain within the cell, m.
    pub(crate) fn centre(&self, grain: usize) -> Vec3 {
        self.packing.cell.matrix() * self.places[grain]
    }

    /// Mean radius, m; 0 without grains.
    pub(crate) fn mean_radius(&self) -> f64 {
        let radii = &self.packing.radii;
        radii.iter().sum::<f64>() / radii.len().max(1) as f64
    }
}
