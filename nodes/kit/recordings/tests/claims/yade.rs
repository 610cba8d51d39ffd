//! Exports of YADE, in its formats and by the export script: all of one packing prepared and measured by YADE
//! (`tests/golden/yade/make.py`).

use std::path::Path;

use crate::support::{assert_refused, assert_says, glass, golden};
use grainlab_core::stress::stress;
use grainlab_recordings::import::{ImportOptions, Imported, load, yade};

fn one(name: &str, options: &ImportOptions) -> Imported {
    let loaded = load(&golden("yade").join(name), options).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(loaded.packings.len(), 1);
    loaded.packings.into_iter().next().unwrap()
}

#[test]
fn the_script_for_yade_writes_contacts_and_forces_that_give_yades_own_stress() {
    let imported = one("packing.csv", &ImportOptions::default());
    let p = &imported.packing;
    assert_eq!((p.grains(), imported.notes.len()), (80, 0), "{:?}", imported.notes);
    assert!((p.material.shear_modulus / 29e9 - 1.0).abs() < 1e-14);
    let known: [[f64; 3]; 3] =
        serde_json::from_slice(&std::fs::read(golden("yade/stress.json")).unwrap()).unwrap();
    let found = stress(p).tensor;
    for (r, c) in (0..9).map(|k| (k / 3, k % 3)) {
        // At rest; positive in tension, the convention of YADE.
        let expected = -0.5 * (known[r][c] + known[c][r]);
        assert!((found.matrix()[(r, c)] - expected).abs() < 1e-6 * found.mean(), "({r}, {c})");
    }
    let tangential =
        p.contacts.iter().map(|c| c.tangential_force.norm() / c.normal_force).fold(0.0, f64::max);
    assert!(tangential > 0.01 && tangential < p.friction * 1.001, "{tangential}");
}

/// `default_law.csv`: grains of one size, FrictMat, Law2_ScGeom_FrictPhys_CundallStrack.
#[test]
fn the_script_for_yade_writes_the_default_law_of_yade_as_linear_springs() {
    let imported = one("default_law.csv", &ImportOptions::default());
    let p = &imported.packing;
    assert_eq!((p.grains(), imported.notes.len()), (40, 0), "{:?}", imported.notes);
    // k_n = 2 E R E R / (E R + E R), k_s = nu k_n.
    let [normal_stiffness, stiffness_ratio] = p.law.parameters()[..] else { panic!("{}", p.law) };
    assert!(p.law.name() == "linear" && (normal_stiffness / (1e8 * 0.07) - 1.0).abs() < 1e-12, "{}", p.law);
    assert!((stiffness_ratio - 0.3).abs() < 1e-12 && p.law_difference() < 1e-3, "{}", p.law);
    // As a file of the script without the law: the forces are recognised.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("packing.csv");
    std::fs::copy(golden("yade/default_law.csv"), &path).unwrap();
    let text = std::fs::read_to_string(golden("yade/default_law.json")).unwrap();
    let mut about: serde_json::Value = serde_json::from_str(&text).unwrap();
    about.as_object_mut().unwrap().retain(|key, _| !key.starts_with("contact_law"));
    std::fs::write(path.with_extension("json"), about.to_string()).unwrap();
    let error = load(&path, &ImportOptions::default()).unwrap_err().to_string();
    assert!(error.contains("--contact-law") && error.contains("linear:7.000"), "{error}");
    let stated = ImportOptions { default_law: Some(p.law), ..ImportOptions::default() };
    assert_eq!(load(&path, &stated).unwrap().packings[0].packing.law, p.law);
}

/// The function of the script that decides on the law, with the classes of YADE that it looks at.
const LAWS: &str = "
import sys; sys.path.insert(0, sys.argv[1]); sys.dont_write_bytecode = True
from grainlab_export import contact_law
def phys(name, kn, ks): return type(name, (), {'kn': kn, 'ks': ks})()
assert contact_law([phys('FrictPhys', 7e6, 2.1e6)] * 3, 'x') == (('linear', [7e6, 0.3]), None)
assert contact_law([phys('MindlinPhys', k, k) for k in (1.0, 2.0)], 'x') == (('hertz_mindlin', []), None)
law, why = contact_law([phys('FrictPhys', k, 0.3 * k) for k in (6e6, 8e6)], 'x')
assert law is None and 'differs by up to 14.3 %' in why and '--contact-law linear:7e+06,0.3' in why, why
for case, word in (([phys('FrictPhys', 7e6, 0.0)], 'k_s is 0'), ([phys('CohFrictPhys', 7e6, 2e6)], 'CohFrictPhys'), ([], 'no contacts')):
    law, why = contact_law(case, 'x')
    assert law is None and word in why, why
print('all laws')
";

#[test]
fn the_script_for_yade_writes_only_laws_that_all_contacts_have() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/import/yade");
    let python = std::env::var("GRAINLAB_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let run = std::process::Command::new(&python).args(["-c", LAWS]).arg(folder).output();
    let Ok(run) = run else {
        assert!(std::env::var("GRAINLAB_PYTHON").is_err(), "{python} cannot be run");
        return eprintln!("skipped: {python} cannot be run");
    };
    let [out, error] = [&run.stdout, &run.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert!(out.contains("all laws"), "{error}");
}

#[test]
fn every_text_format_of_yade_gives_the_grains_of_the_same_packing() {
    let exact = one("packing.csv", &ImportOptions::default()).packing;
    let cell = ImportOptions { cell: Some(*exact.cell.matrix()), ..glass() };
    for (name, options) in
        [("id_x_y_z_r_matId.txt", &glass()), ("x_y_z_r_attrs.txt", &glass()), ("x_y_z_r.txt", &cell)]
    {
        let imported = one(name, options);
        let p = &imported.packing;
        assert_eq!(p.cell, exact.cell, "{name}: a comment has all digits");
        assert_eq!(p.ids, exact.ids, "{name}");
        for (k, x) in p.positions.iter().enumerate() {
            // Six digits of coordinates up to a few millimetres.
            assert!((x - exact.positions[k]).amax() < 5.1e-9, "{name}: grain {k}");
        }
        assert!(imported.notes.iter().any(|n| n.contains("6 digits")), "{name}: {:?}", imported.notes);
        assert!(imported.source.contains("YADE"), "{}", imported.source);
    }
    let moving = one("x_y_z_r_attrs.txt", &glass()).packing;
    for (a, b) in moving.velocities.iter().zip(&exact.velocities) {
        assert!((a - b).norm() <= 1e-5 * b.norm());
    }
}

const EXPORT: &str = "#format x_y_z_r_matId\n# cell Matrix3(1,0.1,0, 0,1,0, 0,0,1.5)\n0.3\t0.3\t0.3\t0.1\t0\n0.45\t0.3\t0.3\t0.1\t1\n";

#[test]
fn a_comment_gives_the_cell_and_the_flag_goes_before_it() {
    let imported = yade::packing(EXPORT, &glass()).unwrap();
    let p = &imported.packing;
    assert_eq!(p.cell.matrix(), &grainlab_core::Mat3::new(1.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.5));
    assert_eq!((p.ids.as_slice(), p.contacts.len()), (&[0, 1][..], 1));
    assert!(imported.notes.iter().any(|n| n.contains("of 2 types")), "{:?}", imported.notes);
    let cube = ImportOptions { cell: Some(grainlab_core::Mat3::identity() * 2.0), ..glass() };
    assert_eq!(yade::packing(EXPORT, &cube).unwrap().packing.cell.volume(), 8.0);
    let three = EXPORT.replace("Matrix3(1,0.1,0, 0,1,0, 0,0,1.5)", "1 2 3");
    assert!((yade::packing(&three, &glass()).unwrap().packing.cell.volume() - 6.0).abs() < 1e-12);
}

#[test]
fn what_an_export_must_not_be_is_refused_by_line() {
    let changes = [
        ("0.3\t0.1\t0\n", "0.3\t0.1\n", "line 3: 4 columns, 5 were announced"),
        ("0.45", "abc", "line 4: position is \"abc\""),
        ("0, 0,0,1.5)", "0)", "line 2: a cell has 3 or 9 numbers, not 6"),
        ("x_y_z_r_matId", "x_y_z_r_clumpId", "line 1: #format x_y_z_r_clumpId is not supported"),
        ("x_y_z_r_matId", "jointedPM", "textExt"),
        ("1,0.1,0, 0,1,0, 0,0,1.5", "1,0,0, 0,0,0, 0,0,1", "no positive volume"),
        ("# cell", "# cell 2 2 2\n# cell", "the cell occurs twice"),
    ];
    assert_refused(EXPORT, &changes, |text| yade::packing(text, &glass()));
}

#[test]
fn other_files_of_yade_are_refused_with_what_to_do() {
    let root = tempfile::tempdir().unwrap();
    for (name, text, expected) in [
        ("a-spheres-0.vtk", "# vtk DataFile Version 3.0.\ncomment\nASCII\n", "--yade-script"),
        ("state.xml", "<?xml version=\"1.0\"?>\n<boost_serialization>", "--yade-script"),
        ("in.data", "LIGGGHTS Description\n\n2 atoms\n", "id_x_y_z_r_matId"),
    ] {
        let path = root.path().join(name);
        std::fs::write(&path, text).unwrap();
        let error = load(&path, &glass()).unwrap_err().to_string();
        assert_says(&error, &[name, "line 1", expected]);
    }
}
