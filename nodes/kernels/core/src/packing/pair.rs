//! A packing for tests, also those of the messages.

use super::*;

/// Two grains that touch across the boundary of the cell.
pub(super) fn pair() -> Packing {
    Packing {
        step: 0,
        time: 0.0,
        cell: Cell::cube(1.0).unwrap(),
        deformation: Mat3::identity(),
        ids: vec![0, 1],
        radii: vec![0.1, 0.1],
        positions: vec![Vec3::zeros(), Vec3::new(0.0, 0.0, 0.9)],
        velocities: vec![Vec3::zeros(); 2],
        spins: vec![Vec3::zeros(); 2],
        contacts: vec![Contact {
            i: 0,
            j: 1,
            image: [0, 0, -1],
            overlap: 0.1,
            normal: -Vec3::z(),
            normal_force: 1.0,
            tangential_force: Vec3::zeros(),
            rolling_force: Vec3::zeros(),
        }],
        material: Material::GLASS,
        law: Default::default(),
        friction: 0.1,
        time_step: 0.0,
    }
}
