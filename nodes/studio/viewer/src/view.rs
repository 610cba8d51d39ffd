//! One packing as it is drawn.

use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_pictures::{Drawn, DrawnContact};

/// Most grains of a picture in a page: beyond, a page is too large for a browser.
pub const MOST_GRAINS: usize = 200_000;

/// Most distant periodic image of a drawn contact, cell vectors. Only cells of one or two grains have others.
const FARTHEST: i32 = 2;

/// A packing as it is drawn: grains within the cell, each with its contacts.
#[derive(Clone, Debug)]
pub struct View {
    /// Name of the state, as readers see it.
    pub label: String,
    /// The periodic cell.
    pub(crate) cell: Cell,
    /// Ids of the grains.
    pub(crate) ids: Vec<u32>,
    /// Positions in units of the cell vectors, from 0 to 1.
    pub(crate) places: Vec<Vec3>,
    /// Radii of grains, m.
    pub(crate) radii: Vec<f64>,
    /// Contacts of each grain that are not with rattlers.
    pub(crate) coordination: Vec<u32>,
    /// True for each grain that is a rattler.
    pub(crate) rattler: Vec<bool>,
    /// Mean normal force of the contacts of each grain, N; 0 without contacts.
    pub(crate) force: Vec<f64>,
    /// The contacts, sorted by their first grain.
    pub(crate) contacts: Vec<DrawnContact>,
}

impl View {
    /// A packing, with the name of its state.
    pub fn new(packing: &Packing, label: impl Into<String>) -> Self {
        let Drawn { places, coordination, rattler, force, mut contacts, .. } = Drawn::new(packing);
        contacts.retain(|c| c.image.iter().all(|k| k.abs() <= FARTHEST));
        Self {
            label: label.into(),
            cell: packing.cell,
            ids: packing.ids.clone(),
            places,
            radii: packing.radii.clone(),
            coordination,
            rattler,
            force,
            contacts,
        }
    }

    /// Number of grains.
    pub fn grains(&self) -> usize {
        self.ids.len()
    }

    /// The cell vectors as columns, m.
    pub(crate) fn matrix(&self) -> &Mat3 {
        self.cell.matrix()
    }

    /// Largest radius, m.
    pub(crate) fn largest_radius(&self) -> f64 {
        self.radii.iter().copied().fold(0.0, f64::max)
    }

    /// Largest normal force of a contact, N.
    pub(crate) fn largest_force(&self) -> f64 {
        self.contacts.iter().map(|c| c.force).fold(0.0, f64::max)
    }

    /// The force that has the last colour of the ramp: three times the mean of the contacts, N.
    pub(crate) fn force_of_full_colour(&self) -> f64 {
        let sum: f64 = self.contacts.iter().map(|c| c.force).sum();
        if self.contacts.is_empty() { 0.0 } else { 3.0 * sum / self.contacts.len() as f64 }
    }
}
