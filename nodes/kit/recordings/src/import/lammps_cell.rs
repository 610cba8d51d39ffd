//! Cells of LAMMPS.

use grainlab_core::Mat3;

/// The cell of LAMMPS with edge vectors a = (lx, 0, 0), b = (xy, ly, 0), c = (xz, yz, lz), m.
pub(super) fn lammps_cell(lengths: [f64; 3], [xy, xz, yz]: [f64; 3]) -> Mat3 {
    let [lx, ly, lz] = lengths;
    Mat3::new(
        lx, xy, xz, //
        0.0, ly, yz, //
        0.0, 0.0, lz,
    )
}
