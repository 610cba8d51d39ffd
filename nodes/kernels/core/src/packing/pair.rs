//! A packing for tests, also those of the messages.

use super::*;

/// Two grains that touch across the boundary of the cell.
pub(super) fn pair() -> Packing {
    let positions = vec![Vec3::zeros(), Vec3::new(0.0, 0.0, 0.9)];
    Packing {
        contacts: vec![Contact::pressed([0, 1], [0, 0, -1], -Vec3::z(), 0.1, 1.0)],
        friction: 0.1,
        ..Packing::at_rest(Cell::cube(1.0).unwrap(), vec![0.1, 0.1], positions)
    }
}
