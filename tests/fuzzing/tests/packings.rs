//! Packings as text: LAMMPS, YADE, CSV.

use fuzzing::{Counting, Target};
use grainlab_core::{Mat3, Material, Vec3};
use grainlab_recordings::import::{ImportOptions, csv, lammps_data, lammps_dump, yade};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A grain has at least 60 bytes of text, some 300 of memory, and at most 160 neighbours of 100 bytes each at
/// the largest allowed overlaps.
const MEMORY: (usize, usize) = (8 << 20, 2048);

const WORDS: [&str; 12] =
    ["ITEM:", "TIMESTEP", "ATOMS", "Atoms", "xlo", "xhi", "x_y_z_r", "cell", "p", "c", "#format", "radius"];

/// Data that files lack.
fn complete() -> ImportOptions {
    ImportOptions::of_grains(&Material::GLASS, 0.1)
}

fn with_cell() -> ImportOptions {
    ImportOptions { cell: Some(Mat3::from_diagonal(&Vec3::repeat(1e-3))), ..complete() }
}

/// `import` returns whether it gave a packing; for the seeds it must.
fn run(name: &str, seeds: &[&str], mut import: impl FnMut(&str) -> bool) {
    assert!(seeds.iter().all(|seed| import(seed)), "{name}: a seed is no packing");
    Target {
        name,
        seeds: seeds.iter().map(|s| s.as_bytes().to_vec()).collect(),
        words: &WORDS,
        memory: MEMORY,
        decode: &mut |bytes| _ = import(&String::from_utf8_lossy(bytes)),
    }
    .run();
}

const DUMP: &str = "ITEM: UNITS\nsi\nITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n4\nITEM: BOX BOUNDS pp pp pp\n0 1e-2\n0 1e-2\n0 1e-2\n\
ITEM: ATOMS id type radius x y z vx vy vz\n1 1 1e-3 1e-3 1e-3 1e-3 0 0 0\n2 1 1e-3 2.999e-3 1e-3 1e-3 0 0 0\n\
3 1 1e-3 1e-3 2.999e-3 1e-3 0 0 0\n4 1 1e-3 9.001e-3 1e-3 1e-3 0 0 0\n";

const TILTED: &str = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS xy xz yz pp pp pp\n0 1.5e-2 5e-3\n0 1e-2 0\n0 1e-2 0\n\
ITEM: ATOMS id diameter xs ys zs mass\n1 2e-3 0.1 0.1 0.1 1e-5\n2 2e-3 0.2 0.1 0.1 1e-5\n";

const LOCAL: &str = "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ENTRIES\n2\nITEM: BOX BOUNDS pp pp pp\n0 1e-2\n0 1e-2\n0 1e-2\n\
ITEM: ENTRIES index c_pl[1] c_pl[2] c_pf[1] c_pf[2] c_pf[3] c_pf[4] c_pf[5] c_pf[6] c_pf[7]\n\
1 1 2 1.999e-3 -1.0 0 0 0 0.01 0\n2 1 3 1.999e-3 0 -1.0 0 0.01 0 0\n";

const DATA: &str = "LAMMPS data file via write_data, version 2 Aug 2023, timestep = 100, units = si\n\n3 atoms\n1 atom types\n\n\
0 1e-2 xlo xhi\n0 1e-2 ylo yhi\n0 1e-2 zlo zhi\n1e-3 0 0 xy xz yz\n\nAtoms # sphere\n\n1 1 2e-3 2500 1e-3 1e-3 1e-3 0 0 0\n\
2 1 2e-3 2500 2.999e-3 1e-3 1e-3 0 0 0\n3 1 2e-3 2500 5e-3 5e-3 5e-3 0 0 0\n\nVelocities\n\n1 0 0 0 0 0 0\n2 0 0 1e-3 0 0 0\n3 0 0 0 0 0 0\n";

#[test]
fn a_lammps_dump_gives_packings_or_an_error() {
    run("lammps-dump", &[DUMP, TILTED], |text| lammps_dump::packings(text, &complete()).is_ok());
}

#[test]
fn a_lammps_dump_of_forces_gives_contacts_or_an_error() {
    run("lammps-local", &[LOCAL], |text| {
        let options = ImportOptions { contact_forces: Some(text.to_owned()), ..complete() };
        lammps_dump::packings(DUMP, &options).is_ok()
    });
}

#[test]
fn a_lammps_data_file_gives_a_packing_or_an_error() {
    run("lammps-data", &[DATA], |text| lammps_data::packing(text, &complete()).is_ok());
}

#[test]
fn a_yade_export_gives_a_packing_or_an_error() {
    let head = |text: &'static str, lines: usize| text.lines().take(lines).collect::<Vec<_>>().join("\n");
    let seeds = [
        head(include_str!("../../golden/yade/x_y_z_r.txt"), 20),
        head(include_str!("../../golden/yade/id_x_y_z_r_matId.txt"), 20),
        head(include_str!("../../golden/yade/x_y_z_r_attrs.txt"), 20),
    ];
    let seeds: Vec<&str> = seeds.iter().map(String::as_str).collect();
    run("yade", &seeds, |text| {
        let without = yade::packing(text, &complete()).is_ok();
        yade::packing(text, &with_cell()).is_ok() || without
    });
}

#[test]
fn a_csv_with_its_sidecar_gives_a_packing_or_an_error() {
    let lines: Vec<&str> = include_str!("../../golden/yade/packing.csv").lines().collect();
    let few = |from: usize, to: usize| lines[from..to.min(lines.len())].join("\n");
    let contacts = lines.iter().position(|l| l.starts_with("c,")).unwrap();
    let table = format!("{}\n{}", few(0, contacts), few(contacts, contacts + 10));
    let (few_rows, sidecar) = (few(0, 12), include_str!("../../golden/yade/packing.json"));
    run("csv", &[&table, &few_rows], |text| csv::packing(text, Some(sidecar), &complete()).is_ok());
    run("csv-sidecar", &[sidecar], |text| csv::packing(&few_rows, Some(text), &complete()).is_ok());
}
