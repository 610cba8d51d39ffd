//! Writes LAMMPS dumps as text: grains, which OVITO opens, and contacts (`dump local`).

use std::fmt::Write as _;

use grainlab_core::{Packing, Vec3};

/// Begins a dump. LAMMPS writes it before the first frame alone, and OVITO takes no frame before another one.
pub(crate) const UNITS: &str = "ITEM: UNITS\nsi\n";

/// The tilt factors xy, xz, yz of a cell with edge vectors (lx, 0, 0), (xy, ly, 0), (xz, yz, lz), m; `None` for any other
/// cell, which LAMMPS calls a general triclinic one.
pub(crate) fn restricted(packing: &Packing) -> Option<[f64; 3]> {
    let m = packing.cell.matrix();
    let below = [(1, 0), (2, 0), (2, 1)];
    below.into_iter().all(|at| m[at] == 0.0).then(|| [m[(0, 1)], m[(0, 2)], m[(1, 2)]])
}

/// The ids of the grains in every file for LAMMPS, which counts from 1: those of the packing, or one more if it has an id 0.
pub(crate) fn ids(packing: &Packing) -> Vec<u64> {
    let first = u64::from(packing.ids.contains(&0));
    packing.ids.iter().map(|id| u64::from(*id) + first).collect()
}

pub(crate) fn coordination(packing: &Packing) -> Vec<u32> {
    let mut contacts = vec![0; packing.grains()];
    for grain in packing.contacts.iter().flat_map(|c| [c.i, c.j]) {
        contacts[grain as usize] += 1;
    }
    contacts
}

/// One frame of a LAMMPS dump: id, type, radius, mass, unwrapped positions, velocities, angular velocities,
/// and the number of contacts as `c_contacts`. Frames can be concatenated, after one `ITEM: UNITS`. Contact forces are not
/// part of the format. Ids are those of the packing, or one more if it has an id 0, as in [`lammps_data`](crate::lammps_data()). A cell that is not in the restricted triclinic form of LAMMPS is written as a general one, by its edge
/// vectors (`BOX BOUNDS abc origin`), as LAMMPS writes it from April 2024 on; its `read_dump` refuses it.
pub fn lammps_dump(packing: &Packing) -> String {
    let mut text = format!("ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\n", packing.step, packing.grains());
    bounds(&mut text, packing);
    text.push_str("ITEM: ATOMS id type radius mass xu yu zu vx vy vz omegax omegay omegaz c_contacts\n");
    for (k, (contacts, id)) in coordination(packing).into_iter().zip(ids(packing)).enumerate() {
        let radius = packing.radii[k];
        let _ = write!(text, "{id} 1 {radius:e} {:e}", packing.material.sphere_mass(radius));
        let vectors: [&Vec3; 3] = [&packing.positions[k], &packing.velocities[k], &packing.spins[k]];
        for value in vectors.into_iter().flatten() {
            let _ = write!(text, " {value:e}");
        }
        let _ = writeln!(text, " {contacts}");
    }
    text
}

fn bounds(text: &mut String, packing: &Packing) {
    let m = packing.cell.matrix();
    // Writing to a String cannot fail.
    match restricted(packing) {
        Some([0.0, 0.0, 0.0]) => {
            text.push_str("ITEM: BOX BOUNDS pp pp pp\n");
            for k in 0..3 {
                let _ = writeln!(text, "0 {:e}", m[(k, k)]);
            }
        }
        Some([xy, xz, yz]) => {
            // The bounding box of the tilted cell, then the tilt.
            let low = [0f64.min(xy).min(xz).min(xy + xz), 0f64.min(yz), 0.0];
            let high = [m[(0, 0)] + 0f64.max(xy).max(xz).max(xy + xz), m[(1, 1)] + 0f64.max(yz), m[(2, 2)]];
            text.push_str("ITEM: BOX BOUNDS xy xz yz pp pp pp\n");
            for (k, tilt) in [xy, xz, yz].into_iter().enumerate() {
                let _ = writeln!(text, "{:e} {:e} {tilt:e}", low[k], high[k]);
            }
        }
        None => {
            text.push_str("ITEM: BOX BOUNDS abc origin pp pp pp\n");
            for edge in m.column_iter() {
                let _ = writeln!(text, "{:e} {:e} {:e} 0", edge[0], edge[1], edge[2]);
            }
        }
    }
}

/// One frame of a LAMMPS `dump local`: ids of the two grains, normal force and tangential force on the first one, N, under the names that
/// `ImportOptions::contact_forces` expects. Ids are those of [`lammps_dump`].
pub fn lammps_local(packing: &Packing) -> String {
    let mut text = format!(
        "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ENTRIES\n{}\nITEM: ENTRIES patom1 patom2 fx fy fz p1 p2 p3\n",
        packing.step,
        packing.contacts.len()
    );
    let ids = ids(packing);
    for c in &packing.contacts {
        // The normal points away from the first grain, and the force pushes it back.
        let (f, t) = (-c.normal_force * c.normal, &c.tangential_force);
        let (i, j) = (ids[c.i as usize], ids[c.j as usize]);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{i} {j} {:e} {:e} {:e} {:e} {:e} {:e}", f.x, f.y, f.z, t.x, t.y, t.z);
    }
    text
}
