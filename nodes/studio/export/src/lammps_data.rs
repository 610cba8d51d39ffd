//! Writes LAMMPS data files of `atom_style sphere`.

use crate::lammps_dump::{ids, restricted};
use grainlab_core::Packing;
use std::fmt::Write as _;

/// A data file: id, type, diameter, density, position folded into the cell with its image flags, velocity, angular velocity; SI
/// units. Contact forces are not part of the format. Ids are those of the packing, or one more if it has an id 0: LAMMPS counts from 1.
/// A cell that is not in the restricted triclinic form of LAMMPS is written as a general one (LAMMPS from April 2024 on).
pub fn lammps_data(packing: &Packing) -> String {
    let m = packing.cell.matrix();
    let mut text = format!(
        "LAMMPS data file of grainlab, timestep = {}, units = si\n\n{} atoms\n1 atom types\n\n",
        packing.step,
        packing.grains()
    );
    // Writing to a String cannot fail.
    match restricted(packing) {
        Some(tilt) => {
            for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
                let _ = writeln!(text, "0 {:e} {axis}lo {axis}hi", m[(k, k)]);
            }
            if tilt != [0.0; 3] {
                let [xy, xz, yz] = tilt;
                let _ = writeln!(text, "{xy:e} {xz:e} {yz:e} xy xz yz");
            }
        }
        None => {
            for (edge, name) in m.column_iter().zip(["avec", "bvec", "cvec"]) {
                let _ = writeln!(text, "{:e} {:e} {:e} {name}", edge[0], edge[1], edge[2]);
            }
            text.push_str("0 0 0 abc origin\n");
        }
    }
    let ids = ids(packing);
    text.push_str("\nAtoms # sphere\n\n");
    for (k, x) in packing.positions.iter().enumerate() {
        let image = packing.cell.fractional(x).map(f64::floor);
        let x = x - m * image;
        let (id, diameter, density) = (ids[k], 2.0 * packing.radii[k], packing.material.density);
        let _ = writeln!(
            text,
            "{id} 1 {diameter:e} {density:e} {:e} {:e} {:e} {} {} {}",
            x.x, x.y, x.z, image.x, image.y, image.z
        );
    }
    text.push_str("\nVelocities\n\n");
    for ((id, v), w) in ids.iter().zip(&packing.velocities).zip(&packing.spins) {
        let _ = writeln!(text, "{id} {:e} {:e} {:e} {:e} {:e} {:e}", v.x, v.y, v.z, w.x, w.y, w.z);
    }
    text
}
