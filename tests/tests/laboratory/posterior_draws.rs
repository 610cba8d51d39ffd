//! Draws from the posterior in the programs that analyse posteriors.

use std::fs;
use system_tests::lab::Lab;
use system_tests::python;

/// The first state of the ensemble `wide`.
const STATE: [&str; 14] = [
    "invert",
    "--model=relaxed",
    "--g12=74.224e6",
    "--g13=81.816e6",
    "--theta=136.988e6",
    "--c11=226.698e6",
    "--c33=264.817e6",
    "--c13=89.544e6",
    "--pressure=50e3",
    "--stress-ratio=0",
    "--size-spread=0",
    "--grain-shear-modulus=35.3e9",
    "--poisson=0.212",
    "--error=0.01",
];

#[test]
fn arviz_corner_and_pandas_read_draws_and_find_the_estimate() {
    let Some(python) = python::with("arviz, corner, pandas") else { return };
    let lab = Lab::new();
    let [json, csv, estimate] =
        ["draws.json", "draws.csv", "estimate.json"].map(|name| lab.folder().join(name));
    for file in [&json, &csv] {
        let run = lab.run(&[&STATE[..], &["--format=json", "--draws", file.to_str().unwrap()]].concat());
        assert_eq!(run.code, Some(0), "{}{}", run.stdout, run.stderr);
        fs::write(&estimate, run.stdout).unwrap();
    }
    let files = [&json, &csv, &estimate].map(|path| path.to_str().unwrap());
    let read = python::tool(&python, "check_draws.py", &files);
    let (out, err) = (String::from_utf8_lossy(&read.stdout), String::from_utf8_lossy(&read.stderr));
    assert!(read.status.success(), "{out}{err}");
}
