//! Exported packings are read back unchanged.

use grainlab_core::contact::{ContactLaw, Linear, RollingResistance, SpringLaw};
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_export::{self as export, ExportFormat, Exporter};
use grainlab_recordings::import::{ImportOptions, csv, extended_xyz, lammps_data, lammps_dump, load};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

/// A packing of 500 grains from LAMMPS.
fn reference() -> Packing {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/golden/reference");
    let mut loaded = load(&folder.join("ref_packing_500.csv.gz"), &Default::default()).unwrap();
    loaded.packings.remove(0).packing
}

/// What files of LAMMPS lack: all properties of the grains but the density.
fn lacking(p: &Packing) -> ImportOptions {
    ImportOptions { density: None, ..ImportOptions::of_grains(&p.material, p.friction) }
}

/// The files of these packings by their names.
fn files(packings: &[&Packing], format: ExportFormat) -> BTreeMap<String, String> {
    let mut exporter = Exporter::new(format);
    let mut files = BTreeMap::<String, String>::new();
    for part in packings.iter().flat_map(|p| exporter.next(p)) {
        *files.entry(part.name).or_default() += &part.content;
    }
    files
}

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
        let back = lammps_dump::packings(&export::lammps_dump(&p), &lacking(&p)).unwrap().remove(0).packing;
        assert_eq!(
            (back.step, &back.ids, &back.positions, &back.spins),
            (p.step, &p.ids, &p.positions, &p.spins)
        );
        // The box is written as bounds of the tilted cell, which adds one rounding.
        assert!((back.cell.matrix() - p.cell.matrix()).amax() < 1e-18);
        // Mass and radius give the density to rounding.
        assert!((back.material.density / p.material.density - 1.0).abs() < 1e-14);
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
        let forces = Some(export::lammps_local(&p));
        let options = ImportOptions { law: Some(p.law), contact_forces: forces, ..lacking(&p) };
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
    let options = lacking(&p);
    let dumped = lammps_dump::packings(&export::lammps_dump(&p), &options).unwrap().remove(0).packing;
    assert_eq!(
        (dumped.cell, &dumped.positions, &dumped.spins, &dumped.radii),
        (p.cell, &p.positions, &p.spins, &p.radii)
    );
    let data = lammps_data::packing(&export::lammps_data(&p), &options).unwrap().packing;
    assert_eq!((data.cell, &data.velocities, &data.spins), (p.cell, &p.velocities, &p.spins));
}

#[test]
fn frames_of_extended_xyz_have_the_grains_bit_for_bit() {
    let first = reference();
    let second = Packing { step: 7, time: 0.25, ..first.clone() };
    let mut back = Vec::new();
    let text = &files(&[&first, &second], ExportFormat::Xyz)["packings.xyz"];
    let mut take = |imported| {
        back.push(imported);
        ControlFlow::Continue(())
    };
    extended_xyz::each(text, &ImportOptions::default(), &mut take).unwrap();
    assert_eq!(back.iter().map(|found| found.step).collect::<Vec<_>>(), [first.step, 7]);
    for p in back.iter().map(|found| &found.packing) {
        assert_eq!((&p.positions, &p.radii), (&first.positions, &first.radii));
        assert_eq!((p.cell, p.material, p.friction), (first.cell, first.material, first.friction));
        assert_eq!(p.contacts.len(), first.contacts.len());
    }
}

#[test]
fn lammps_data_has_the_grains_folded_into_the_cell() {
    let mut packing = reference();
    // Two cells away.
    let shift = packing.cell.matrix().column(0) * 2.0;
    packing.positions[0] += shift;
    let back = lammps_data::packing(&export::lammps_data(&packing), &lacking(&packing)).unwrap().packing;
    assert_eq!(back.radii, packing.radii);
    assert_eq!(back.contacts.len(), reference().contacts.len());
    assert!(back.cell.fractional(&back.positions[0]).iter().all(|f| (0.0..1.0).contains(f)));
}

#[test]
fn dumps_of_grains_and_contacts_state_units_once_and_give_the_forces_back() {
    let mut packing = reference();
    // A dump has forces, and the reader takes normals from positions; those of the file, and what is perpendicular to them,
    // are rounded.
    let normals: Vec<Vec3> = packing.contacts.iter().map(|c| packing.branch(c).normalize()).collect();
    for (c, normal) in packing.contacts.iter_mut().zip(normals) {
        c.normal = normal;
        c.tangential_force -= normal * normal.dot(&c.tangential_force);
    }
    let later = Packing { step: packing.step + 1, ..packing.clone() };
    let files = files(&[&packing, &later], ExportFormat::LammpsDump);
    let (dump, forces) = (&files["packings.dump"], files["contacts.dump"].clone());
    let grains = ImportOptions::of_grains(&packing.material, packing.friction);
    let options = ImportOptions { contact_forces: Some(forces), ..grains };
    // LAMMPS states units before the first frame alone; OVITO stops at a second statement.
    assert!(dump.starts_with("ITEM: UNITS\nsi\nITEM: TIMESTEP") && dump.matches("UNITS").count() == 1);
    let mut frames = lammps_dump::packings(dump, &options).unwrap();
    assert_eq!(frames.len(), 2);
    let back = frames.remove(0).packing;
    let mean = packing.contacts.iter().map(|c| c.normal_force).sum::<f64>() / packing.contacts.len() as f64;
    assert_eq!(back.contacts.len(), packing.contacts.len());
    for (a, b) in back.contacts.iter().zip(&packing.contacts) {
        assert_eq!((a.i, a.j, a.image), (b.i, b.j, b.image));
        let wrong = (a.normal_force - b.normal_force).abs() / mean;
        assert!(wrong < 1e-12, "{wrong:e} {:e} {:e}", a.normal_force, b.normal_force);
        assert!((a.tangential_force - b.tangential_force).norm() < 1e-12 * mean);
    }
}
