//! A simple cubic lattice, also for the tests of the analyzer.

use grainlab_core::{Cell, Contact, Material, Packing, Vec3};

pub(crate) const DIAMETER: f64 = 2e-4;
pub(crate) const OVERLAP: f64 = 2e-8;

/// One grain per cell touching its own images: a simple cubic lattice, or grains apart if `overlap` is not
/// positive.
pub(crate) fn lattice(overlap: f64) -> Packing {
    let contact = |axis: usize| {
        let (mut image, mut normal) = ([0; 3], Vec3::zeros());
        (image[axis], normal[axis]) = (1, 1.0);
        let normal_force = Material::GLASS.normal_force(DIAMETER / 4.0, overlap);
        Contact::pressed([0, 0], image, normal, overlap, normal_force)
    };
    Packing {
        step: 12,
        time: 0.5,
        contacts: if overlap > 0.0 { [2, 1, 0].map(contact).to_vec() } else { Vec::new() },
        friction: 0.3,
        time_step: 1e-8,
        ..Packing::at_rest(Cell::cube(DIAMETER - overlap).unwrap(), vec![DIAMETER / 2.0], vec![Vec3::zeros()])
    }
    .validated()
    .unwrap()
}
