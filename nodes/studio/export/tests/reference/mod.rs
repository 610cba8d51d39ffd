//! A packing of 500 grains from LAMMPS.

use grainlab_core::Packing;
use grainlab_recordings::import::load;
use std::path::Path;

pub(crate) fn reference() -> Packing {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/golden/reference");
    let mut loaded = load(&folder.join("ref_packing_500.csv.gz"), &Default::default()).unwrap();
    loaded.packings.remove(0).packing
}
