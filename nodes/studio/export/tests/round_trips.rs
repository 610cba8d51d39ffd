//! Exported packings are read back unchanged.

use grainlab_core::contact::{ContactLaw, Linear, RollingResistance, SpringLaw};
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_export as export;
use grainlab_recordings::import::{ImportOptions, csv, lammps_data, lammps_dump};

mod reference;
use reference::reference;

/// The reference packing with other values for all its defaults.
fn rich() -> Packing {
    let mut p = reference();
    (p.step, p.time, p.time_step, p.friction) = (123_456, 0.1 + 0.2, 3e-8, f64::INFINITY);
    let springs = SpringLaw::Linear(Linear { normal_stiffness: 1.5e8, stiffness_ratio: 0.4 });
    let rolling = RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 };
    p.law = ContactLaw::of(springs).with_rolling(rolling);
    let forces: Vec<f64> = (p.contacts.iter())
        .map(|c| p.law.normal_force(&p.material, p.effective_radius(c), c.overlap))
        .collect();
    p.contacts.iter_mut().zip(forces).for_each(|(c, force)| c.normal_force = force);
    for (k, c) in p.contacts.iter_mut().enumerate() {
        c.rolling_force = c.normal.cross(&Vec3::x()) / (k as f64 + 7.0);
    }
    p.deformation = Mat3::new(0.99, 1e-3, 0.0, 0.0, 0.98, -2e-4, 1e-9, 0.0, 0.97);
    for (k, spin) in p.spins.iter_mut().enumerate() {
        spin.x = 1.0 / (k as f64 + 3.0);
    }
    p.validated().unwrap()
}

#[test]
fn csv_and_sidecar_bring_back_the_packing_bit_for_bit() {
    let p = rich();
    let back = csv::packing(&export::csv(&p), Some(&export::sidecar(&p)), &ImportOptions::default()).unwrap();
    assert_eq!(back.packing, p);
    assert_eq!((back.step, back.notes.len()), (p.step, 0));
}

#[test]
fn a_dump_brings_back_grains_and_network_in_straight_and_tilted_cells() {
    let straight = rich();
    let mut tilted = rich();
    let shear = Mat3::new(1.0, 0.02, -0.01, 0.0, 1.0, 0.03, 0.0, 0.0, 1.0);
    tilted.cell = Cell::new(shear * straight.cell.matrix()).unwrap();
    tilted.positions.iter_mut().for_each(|x| *x = shear * *x);
    tilted.contacts = grainlab_core::contact_search::find(
        &tilted.cell,
        &tilted.positions,
        &tilted.radii,
        |r_eff, overlap| tilted.law.normal_force(&tilted.material, r_eff, overlap),
    )
    .unwrap();
    assert!(tilted.contacts.len() > 100);
    for p in [straight, tilted] {
        let material = p.material;
        let options = ImportOptions {
            shear_modulus: Some(material.shear_modulus),
            poisson_ratio: Some(material.poisson_ratio),
            friction: Some(p.friction),
            ..ImportOptions::default()
        };
        let text = export::lammps_dump(&p);
        let back = lammps_dump::packings(&text, &options).unwrap().remove(0).packing;
        assert_eq!(
            (back.step, &back.ids, &back.positions, &back.spins),
            (p.step, &p.ids, &p.positions, &p.spins)
        );
        // The box is written as bounds of the tilted cell, which adds one rounding.
        assert!((back.cell.matrix() - p.cell.matrix()).amax() < 1e-18);
        // Mass and radius give the density to rounding.
        assert!((back.material.density / material.density - 1.0).abs() < 1e-14);
        let keys = |p: &Packing| p.contacts.iter().map(|c| (c.i, c.j, c.image)).collect::<Vec<_>>();
        assert_eq!(keys(&back), keys(&p));
    }
}

#[test]
fn a_grain_has_one_id_in_all_files_for_lammps_from_one_on() {
    for first in [0, 1, 7] {
        let mut p = rich();
        p.ids = (first..).take(p.grains()).collect();
        let expected: Vec<u32> = p.ids.iter().map(|id| if first == 0 { id + 1 } else { *id }).collect();
        let options = ImportOptions {
            shear_modulus: Some(p.material.shear_modulus),
            poisson_ratio: Some(p.material.poisson_ratio),
            friction: Some(p.friction),
            law: Some(p.law),
            contact_forces: Some(export::lammps_local(&p)),
            ..ImportOptions::default()
        };
        let dump = lammps_dump::packings(&export::lammps_dump(&p), &options).unwrap().remove(0).packing;
        // The step of a data file is in a title of its own form.
        let data = lammps_data::packing(
            &export::lammps_data(&p),
            &ImportOptions { contact_forces: None, ..options },
        );
        let data = data.unwrap().packing;
        assert_eq!((&dump.ids, &data.ids), (&expected, &expected));
        assert_eq!(dump.radii, data.radii);
        let forces = |p: &Packing| p.contacts.iter().map(|c| (c.i, c.j, c.normal_force)).collect::<Vec<_>>();
        for (own, read) in forces(&p).into_iter().zip(forces(&dump)) {
            assert!(
                (own.0, own.1) == (read.0, read.1) && (own.2 / read.2 - 1.0).abs() < 1e-9,
                "{own:?} {read:?}"
            );
        }
    }
}

#[test]
fn a_cell_of_any_orientation_comes_back_from_dump_and_data_file_bit_for_bit() {
    let mut p = rich();
    let shear = Mat3::new(1.0, 0.02, -0.01, 0.02, 1.0, 0.03, -0.01, 0.03, 1.0);
    p.cell = Cell::new(shear * p.cell.matrix()).unwrap();
    p.positions.iter_mut().for_each(|x| *x = shear * *x);
    let options = ImportOptions {
        shear_modulus: Some(p.material.shear_modulus),
        poisson_ratio: Some(p.material.poisson_ratio),
        friction: Some(p.friction),
        ..ImportOptions::default()
    };
    let dumped = lammps_dump::packings(&export::lammps_dump(&p), &options).unwrap().remove(0).packing;
    assert_eq!(
        (dumped.cell, &dumped.positions, &dumped.spins, &dumped.radii),
        (p.cell, &p.positions, &p.spins, &p.radii)
    );
    let data = lammps_data::packing(&export::lammps_data(&p), &options).unwrap().packing;
    assert_eq!((data.cell, &data.velocities, &data.spins), (p.cell, &p.velocities, &p.spins));
}
