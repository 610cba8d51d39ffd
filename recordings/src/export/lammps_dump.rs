//! Writes LAMMPS dump text, which OVITO opens.

use std::fmt::Write as _;

use grainlab_core::{Packing, Vec3};

/// The cell of the packing cannot be written in a file of LAMMPS.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the cell's edge vectors are not (lx,0,0), (xy,ly,0), (xz,yz,lz), the only form of LAMMPS files; entry ({row}, {column}) is {value:e} m: export csv, vtk, vtkhdf or xyz instead"
)]
pub struct DumpError {
    /// Row of the offending entry, 0-based.
    pub row: usize,
    /// Its column.
    pub column: usize,
    /// Its value, m.
    pub value: f64,
}

/// The tilt factors xy, xz, yz of the cell, m.
///
/// # Errors
/// If the cell is not in LAMMPS's restricted triclinic form.
pub(super) fn restricted(packing: &Packing) -> Result<[f64; 3], DumpError> {
    let m = packing.cell.matrix();
    for (row, column) in [(1, 0), (2, 0), (2, 1)] {
        let value = m[(row, column)];
        if value != 0.0 {
            return Err(DumpError { row, column, value });
        }
    }
    Ok([m[(0, 1)], m[(0, 2)], m[(1, 2)]])
}

/// One frame of a LAMMPS dump: id, type, radius, mass, unwrapped positions, velocities, angular velocities,
/// and the number of contacts as `c_contacts`. Frames can be concatenated. Contact forces are not
/// part of the format.
///
/// # Errors
/// If the cell is not in LAMMPS's restricted triclinic form.
pub fn lammps_dump(packing: &Packing) -> Result<String, DumpError> {
    let [xy, xz, yz] = restricted(packing)?;
    let m = packing.cell.matrix();
    let mut text = format!(
        "ITEM: UNITS\nsi\nITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\n",
        packing.step,
        packing.grains()
    );
    // Writing to a String cannot fail.
    if (xy, xz, yz) == (0.0, 0.0, 0.0) {
        text.push_str("ITEM: BOX BOUNDS pp pp pp\n");
        for k in 0..3 {
            let _ = writeln!(text, "0 {:e}", m[(k, k)]);
        }
    } else {
        // The bounding box of the tilted cell, then the tilt.
        let low = [0f64.min(xy).min(xz).min(xy + xz), 0f64.min(yz), 0.0];
        let high = [m[(0, 0)] + 0f64.max(xy).max(xz).max(xy + xz), m[(1, 1)] + 0f64.max(yz), m[(2, 2)]];
        text.push_str("ITEM: BOX BOUNDS xy xz yz pp pp pp\n");
        for (k, tilt) in [xy, xz, yz].into_iter().enumerate() {
            let _ = writeln!(text, "{:e} {:e} {tilt:e}", low[k], high[k]);
        }
    }
    let mut contacts = vec![0u32; packing.grains()];
    for c in &packing.contacts {
        contacts[c.i as usize] += 1;
        contacts[c.j as usize] += 1;
    }
    text.push_str("ITEM: ATOMS id type radius mass xu yu zu vx vy vz omegax omegay omegaz c_contacts\n");
    for (k, contacts) in contacts.into_iter().enumerate() {
        let radius = packing.radii[k];
        let _ = write!(text, "{} 1 {radius:e} {:e}", packing.ids[k], packing.material.sphere_mass(radius));
        let vectors: [&Vec3; 3] = [&packing.positions[k], &packing.velocities[k], &packing.spins[k]];
        for value in vectors.into_iter().flatten() {
            let _ = write!(text, " {value:e}");
        }
        let _ = writeln!(text, " {contacts}");
    }
    Ok(text)
}
