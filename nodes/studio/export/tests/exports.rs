//! Exports are read back.

use grainlab_core::{Packing, Vec3};
use grainlab_export::{ExportFormat, Exporter};
use grainlab_recordings::import::{ImportOptions, load};
use std::path::{Path, PathBuf};

mod reference;
use reference::reference;

fn golden() -> Packing {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/golden/packings/anisotropic_2000.csv.gz");
    load(&path, &ImportOptions::default()).unwrap().packings.remove(0).packing
}

/// Writes `packings` in `format`; the folder and the names of the files.
fn export(packings: &[Packing], format: ExportFormat) -> (tempfile::TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let mut exporter = Exporter::new(format);
    let mut files: Vec<PathBuf> = Vec::new();
    let mut parts: Vec<_> = packings.iter().flat_map(|p| exporter.next(p)).collect();
    parts.extend(exporter.finish());
    for part in parts {
        let path = folder.path().join(&part.name);
        let mut content = std::fs::read_to_string(&path).unwrap_or_default();
        content += &part.content;
        std::fs::write(&path, content).unwrap();
        if !files.contains(&path) {
            files.push(path);
        }
    }
    (folder, files)
}

#[test]
fn frames_of_extended_xyz_have_the_grains_bit_for_bit() {
    let first = golden();
    let second = Packing { step: 7, time: 0.25, ..first.clone() };
    let (_folder, files) = export(&[first.clone(), second], ExportFormat::Xyz);
    assert_eq!(files.len(), 1);
    let back = load(&files[0], &ImportOptions::default()).unwrap().packings;
    assert_eq!(back.len(), 2);
    for (found, step) in back.iter().zip([first.step, 7]) {
        let p = &found.packing;
        assert_eq!(
            (p.positions.clone(), p.radii.clone(), p.step),
            (first.positions.clone(), first.radii.clone(), step)
        );
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
    let (_folder, files) = export(std::slice::from_ref(&packing), ExportFormat::LammpsData);
    let options = ImportOptions {
        shear_modulus: Some(packing.material.shear_modulus),
        poisson_ratio: Some(packing.material.poisson_ratio),
        friction: Some(packing.friction),
        ..ImportOptions::default()
    };
    let back = load(&files[0], &options).unwrap().packings.remove(0).packing;
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
    let (_folder, files) = export(&[packing.clone(), later], ExportFormat::LammpsDump);
    let m = &packing.material;
    let options = ImportOptions {
        contact_forces: Some(std::fs::read_to_string(&files[1]).unwrap()),
        ..ImportOptions::of_grains(m, packing.friction)
    };
    // LAMMPS states units before the first frame alone; OVITO stops at a second statement.
    let dump = std::fs::read_to_string(&files[0]).unwrap();
    assert!(dump.starts_with("ITEM: UNITS\nsi\nITEM: TIMESTEP") && dump.matches("UNITS").count() == 1);
    let mut frames = load(&files[0], &options).unwrap().packings;
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
