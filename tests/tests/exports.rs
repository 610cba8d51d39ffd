//! Exported packings in the readers of other projects.

use system_tests::lab::{Lab, golden};
use system_tests::python;

#[test]
fn readers_of_other_projects_find_every_number_of_an_exported_packing() {
    let Some(python) = python::with("vtk, h5py, ovito") else { return };
    let lab = Lab::new();
    let packing = golden("yade/packing.csv");
    for format in ["csv", "vtk", "vtkhdf", "xyz", "lammps"] {
        let ended =
            lab.run(&["bag", "export", packing.to_str().unwrap(), "--format", format, "--out", format]);
        assert_eq!(ended.code, Some(0), "{}{}", ended.stdout, ended.stderr);
    }
    let read = python::tool(&python, "read_exports.py", &[lab.folder().to_str().unwrap()]);
    let (out, err) = (String::from_utf8_lossy(&read.stdout), String::from_utf8_lossy(&read.stderr));
    assert!(read.status.success(), "{out}{err}");
}
