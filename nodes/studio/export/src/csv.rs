//! Writes the CSV format of `grainlab_recordings::import::csv` without loss: numbers have enough digits to read them
//! back exactly.

use std::fmt::Write as _;

use grainlab_core::{Mat3, Packing};
use serde_json::{Value, json};

/// Grains and contacts of a packing as CSV; [`sidecar`] writes the rest. Reading both back gives the same
/// packing, bit for bit.
pub fn csv(packing: &Packing) -> String {
    let mut text = String::from("# particles: id,x,y,z,radius,mass,vx,vy,vz,wx,wy,wz\n");
    // Writing to a String cannot fail.
    for k in 0..packing.grains() {
        let (x, v, w) = (&packing.positions[k], &packing.velocities[k], &packing.spins[k]);
        let (id, radius) = (packing.ids[k], packing.radii[k]);
        let mass = packing.material.sphere_mass(radius);
        let _ = write!(text, "p,{id}");
        line(&mut text, &[x.x, x.y, x.z, radius, mass, v.x, v.y, v.z, w.x, w.y, w.z]);
    }
    let resists_rolling = packing.law.rolling.is_some();
    let rolling = if resists_rolling { ",frx,fry,frz" } else { "" };
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "# contacts: i,j,nx,ny,nz,delta,fn,ftx,fty,ftz{rolling} (n from j to i; force on i = fn*n+ft)"
    );
    for c in &packing.contacts {
        let (i, j) = (packing.ids[c.i as usize], packing.ids[c.j as usize]);
        let (n, t) = (-c.normal, &c.tangential_force);
        let _ = write!(text, "c,{i},{j}");
        let force = [n.x, n.y, n.z, c.overlap, c.normal_force, t.x, t.y, t.z];
        let rolling = if resists_rolling { c.rolling_force.as_slice() } else { &[] };
        line(&mut text, &[&force[..], rolling].concat());
    }
    text
}

/// Adds numbers to a line, and ends it.
fn line(text: &mut String, numbers: &[f64]) {
    // Writing to a String cannot fail.
    numbers.iter().for_each(|value| _ = write!(text, ",{value:e}"));
    text.push('\n');
}

/// Cell, material and state of a packing, as the JSON beside its CSV.
pub fn sidecar(packing: &Packing) -> String {
    let rows = |m: &Mat3| -> Vec<Vec<f64>> { m.row_iter().map(|r| r.iter().copied().collect()).collect() };
    // JSON has no infinity.
    let friction = if packing.friction.is_finite() { json!(packing.friction) } else { json!("inf") };
    let value: Value = json!({
        "description": "packing exported by grainlab; SI units; compression positive; force on i; n from j to i",
        "N": packing.grains(),
        "G": packing.material.shear_modulus,
        "nu": packing.material.poisson_ratio,
        "density": packing.material.density,
        "contact_law": packing.law.name(),
        "contact_law_parameters": packing.law.parameters(),
        "mu_prep": friction,
        "cell": rows(packing.cell.matrix()),
        "step": packing.step,
        "time": packing.time,
        "time_step": packing.time_step,
        "deformation": packing.strain().map(|_| rows(&packing.deformation)),
        "n_contacts": packing.contacts.len(),
    });
    format!("{value:#}\n")
}
