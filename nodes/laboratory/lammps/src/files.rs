//! Packings to and from files of LAMMPS.

use crate::coulomb::Coulomb;
use crate::frame::Frame;
use crate::refusal::refused;
use grainlab_core::{Contact, OVERLAP_LIMIT, Packing, Vec3, effective_radius};
use grainlab_engine::EngineError;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// A packing as the file of `read_data`, without contacts, with velocities relative to the affine motion.
pub(crate) fn data_file(packing: &Packing, frame: &Frame) -> String {
    let (e, n) = (&frame.edges, packing.grains());
    let mut text = format!("from a packing\n\n{n} atoms\n1 atom types\n\n");
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let _ = writeln!(text, "0 {:e} {axis}lo {axis}hi", e[(k, k)]);
    }
    let _ = writeln!(text, "{:e} {:e} {:e} xy xz yz\n\nAtoms # sphere\n", e[(0, 1)], e[(0, 2)], e[(1, 2)]);
    for (k, (position, radius)) in packing.positions.iter().zip(&packing.radii).enumerate() {
        let cells = packing.cell.fractional(position).map(f64::floor);
        let x = frame.in_lammps(&(position - packing.cell.matrix() * cells));
        let (diameter, density) = (2.0 * radius, packing.material.density);
        let [a, b, c] = [cells.x, cells.y, cells.z].map(|n| n as i64);
        let _ =
            writeln!(text, "{} 1 {diameter:e} {density:e} {:e} {:e} {:e} {a} {b} {c}", k + 1, x.x, x.y, x.z);
    }
    text += "\nVelocities\n\n";
    for (k, (velocity, omega)) in packing.velocities.iter().zip(&packing.spins).enumerate() {
        let (v, w) = (frame.in_lammps(velocity), frame.in_lammps(omega));
        let _ = writeln!(text, "{} {:e} {:e} {:e} {:e} {:e} {:e}", k + 1, v.x, v.y, v.z, w.x, w.y, w.z);
    }
    text
}

pub(crate) const GRAIN_COLUMNS: &str = "id xu yu zu vx vy vz fx fy fz omegax omegay omegaz tqx tqy tqz";
/// Columns of a dump of contacts, from the computes `ids` and `contacts`.
pub(crate) const CONTACT_COLUMNS: &str = "c_ids[1] c_ids[2] c_contacts[1] c_contacts[2] c_contacts[3] c_contacts[4] c_contacts[5] \
     c_contacts[6]";

pub(crate) struct Dumps<'a> {
    pub(crate) grains: &'a Path,
    pub(crate) contacts: &'a Path,
    pub(crate) frame: Frame,
    /// Angular velocity of the affine motion that spins contain, 1/s.
    pub(crate) spin: Vec3,
    pub(crate) coulomb: Coulomb,
}

impl Dumps<'_> {
    /// The packing with the present positions, velocities and contacts in place of those of `known`.
    pub(crate) fn read(&self, known: &Packing) -> Result<Packing, EngineError> {
        let n = known.grains();
        let mut packing = Packing { contacts: Vec::new(), ..known.clone() };
        let half = 0.5 * known.time_step;
        let mut seen = 0;
        rows::<16>(self.grains, |row| {
            let three = |k: usize| Vec3::new(row[k], row[k + 1], row[k + 2]);
            let Some(k) = index(row[0], n) else { return false };
            let r = known.radii[k];
            let mass = known.material.sphere_mass(r);
            // Velocities half a step before the positions, as ours.
            let u = three(4) - three(7) * (half / mass);
            let w = three(10) - three(13) * (half / (0.4 * mass * r * r)) - self.spin;
            packing.positions[k] = self.frame.rotation * three(1);
            packing.velocities[k] = self.frame.rotation * u;
            packing.spins[k] = if known.friction > 0.0 { self.frame.rotation * w } else { Vec3::zeros() };
            seen += 1;
            true
        })?;
        if seen != n {
            return refused(format!(
                "{seen} of {n} grains are left: the others were lost, as after an unstable step"
            ));
        }
        let mut contacts = Vec::new();
        rows::<8>(self.contacts, |row| {
            let (Some(i), Some(j)) = (index(row[0], n), index(row[1], n)) else { return false };
            let (from_j, force) = (Vec3::new(row[2], row[3], row[4]), Vec3::new(row[5], row[6], row[7]));
            let force = if known.friction > 0.0 { self.frame.rotation * force } else { Vec3::zeros() };
            contacts.extend(contact(&packing, [i, j], self.frame.rotation * -from_j, force));
            true
        })?;
        contacts.sort_by_key(|c: &Contact| (c.i, c.j, c.image));
        if let Some(c) = contacts.iter().find(|c| packing.overlap_ratio(c) > OVERLAP_LIMIT) {
            let [first, second] = [c.i, c.j].map(|g| packing.ids[g as usize]);
            return Err(EngineError::Overlap { step: packing.step, first, second, overlap: c.overlap });
        }
        packing.contacts = self.coulomb.limited(&packing, contacts);
        Ok(packing)
    }
}

/// The contact of two grains, the second at about `branch` from the first (m), with the tangential force on the first (N); `None`
/// if they do not overlap.
fn contact(packing: &Packing, [i, j]: [usize; 2], branch: Vec3, force: Vec3) -> Option<Contact> {
    let (i, j, branch, force) = if i <= j { (i, j, branch, force) } else { (j, i, -branch, -force) };
    let direct = packing.positions[j] - packing.positions[i];
    let image = packing.cell.fractional(&(branch - direct)).map(f64::round);
    let image: [i8; 3] = image.map(|n| n as i8).into();
    // A grain that touches its own image has that contact once.
    let (image, force) = if i == j && image < [0; 3] { (image.map(|n| -n), -force) } else { (image, force) };
    let branch = direct + packing.cell.shift(image);
    let distance = branch.norm();
    let (a, b) = (packing.radii[i], packing.radii[j]);
    let overlap = a + b - distance;
    if overlap <= 0.0 {
        return None;
    }
    let normal = branch / distance;
    let normal_force = packing.law.normal_force(&packing.material, effective_radius(a, b), overlap);
    let tangential_force = force - normal * force.dot(&normal);
    let pressed = Contact::pressed([i as u32, j as u32], image, normal, overlap, normal_force);
    Some(Contact { tangential_force, ..pressed })
}

/// The index of the grain with this number of LAMMPS.
fn index(number: f64, grains: usize) -> Option<usize> {
    (number >= 1.0 && number <= grains as f64).then(|| number as usize - 1)
}

/// Reads the rows of a dump; `take` returns false for one that is invalid.
fn rows<const N: usize>(path: &Path, mut take: impl FnMut(&[f64; N]) -> bool) -> Result<(), EngineError> {
    let failed = |e: std::io::Error| refused::<()>(format!("{}: {e}", path.display())).unwrap_err();
    let mut file = BufReader::new(std::fs::File::open(path).map_err(failed)?);
    let (mut line, mut is_row) = (String::new(), false);
    while file.read_line(&mut line).map_err(failed)? > 0 {
        if is_row {
            let mut row = [f64::NAN; N];
            row.iter_mut()
                .zip(line.split_ascii_whitespace())
                .for_each(|(v, w)| *v = w.parse().unwrap_or(f64::NAN));
            if !row.iter().all(|v| v.is_finite()) || !take(&row) {
                return refused(format!("a state that is not finite: {}", line.trim()));
            }
        }
        is_row |= line.starts_with("ITEM: ATOMS") || line.starts_with("ITEM: ENTRIES");
        line.clear();
    }
    Ok(())
}
