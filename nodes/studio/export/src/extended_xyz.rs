//! Writes extended XYZ, which OVITO, ASE and others read.

use grainlab_core::{Packing, Vec3};
use std::fmt::Write as _;

/// One frame: id, radius, mass, position as held, velocity, angular velocity; the cell as `Lattice`, material, friction, time and
/// step in the comment. Frames can be concatenated. Contacts are not part of the format. Numbers have enough digits to read
/// them back exactly.
pub fn extended_xyz(packing: &Packing) -> String {
    let mut text = format!("{}\nLattice=\"", packing.grains());
    // The edge vectors one after the other: column by column, as the matrix is stored.
    let edges: Vec<String> = packing.cell.matrix().iter().map(|x| format!("{x:e}")).collect();
    let m = &packing.material;
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{}\" Properties=species:S:1:pos:R:3:id:I:1:radius:R:1:mass:R:1:velo:R:3:angular_velocity:R:3 pbc=\"T T T\" \
         Time={:e} step={} shear_modulus={:e} poisson_ratio={:e} density={:e} friction={:e} \
         contact_law={} contact_law_parameters=\"{}\" units=\"m kg s\"",
        edges.join(" "),
        packing.time,
        packing.step,
        m.shear_modulus,
        m.poisson_ratio,
        m.density,
        packing.friction,
        packing.law.name(),
        packing.law.parameters().iter().map(|p| format!("{p:e}")).collect::<Vec<_>>().join(" "),
    );
    for k in 0..packing.grains() {
        let radius = packing.radii[k];
        let vector = |v: &Vec3| format!("{:e} {:e} {:e}", v.x, v.y, v.z);
        let _ = writeln!(
            text,
            "X {} {} {radius:e} {:e} {} {}",
            vector(&packing.positions[k]),
            packing.ids[k],
            m.sphere_mass(radius),
            vector(&packing.velocities[k]),
            vector(&packing.spins[k]),
        );
    }
    text
}
