//! Statements made twice, or of half of the grains, are refused if they contradict each other.

use crate::support::glass;
use grainlab_core::Vec3;
use grainlab_recordings::import::{ImportError, Imported};
use grainlab_recordings::import::{ImportOptions, csv, extended_xyz, lammps_data, lammps_dump};
use std::ops::ControlFlow;

fn xyz(comment: &str, grains: &str) -> Result<Imported, ImportError> {
    let options = ImportOptions { density: None, ..glass() };
    let mut found = None;
    extended_xyz::each(&format!("2\n{comment}\n{grains}"), &options, &mut |imported| {
        found = Some(imported);
        ControlFlow::Break(())
    })?;
    Ok(found.unwrap())
}

const LATTICE: &str = "Lattice=\"1 0 0 0 1 0 0 0 1\"";
const WITH_MASS: &str = "0.1 0 0 0.1 2\n0.25 0 0 0.1 2\n";

#[test]
fn a_column_or_a_key_of_extended_xyz_that_occurs_twice_is_refused() {
    let columns = format!("{LATTICE} Properties=pos:R:3:radius:R:1:radius:R:1");
    assert!(xyz(&columns, WITH_MASS).unwrap_err().to_string().contains("radius occurs twice"));
    let keys = format!("{LATTICE} friction=10 friction=0.1 Properties=pos:R:3:radius:R:1:mass:R:1");
    assert!(xyz(&keys, WITH_MASS).unwrap_err().to_string().contains("\"friction\" occurs twice"));
}

#[test]
fn masses_of_extended_xyz_give_the_density_and_a_left_handed_cell_is_the_same_cell() {
    let properties = "Properties=pos:R:3:radius:R:1:mass:R:1";
    let right = xyz(&format!("{LATTICE} {properties}"), WITH_MASS).unwrap().packing;
    assert!((right.material.density - 2.0 / (4.0 / 3.0 * std::f64::consts::PI * 1e-3)).abs() < 1e-6);
    let left = xyz(&format!("Lattice=\"0 1 0 1 0 0 0 0 1\" {properties}"), WITH_MASS).unwrap().packing;
    assert_eq!((left.cell.volume(), left.contacts.len()), (right.cell.volume(), right.contacts.len()));
}

#[test]
fn densities_of_extended_xyz_are_those_of_its_grains_and_another_one_is_noted() {
    let read = |comment: &str, densities: [&str; 2]| {
        let comment = format!("{LATTICE} {comment} Properties=pos:R:3:radius:R:1:density:R:1");
        let [first, second] = densities;
        xyz(&comment, &format!("0.1 0 0 0.1 {first}\n0.25 0 0 0.1 {second}\n"))
    };
    let found = read("", ["2500", "2500"]).unwrap();
    assert!((found.packing.material.density / 2500.0 - 1.0).abs() < 1e-12);
    assert!(read("", ["2500", "7800"]).unwrap_err().to_string().contains("--density"));
    let notes = read("density=2500", ["2500", "7800"]).unwrap().notes.concat();
    assert!(notes.contains("1 grain(s) have another mass than density and radius give"), "{notes}");
    assert!(notes.contains("the density 2500 kg/m3 is used"), "{notes}");
}

#[test]
fn a_diameter_of_extended_xyz_is_twice_the_radius_and_is_refused_beside_another() {
    let read = |columns: &str, sizes: &str| {
        let comment = format!("{LATTICE} density=2500 Properties=pos:R:3:{columns}");
        xyz(&comment, &format!("0.1 0 0 {sizes}\n0.25 0 0 {sizes}\n"))
    };
    assert_eq!(read("diameter:R:1", "0.2").unwrap().packing.radii, [0.1, 0.1]);
    assert_eq!(read("diameter:R:1:radius:R:1", "0.2 0.1").unwrap().packing.radii, [0.1, 0.1]);
    let error = read("diameter:R:1:radius:R:1", "0.2 0.2").unwrap_err().to_string();
    assert!(error.contains("half of the diameter contradict"), "{error}");
}

#[test]
fn velocities_under_another_name_and_moduli_of_each_grain_are_not_read_and_noted() {
    let comment = format!("{LATTICE} density=2500 Properties=pos:R:3:radius:R:1:momenta:R:3");
    let notes = xyz(&comment, "0.1 0 0 0.1 1 0 0\n0.25 0 0 0.1 0 0 0\n").unwrap().notes.concat();
    assert!(notes.contains("the column momenta is not read"), "{notes}");
    let comment = format!("{LATTICE} density=2500 Properties=pos:R:3:radius:R:1:shear_modulus:R:1");
    let notes = xyz(&comment, "0.1 0 0 0.1 29e9\n0.25 0 0 0.1 70e9\n").unwrap().notes.concat();
    assert!(notes.contains("the column shear_modulus is not read: all grains have the same"), "{notes}");
}

#[test]
fn two_columns_of_a_dump_that_give_one_quantity_must_agree() {
    let dump = |columns: &str, rest: &str| {
        let rows = format!("1 0.1 0 0 {rest}\n2 0.25 0 0 {rest}\n");
        let text = format!(
            "ITEM: TIMESTEP\n7\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\nITEM: ATOMS id x y z {columns}\n{rows}"
        );
        let options = ImportOptions { density: None, ..glass() };
        lammps_dump::packings(&text, &options)
    };
    let error = |columns: &str, rest: &str| dump(columns, rest).unwrap_err().to_string();
    assert!(error("radius diameter density", "0.1 0.3 2500").contains("half of the diameter contradict"));
    assert!(error("radius mass density", "0.1 2 2500").contains("density and radius contradict"));
    assert!(error("radius shapex", "0.1 0.2").contains("single spheres"));
    let both = dump("radius diameter density", "0.1 0.2 2500").unwrap().remove(0).packing;
    assert!((both.material.density / 2500.0 - 1.0).abs() < 1e-12);
}

#[test]
fn a_data_file_names_its_numbers_and_states_its_box_once_and_all_velocities_or_none() {
    let data = |header: &str, velocities: &str| {
        let text = format!(
            "LAMMPS data file, timestep = 12\n\n2 atoms\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\n{header}\nAtoms # sphere\n\n\
             1 1 0.2 2500 0.1 0 0\n2 1 0.2 2500 0.25 0 0\n{velocities}"
        );
        lammps_data::packing(&text, &glass())
    };
    let error = |header: &str, velocities: &str| data(header, velocities).unwrap_err().to_string();
    let moving = "\nVelocities\n\n2 1 0 0 0 0 0\n";
    assert!(error("0 2 xlo xhi\n", "").contains("xlo xhi occurs twice"));
    assert!(error("7 8 9\n", "").contains("line 7: numbers without a name"));
    assert!(error("1 0 0 avec\n0 1 0 bvec\n0 0 1 cvec\n0 0 0 abc origin\n", "").contains("a box twice"));
    assert!(error("", moving).contains("1 velocities, but none of grain 1"));
    assert!(error("", &format!("{moving}2 1 0 0 0 0 0\n")).contains("occurs twice"));
    let whole = data("", &format!("{moving}1 0 0 0 0 0 0\n")).unwrap().packing;
    assert_eq!((whole.step, whole.velocities[1]), (12, Vec3::x()));
}

#[test]
fn a_sidecar_is_read_by_long_names_too_and_walls_and_gravity_are_refused() {
    let grains = "p,1,0.1,0,0,0.1,10.47,0,0,0,0,0,0\np,2,0.25,0,0,0.1,10.47,0,0,0,0,0,0\n";
    let read = |keys: &str| {
        let sidecar = format!(
            "{{\"shear_modulus\": 3e9, \"poisson_ratio\": 0.3, \"density\": 2500, \"friction\": 0.2, \"box_L\": [1, 1, 1]{keys}}}"
        );
        csv::packing(grains, Some(&sidecar), &ImportOptions::default())
    };
    let material = read(", \"walls\": [], \"gravity\": [0, 0, 0]").unwrap().packing.material;
    assert_eq!((material.shear_modulus, material.poisson_ratio), (3e9, 0.3));
    let equal = ", \"cell\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"G\": 3e9, \"nu\": 0.3, \"mu_prep\": 0.2";
    assert_eq!(read(equal).unwrap().packing.material, material);
    for (keys, what) in [
        (", \"walls\": [\"z\"]", "without walls"),
        (", \"gravity\": [0, 0, -9.81]", "without gravity"),
        (", \"nu\": 0.2", "nu and poisson_ratio state one quantity"),
        (", \"G\": 2e9", "G and shear_modulus state one quantity"),
        (", \"mu_prep\": \"inf\"", "mu_prep and friction state one quantity"),
        (", \"cell\": [[1, 0, 0], [0, 1, 0], [0, 0, 2]]", "cell and box_L state one quantity"),
        (", \"density\": 2500", "duplicate field `density`"),
    ] {
        let error = read(keys).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    }
}
