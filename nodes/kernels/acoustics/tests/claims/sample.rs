//! Packings for the measurements.

use crate::golden_packing::read;
use grainlab_core::Packing;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/golden/packings");

/// 2,000 grains at 50 kPa with an isotropic contact network.
pub(crate) fn isotropic() -> Packing {
    read(FOLDER, "isotropic_2000")
}

/// 2,000 grains at 50 kPa with more contacts along e3, ε = .046.
pub(crate) fn anisotropic() -> Packing {
    read(FOLDER, "anisotropic_2000")
}

#[test]
fn the_samples_are_read_as_they_were_written() {
    for (packing, contacts) in [(isotropic(), 5134), (anisotropic(), 4977)] {
        assert_eq!((packing.grains(), packing.contacts.len()), (2000, contacts));
        for c in &packing.contacts {
            let branch = packing.branch(c);
            assert!((branch.normalize() - c.normal).amax() < 1e-9, "{c:?} {branch}");
            let gap = packing.radii[c.i as usize] + packing.radii[c.j as usize] - branch.norm();
            assert!((gap - c.overlap).abs() < 1e-9 * packing.radii[0]);
        }
    }
}
