//! Files of other programs: read by the rules of their formats, refused with line and reason.

use grainlab_core::Vec3;
use grainlab_recordings::import::{
    ImportError, ImportOptions, Setting, csv, extended_xyz, lammps_data, lammps_dump, load,
};

use crate::reference_packing::reference;
use crate::support::{assert_refused, assert_says, glass, golden, in_cube};

const PAIR: &str =
    "p,1,0.1,0,0,0.1,10.471975511965978,0,0,0,0,0,0\np,2,0.95,0,0,0.1,10.471975511965978,0,0,0,0,0,0\n";

fn pair(contact: &str) -> Result<grainlab_recordings::import::Imported, ImportError> {
    csv::packing(&format!("{PAIR}{contact}"), None, &in_cube(1.0))
}

#[test]
fn a_listed_contact_is_turned_to_our_convention() {
    // Grain 2 is at x = −0.05 of the next cell: overlap 0.05; the direction from j = 1 to i = 2 is −x, across
    // the boundary.
    let p = pair("c,2,1,-1,0,0,0.05,3,0,0.5,0").unwrap().packing;
    let c = p.contacts[0];
    assert_eq!((c.i, c.j, c.image, c.normal_force), (0, 1, [-1, 0, 0], 3.0));
    assert_eq!((c.normal, c.tangential_force), (-Vec3::x(), Vec3::new(0.0, -0.5, 0.0)));
    let same = pair("c,1,2,1,0,0,0.05,3,0,-0.5,0").unwrap().packing;
    assert_eq!(same.contacts, p.contacts);
}

#[test]
fn forces_of_another_contact_law_are_noted() {
    let notes = |force: f64| pair(&format!("c,1,2,1,0,0,0.05,{force},0,0,0")).unwrap().notes.concat();
    let found = csv::packing(PAIR, None, &in_cube(1.0)).unwrap().packing.contacts[0].normal_force;
    assert!(!notes(found).contains("Hertz"));
    // A linear spring, a wrong unit.
    assert!(notes(1.1 * found).contains("differ from the contact law by 10.0 %"), "{}", notes(1.1 * found));
}

#[test]
fn forces_beyond_the_limit_of_friction_are_noted() {
    let notes =
        |tangential: f64| pair(&format!("c,1,2,1,0,0,0.05,3,0,{tangential},0")).unwrap().notes.concat();
    assert!(!notes(0.3).contains("friction"));
    assert!(notes(0.5).contains("1 contact carries more tangential force than a friction of 0.1 allows"));
}

#[test]
fn contacts_that_contradict_positions_are_refused() {
    for (row, quantity) in [
        ("c,2,1,-1,0,0,0.0500001,3,0,0.5,0", "overlap"),
        ("c,2,1,-0.99995000041666528,0.0099998333341666645,0,0.05,3,0,0,0.5", "angle"),
        ("c,2,1,1,0,0,0.05,3,0,0.5,0", "angle"),
        ("c,2,1,-1,0,0,0.05,3,0.5,0,0", "tangential"),
    ] {
        let error = pair(row).unwrap_err().to_string();
        assert!(error.contains(quantity) && error.starts_with("line 3"), "{row}: {error}");
    }
    let unknown = pair("c,2,7,-1,0,0,0.05,3,0,0.5,0").unwrap_err().to_string();
    assert!(unknown.starts_with("line 3: a contact names grain 7"), "{unknown}");
}

#[test]
fn malformed_rows_are_named_by_line() {
    for (row, expected) in [
        ("x,1", "p or c"),
        ("p,3,1,2", "12 fields, not 3"),
        ("c,1,2", "10 or 13 fields, not 2"),
        ("p,-3,0,0,0,1,1,0,0,0,0,0,0", "id is -3"),
        ("p,3,0,zero,0,1,1,0,0,0,0,0,0", "position is \"zero\""),
        ("p,3,0.1,0,0,0.1,1,0,0,0,0,0,0", "grains 1 and 3 have the same centre"),
    ] {
        let error = pair(row).unwrap_err().to_string();
        assert!(error.contains(expected), "{row}: {error}");
    }
}

#[test]
fn a_missing_sidecar_is_answered_with_the_flags_that_replace_it() {
    let root = tempfile::tempdir().unwrap();
    let alone = root.path().join("alone.csv.gz");
    std::fs::copy(golden("reference/ref_packing_500.csv.gz"), &alone).unwrap();
    let error = load(&alone, &ImportOptions::default()).unwrap_err().to_string();
    assert_says(
        &error,
        &["alone.csv.gz", "--cell", "--shear-modulus", "--poisson", "--density", "--friction"],
    );
    let ImportError::Missing(missing) = csv::packing(PAIR, None, &glass()).unwrap_err() else { panic!() };
    assert_eq!(missing, [Setting::Cell]);
    let cell = Some(*reference().packing.cell.matrix());
    let loaded = load(&alone, &ImportOptions { cell, ..glass() }).unwrap();
    assert_eq!(loaded.packings[0].packing, reference().packing);
}

/// Statements of a file that no packing can meet, or that the file does not keep, are refused.
#[test]
fn units_boundaries_and_counts_that_a_file_states_are_honoured_or_refused() {
    let frame = "2\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=species:S:1:pos:R:3:radius:R:1 pbc=\"T T T\" units=\"m kg s\" step=3\n\
        X 0.1 0.1 0.1 0.11\nX 0.1 0.1 0.3 0.11\n";
    let xyz = |text: &str| {
        let mut found = Vec::new();
        extended_xyz::each(text, &glass(), &mut |p| {
            found.push(p);
            std::ops::ControlFlow::Continue(())
        })
        .map(|()| found.remove(0))
    };
    assert_eq!(xyz(frame).unwrap().step, 3);
    assert_eq!(xyz(&frame.replace(" pbc=\"T T T\" units=\"m kg s\"", "")).unwrap().packing.contacts.len(), 1);
    let changes = [
        ("T T T", "T T F", "pbc T T F is not supported"),
        ("T T T", "F F F", "pbc F F F"),
        ("m kg s", "mm g s", "units mm g s is not supported"),
        ("step=3", "step=abc", "step is \"abc\""),
        ("step=3", "contact_law=glue", "glue"),
    ];
    assert_refused(frame, &changes, xyz);
    let linear =
        xyz(&frame.replace("step=3", "contact_law=linear contact_law_parameters=\"1e5 0.5\"")).unwrap();
    assert_eq!(linear.packing.law.name(), "linear");
    let sidecar =
        |keys: &str| csv::packing(PAIR, Some(&format!("{{{keys}, \"box_L\": [1, 1, 1]}}")), &glass());
    let right = sidecar(r#""N": 2, "n_contacts": 0, "units": "SI", "pbc": [true, true, true]"#).unwrap();
    assert_eq!(right.packing.grains(), 2);
    for (keys, expected) in [
        (r#""N": 3"#, "it has 2 grains, and states 3"),
        (r#""n_contacts": 5"#, "it has 0 contacts, and states 5"),
        (r#""units": "mm g s""#, "units mm g s"),
        (r#""pbc": [true, true, false]"#, "periodic"),
    ] {
        let error = sidecar(keys).unwrap_err().to_string();
        assert!(error.contains(expected), "{keys}: {error}");
    }
    for section in ["Bonds", "Bodies"] {
        let error = lammps_data::packing(&format!("{DATA}\n{section}\n\n1 1 10 20\n"), &glass()).unwrap_err();
        assert!(error.to_string().contains(section), "{error}");
    }
    let forces = ImportOptions { contact_forces: Some("ITEM: TIMESTEP".into()), ..in_cube(1.0) };
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("pair.csv");
    std::fs::write(&path, PAIR).unwrap();
    let error = load(&path, &forces).unwrap_err().to_string();
    assert!(error.contains("beside a LAMMPS dump or data file only"), "{error}");
}

#[test]
fn a_value_given_replaces_that_of_every_file_and_says_so() {
    let sidecar = r#"{"G": 29e9, "nu": 0.2, "density": 7850, "mu_prep": 0.3, "box_L": [1, 1, 1]}"#;
    let given = ImportOptions { density: Some(2500.0), radius: Some(0.12), ..ImportOptions::default() };
    let found = csv::packing(PAIR, Some(sidecar), &given).unwrap();
    assert_eq!((found.packing.material.density, found.packing.radii.clone()), (2500.0, vec![0.12; 2]));
    let replaced = "the density of the file, 7850 kg/m3, is replaced by the one given, 2500";
    assert_says(&found.notes.join("\n"), &[replaced, "the radii of the file"]);
    // An equal value is not replaced.
    let same = ImportOptions { density: Some(7850.0), ..ImportOptions::default() };
    let notes = csv::packing(PAIR, Some(sidecar), &same).unwrap().notes.join("\n");
    assert!(!notes.contains("replaced"), "{notes}");
    let given = ImportOptions { density: Some(1000.0), radius: Some(0.2), ..glass() };
    let data = lammps_data::packing(DATA, &given).unwrap();
    assert_eq!(data.packing.radii, [0.2; 3]);
    assert_says(&data.notes.join("\n"), &["2500 kg/m3, is replaced", "the radii of the file"]);
    let dump = lammps_dump::packings(DUMP, &given).unwrap().remove(0);
    assert!(dump.packing.radii == [0.2; 2] && dump.notes.join("\n").contains("the radii of the file"));
}

#[test]
fn a_bad_sidecar_is_named() {
    for (text, expected) in
        [("{", "sidecar"), (r#"{"mu_prep": "much"}"#, "much"), (r#"{"G": "29"}"#, "sidecar")]
    {
        let error = csv::packing(PAIR, Some(text), &in_cube(1.0)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
    let flat = csv::packing(PAIR, Some(r#"{"box_L": [1, 0, 1]}"#), &glass());
    assert!(flat.unwrap_err().to_string().contains("no positive volume"));
}

/// In the form written by `write_data`.
const DATA: &str = "LAMMPS data file via write_data, version 22 Jul 2025, timestep = 100000, units = si

3 atoms
1 atom types

-0.5 0.5 xlo xhi
-0.5 0.5 ylo yhi
-0.5 0.5 zlo zhi
0.25 0 0 xy xz yz

Atoms # sphere

30 1 0.2 2500 0.45 0 0 0 0 0
10 1 0.2 2500 -0.4 0 0 1 0 0
20 1 0.3 2500 0.3 0.45 0 0 0 0

Velocities

10 1 2 3 4 5 6
20 0 0 0 0 0 0
30 0 0 0 0 0 0
";

#[test]
fn a_data_file_is_read_with_its_tilted_box_and_sorted_by_id() {
    let imported = lammps_data::packing(DATA, &glass()).unwrap();
    let p = &imported.packing;
    assert_eq!(
        (imported.step, p.ids.as_slice(), p.radii.as_slice()),
        (100_000, &[10, 20, 30][..], &[0.1, 0.15, 0.1][..])
    );
    assert_eq!((p.velocities[0], p.spins[0]), (Vec3::new(1.0, 2.0, 3.0), Vec3::new(4.0, 5.0, 6.0)));
    assert_eq!(p.cell.matrix().column(1).into_owned(), Vec3::new(0.25, 1.0, 0.0));
    // 10 and 30 across x: 0.15 apart.
    assert_eq!(p.contacts.len(), 1);
    assert_eq!((p.contacts[0].i, p.contacts[0].j, p.contacts[0].image), (0, 2, [-1, 0, 0]));
    assert!((p.contacts[0].overlap - 0.05).abs() < 1e-15);
    let expected = p.material.normal_force(0.05, p.contacts[0].overlap);
    assert!((p.contacts[0].normal_force / expected - 1.0).abs() < 1e-14);
    let said =
        ["does not state its boundaries", "contacts were found", "the contact overlaps by more than 10 %"];
    assert_says(&imported.notes.join("\n"), &said);
    assert_eq!((imported.notes.len(), imported.exit()), (3, grainlab_msgs::Exit::PhysicsInvalid));
}

#[test]
fn what_a_data_file_must_not_be_is_refused() {
    let changes = [
        ("units = si", "units = lj", "units lj"),
        ("# sphere", "# ellipsoid", "atom_style ellipsoid"),
        ("3 atoms", "4 atoms", "has 3 atoms, and states 4"),
        ("3 atoms", "3 atoms\n5 bonds", "5 bonds"),
        ("0.45 0 0 0 0 0", "0.45 0 0 0 0 x", "an image flag is \"x\""),
        ("0.25 0 0 xy xz yz", "1 0 nan avec", "edge vector"),
        ("10 1 2 3 4 5 6", "11 1 2 3 4 5 6", "none of grain 10"),
        ("10 1 2 3 4 5 6\n20 0 0 0 0 0 0\n30 0 0 0 0 0 0\n", "", "none of grain 30"),
        ("10 1 0.2", "10 1", "7 or 10 fields"),
        ("-0.5 0.5 zlo zhi", "", "--cell"),
        ("-0.5 0.5 zlo zhi", "0.5 -0.5 zlo zhi", "no positive volume"),
    ];
    assert_refused(DATA, &changes, |text| lammps_data::packing(text, &glass()));
    let mixed = [("20 1 0.3 2500", "20 1 0.3 2600", "mixture of densities")];
    let options = ImportOptions { density: None, ..glass() };
    assert_refused(DATA, &mixed, |text| lammps_data::packing(text, &options));
}

/// LAMMPS refuses these lines, too: its names have one spelling, and its header is above all sections.
#[test]
fn a_line_of_a_data_file_that_lammps_does_not_know_is_refused_with_its_number() {
    const TILT: &str = "0.25 0 0 xy xz yz";
    let changes = [
        (TILT, "0.25 0 xy xz yz", "line 9: \"0.25 0 xy xz yz\" is neither a line of the header"),
        (TILT, "0.25 xy\n0 xz\n0 yz", "line 9: \"0.25 xy\" is neither"),
        (TILT, "0.25,0,0 xy xz yz", "line 9: \"0.25,0,0 xy xz yz\" is neither"),
        (TILT, "0.25, 0, 0 xy xz yz", "line 9: tilt is \"0.25,\""),
        (TILT, "0.25 0 0 XY XZ YZ", "line 9: \"0.25 0 0 XY XZ YZ\" is neither"),
        (TILT, "0.25 0 0 xy yz xz", "line 9: \"0.25 0 0 xy yz xz\" is neither"),
        (TILT, "xy xz yz = 0.25 0 0", "line 9: \"xy xz yz = 0.25 0 0\" is neither"),
        (TILT, "nan 0 0 xy xz yz", "line 9: tilt is not finite"),
        ("-0.5 0.5 xlo xhi", "-inf 0.5 xlo xhi", "line 6: lower bound is not finite"),
        ("3 atoms", "3 Atoms", "line 3: \"3 Atoms\" is neither"),
        ("3 atoms", "3 atoms\n3 Bonds", "line 4: \"3 Bonds\" is neither"),
        ("3 atoms", "3 atoms\n2 clumps", "line 4: \"2 clumps\" is neither"),
        ("1 atom types", "one atom types", "line 4: atom types is \"one\""),
        ("Atoms # sphere", "atoms # sphere", "line 11: \"atoms\" is neither"),
        ("Atoms # sphere", "Atoms sphere", "line 11: \"Atoms sphere\" is neither"),
        ("Velocities", "velocities", "line 17: \"velocities\" is neither"),
        (TILT, "\nMasses\n\n1 2\n\n0.25 0 0 xy xz yz", "line 14: a line of the header is below a section"),
        ("10 1 0.2", "nan 1 0.2", "line 14: id is nan, not a whole number"),
    ];
    assert_refused(DATA, &changes, |text| lammps_data::packing(text, &glass()));
}

#[test]
fn all_lines_and_sections_of_a_data_file_of_lammps_are_known() {
    let expected = lammps_data::packing(DATA, &glass()).unwrap();
    let header = "3 atoms in a box\n0 bonds\n0 angles\n0 dihedrals\n0 impropers\n0 ellipsoids\n0 lines\n0 triangles\n0 bodies\n\
        1 bond types\n1 angle types\n1 dihedral types\n1 improper types\n6 extra bond per atom\n2 extra special per atom";
    let sections = "Atom Type Labels\n\n1 glass\n\nMasses\n\n1 1e-4 # glass\n\nPair Coeffs # granular\n\nglass 1 2\n\n\
        PairIJ Coeffs\n\n1 1 5\n\nBond Coeffs # bpm/rotational\n\n1 harmonic 3 4\n\nAtoms # sphere";
    let text = DATA.replace("3 atoms", header).replace("Atoms # sphere", sections);
    assert_eq!(lammps_data::packing(&text, &glass()).unwrap(), expected);
    // Values of fix property/atom are under the name of the fix.
    let found = lammps_data::packing(&format!("{DATA}\nwear\n\n10 0.5\n20 0.5\n30 0.5\n"), &glass()).unwrap();
    assert_eq!(found.packing, expected.packing);
    assert!(found.notes.join("\n").contains("the section \"wear\" is not read"), "{:?}", found.notes);
}

#[test]
fn an_implausible_shear_modulus_of_grains_is_noted() {
    let notes = |shear_modulus: f64| {
        let given = ImportOptions { shear_modulus: Some(shear_modulus), ..glass() };
        lammps_data::packing(DATA, &given).unwrap().notes.join("\n")
    };
    // A slip of GPa, and one of MPa for kPa.
    assert!(
        notes(29.0).contains("the shear modulus of the grains is 29 Pa, softer than gels: is its unit Pa?")
    );
    assert!(notes(29e12).contains("stiffer than diamond"));
    for sound in [2e3, 1e6, 29e9, 5e11] {
        assert!(!notes(sound).contains("shear modulus"), "{sound}");
    }
}

const DUMP: &str = "ITEM: TIMESTEP
10
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS pp pp pp
-1 1
-1 1
-1 1
ITEM: ATOMS id type xs ys zs diameter vx vy vz
2 1 0.95 0.5 0.5 0.3 0 0 7
1 1 0.05 0.5 0.5 0.3 0 0 0
ITEM: TIMESTEP
20
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS xy xz yz pp pp pp
-1 1.5 0.5
-1 1 0
-1 1 0
ITEM: ATOMS id x y z radius
1 0 0 0 0.3
2 0.5 0 0 0.3
";

#[test]
fn a_dump_is_read_frame_by_frame() {
    let frames = lammps_dump::packings(DUMP, &glass()).unwrap();
    assert_eq!(frames.iter().map(|f| f.step).collect::<Vec<_>>(), [10, 20]);
    let first = &frames[0].packing;
    assert_eq!((first.ids.as_slice(), first.velocities[1].z), (&[1, 2][..], 7.0));
    assert!((first.positions[0] - Vec3::new(-0.9, 0.0, 0.0)).norm() < 1e-15);
    assert_eq!((first.contacts.len(), first.contacts[0].image), (1, [-1, 0, 0]));
    let second = &frames[1].packing;
    // The bounds are those of the tilted cell: 2 wide, not 2.5.
    assert_eq!(second.cell.matrix(), &grainlab_core::Mat3::new(2.0, 0.5, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0));
    assert_eq!(second.contacts.len(), 1);
    assert!(frames[1].source.contains("frame 2 of 2"));
}

#[test]
fn what_a_dump_must_not_be_is_refused() {
    let changes = [
        ("pp pp pp", "pp pp ff", "periodic"),
        ("xs ys zs", "a b c", "no positions"),
        ("diameter vx vy vz", "diameter xu yu zu", "forms of its position"),
        ("2 1 0.95 0.5 0.5 0.3 0 0 7\n", "", "1 atoms follow, 2 were announced"),
        ("0.3 0 0 7", "0.3 0 0", "8 columns, 9 were announced"),
        ("diameter", "size", "--radius"),
        ("ITEM: NUMBER", "NUMBER", "ITEM"),
        ("-1 1\n", "-1\n", "a bound has 2 numbers"),
        ("BOX BOUNDS pp", "BOX BOUNDS abc origin pp", "4 numbers"),
        ("ITEM: TIMESTEP\n10", "ITEM: UNITS\nlj\nITEM: TIMESTEP\n10", "units lj"),
    ];
    assert_refused(DUMP, &changes, |text| lammps_dump::packings(text, &glass()));
    for cut in (0..DUMP.len()).step_by(7) {
        // Never a panic; a truncated frame is an error, not a smaller packing.
        if let Ok(frames) = lammps_dump::packings(&DUMP[..cut], &glass()) {
            assert!(frames.iter().all(|f| f.packing.grains() == 2), "cut at {cut}");
        }
    }
}

#[test]
fn a_frame_of_extended_xyz_with_a_fault_names_its_line() {
    let frame = "1\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=pos:R:3:radius:R:1\n0 0 0 0.1\n";
    let read = |text: &str| {
        let mut frames = 0;
        extended_xyz::each(text, &glass(), &mut |_| {
            frames += 1;
            std::ops::ControlFlow::Continue(())
        })
        .map(|()| frames)
    };
    assert_eq!(read(frame).unwrap(), 1);
    let changes = [
        ("1\n", "2\n", "1 of 2"),
        ("0 0 0 0.1", "0 0 0", "line 3"),
        ("0 0 0 0.1", "0 0 x 0.1", "line 3"),
        ("pos", "position", "pos:R:3"),
        ("1 0 0 0 1 0", "1 0 0 0 0", "Lattice has 8"),
        ("R:3:", "R:9999999:", "width of pos"),
        ("radius", "size", "radius"),
    ];
    assert_refused(frame, &changes, read);
}

#[test]
fn contact_forces_of_a_dump_local_are_taken() {
    let frame = &DUMP[..DUMP.rfind("ITEM: TIMESTEP").unwrap()];
    let local = "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ENTRIES\n1\nITEM: BOX BOUNDS pp pp pp\n-1 1\n-1 1\n-1 1\n\
        ITEM: ENTRIES index c_pl[1] c_pl[2] c_pf[1] c_pf[2] c_pf[3] c_pf[4]\n1 2 1 0.2 -4 0.5 0\n";
    let options = ImportOptions { contact_forces: Some(local.into()), ..glass() };
    let p = lammps_dump::packings(frame, &options).unwrap().remove(0).packing;
    // The force on 2 is −4 along x: across the boundary, 2 is at smaller x than 1, and is repelled.
    let c = p.contacts[0];
    assert_eq!((c.i, c.j, c.image, c.normal_force), (0, 1, [-1, 0, 0], 4.0));
    assert!((c.tangential_force - Vec3::new(0.0, -0.5, 0.0)).norm() < 1e-15);
    // The second frame has a step of its own, of which there are no forces.
    assert!(lammps_dump::packings(DUMP, &options).unwrap_err().to_string().contains("are of step 10 and"));
}

#[test]
fn units_that_give_an_implausible_density_are_noted_and_digits_of_masses_are_no_other_density() {
    let notes = |density: f64, given: Option<f64>| {
        let mass = density * 4.0 / 3.0 * std::f64::consts::PI * 0.15f64.powi(3);
        let second = DUMP.match_indices("ITEM: TIMESTEP").nth(1).unwrap().0;
        let text = DUMP[..second].replace("diameter vx vy vz", "diameter mass");
        let text =
            text.replace("0.3 0 0 7", &format!("0.3 {mass}")).replace("0.3 0 0 0", &format!("0.3 {mass}"));
        let options = ImportOptions { density: given, ..glass() };
        lammps_dump::packings(&text, &options).unwrap()[0].notes.concat()
    };
    assert!(notes(2.5, None).contains("a density of 2.500e0 kg/m3: are its units SI?"));
    assert!(!notes(2500.0, None).contains("SI?"));
    assert!(!notes(2499.999, Some(2500.0)).contains("replaced"));
    assert!(notes(2600.0, Some(2500.0)).contains("replaced"));
}

#[test]
fn a_recording_refuses_data_that_it_has_itself_and_names_the_flags() {
    let root = tempfile::tempdir().unwrap();
    let (directory, _) = crate::support::run_in(&root, 100);
    let recording = grainlab_recordings::Recording::open(&directory).unwrap();
    let options =
        ImportOptions { shear_modulus: Some(29e9), friction: Some(0.3), ..ImportOptions::default() };
    let taken = grainlab_recordings::import::recording::each(&recording, &options, &mut |_| {
        panic!("a packing is taken with other data")
    });
    let error = taken.unwrap_err().to_string();
    assert!(error.contains("leave out --shear-modulus, --friction"), "{error}");
}
