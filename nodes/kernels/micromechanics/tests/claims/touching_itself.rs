//! A simple cubic lattice, also for the tests of the analyzer.

use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3};

pub(crate) const DIAMETER: f64 = 2e-4;
pub(crate) const OVERLAP: f64 = 2e-8;

/// One grain per cell touching its own images: a simple cubic lattice, or grains apart if `overlap` is not
/// positive.
pub(crate) fn lattice(overlap: f64) -> Packing {
    let contact = |axis: usize| {
        let (mut image, mut normal) = ([0; 3], Vec3::zeros());
        (image[axis], normal[axis]) = (1, 1.0);
        let normal_force = Material::GLASS.normal_force(DIAMETER / 4.0, overlap);
        Contact {
            i: 0,
            j: 0,
            image,
            overlap,
            normal,
            normal_force,
            tangential_force: Vec3::zeros(),
            rolling_force: Vec3::zeros(),
        }
    };
    Packing {
        step: 12,
        time: 0.5,
        cell: Cell::cube(DIAMETER - overlap).unwrap(),
        deformation: Mat3::identity(),
        ids: vec![0],
        radii: vec![DIAMETER / 2.0],
        positions: vec![Vec3::zeros()],
        velocities: vec![Vec3::zeros()],
        spins: vec![Vec3::zeros()],
        contacts: if overlap > 0.0 { [2, 1, 0].map(contact).to_vec() } else { Vec::new() },
        material: Material::GLASS,
        law: Default::default(),
        friction: 0.3,
        time_step: 1e-8,
    }
    .validated()
    .unwrap()
}
