//! The laboratory under seeded faults, on the bus in memory.

use std::process::Command;

#[test]
fn two_hundred_runs_under_faults_come_to_the_same_bytes_or_to_an_error() {
    let output = Command::new(env!("CARGO_BIN_EXE_grainlab_bench"))
        .args(["faults", "--seeds", "200", "--format", "json"])
        .output()
        .unwrap();
    let (text, said) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{text}\n{said}");
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    let count = |key: &str| report[key].as_u64().unwrap();
    assert_eq!((count("runs"), count("same") + count("errors")), (200, 200));
    // The test requires faults that had an effect, and runs that succeeded.
    assert!(
        count("same") > 100 && count("crashes") > 50 && count("stops") > 50 && count("forged") > 1000,
        "{text}"
    );
}

#[test]
fn a_seed_is_the_same_run_again() {
    let explain = || {
        let arguments = ["faults", "--seed", "42", "--seeds", "3", "--explain"];
        let output = Command::new(env!("CARGO_BIN_EXE_grainlab_bench")).args(arguments).output().unwrap();
        (output.stdout, output.stderr)
    };
    let (first, second) = (explain(), explain());
    assert!(!first.1.is_empty());
    assert!(first == second, "{}", String::from_utf8_lossy(&first.1));
}
