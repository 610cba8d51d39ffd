//! A packing from LAMMPS: its import has the numbers of LAMMPS.

use crate::support::golden;
use grainlab_core::contact_search;
use grainlab_core::stress::stress;
use grainlab_recordings::import::{Imported, load};

pub(crate) fn reference() -> Imported {
    let mut loaded = load(&golden("reference/ref_packing_500.csv.gz"), &Default::default()).unwrap();
    assert_eq!((loaded.packings.len(), loaded.warnings.len()), (1, 0));
    loaded.packings.remove(0)
}

fn sidecar() -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(golden("reference/ref_packing_500.json")).unwrap()).unwrap()
}

#[test]
fn it_has_its_grains_contacts_and_solid_fraction() {
    let imported = reference();
    let (p, known) = (&imported.packing, sidecar());
    assert_eq!((p.grains() as u64, p.contacts.len() as u64), (500, 1277));
    assert_eq!(known["n_contacts"], 1277);
    assert!((p.solid_fraction() / known["phi"].as_f64().unwrap() - 1.0).abs() < 1e-14);
    assert_eq!((p.friction, p.material.shear_modulus, p.material.poisson_ratio), (0.1, 29.0e9, 0.2));
    // The list has exactly the contacts found from positions, and masses agree with the density.
    assert_eq!(imported.notes, [""; 0]);
}

#[test]
fn stress_from_contacts_is_that_of_the_sidecar() {
    let p = reference().packing;
    let s = stress(&p);
    let known = &sidecar()["stress_from_contacts"];
    let scale = s.tensor.mean();
    for (r, c) in (0..9).map(|k| (k / 3, k % 3)) {
        // The tensor of the sidecar is not symmetric in its last digits; ours is its symmetric part.
        // Positions have the same 17 digits in both, so that 1e-9 of the pressure only allows for summation.
        let expected = 0.5 * (known[r][c].as_f64().unwrap() + known[c][r].as_f64().unwrap());
        assert!((s.tensor.matrix()[(r, c)] - expected).abs() < 1e-9 * scale, "({r}, {c})");
    }
    assert!((scale / 99764.42642302446 - 1.0).abs() < 1e-9);
    assert!(s.asymmetry < 1e-9 * scale, "torques balance: {}", s.asymmetry);
}

#[test]
fn normal_forces_are_hertz_of_the_positions() {
    let p = reference().packing;
    let mean = p.contacts.iter().map(|c| c.normal_force).sum::<f64>() / p.contacts.len() as f64;
    let mut worst = 0.0f64;
    for c in &p.contacts {
        let r_eff = p.effective_radius(c);
        let overlap = 2e-4 - p.branch(c).norm();
        let hertz = p.material.normal_force(r_eff, overlap);
        worst = worst.max((c.normal_force - hertz).abs() / mean);
        assert!((c.normal_force - hertz).abs() < 1e-9 * mean, "{c:?}");
        // LAMMPS rotates the tangential force with an error of 3e-11 of the mean normal force.
        assert!(c.tangential_force.dot(&c.normal).abs() < 1e-10 * mean);
        // Coulomb's law holds with the friction of the preparation, to the rounding of LAMMPS.
        assert!(c.tangential_force.norm() <= p.friction * c.normal_force * (1.0 + 1e-9));
    }
    // The measure of the sidecar is also relative to the mean force: grains that barely touch (overlap 1e-14
    // m) have a force from the remaining contact damping.
    let known = sidecar()["max_rel_dev_fn_vs_hertz_positions"].as_f64().unwrap();
    assert!((worst / known - 1.0).abs() < 1e-3, "{worst:e} {known:e}");
}

#[test]
fn forces_balance_on_every_grain() {
    // With a wrong sign of normals or tangential forces, or a wrong image, this fails by orders of magnitude.
    let p = reference().packing;
    let mut net = vec![grainlab_core::Vec3::zeros(); p.grains()];
    let mut mean = 0.0;
    for c in &p.contacts {
        let on_i = c.tangential_force - c.normal * c.normal_force;
        net[c.i as usize] += on_i;
        net[c.j as usize] -= on_i;
        mean += on_i.norm() / p.contacts.len() as f64;
    }
    let worst = net.iter().map(|f| f.norm()).fold(0.0, f64::max);
    // The sidecar's unbalanced_max is 3.9e-8 of the mean contact force.
    assert!(worst < 1e-7 * mean, "{}", worst / mean);
}

#[test]
fn contacts_found_from_positions_are_those_listed() {
    let p = reference().packing;
    let found = contact_search::of_packing(&p).unwrap();
    assert_eq!(found.len(), p.contacts.len());
    for (a, b) in found.iter().zip(&p.contacts) {
        assert_eq!((a.i, a.j, a.image), (b.i, b.j, b.image));
        // Overlaps are 2.5e-4 of a diameter, and positions are exact to 1e-16 of a cell.
        assert!((a.overlap - b.overlap).abs() < 1e-17 && (a.normal - b.normal).norm() < 1e-12);
    }
}
