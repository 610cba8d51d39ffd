//! Writes the contacts of a packing as a LAMMPS `dump local`.

use crate::lammps_dump::ids;
use grainlab_core::Packing;
use std::fmt::Write as _;

/// One frame: ids of the two grains, normal force and tangential force on the first one, N, under the names that
/// `ImportOptions::contact_forces` expects. Ids are those of
/// [`lammps_dump`](crate::lammps_dump()).
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
