//! The laboratory needs nothing but loopback.

use std::process::Command;
use system_tests::lab::{LIMIT, Lab, golden, grainlab};
use system_tests::process::Process;

#[test]
fn the_main_job_works_where_only_loopback_exists() {
    let can = Command::new("unshare").args(["-n", "true"]).status().is_ok_and(|s| s.success());
    if !can {
        // Past the test harness, which hides the output of passing tests.
        let _ = std::fs::write("/dev/stderr", "SKIPPED: no right to make a network namespace here\n");
        return;
    }
    let lab = Lab::new();
    let script = "ip link set lo up && exec \"$0\" launch --scene \"$1\"";
    let mut command = Command::new("unshare");
    command
        .args(["-n", "sh", "-c", script])
        .arg(grainlab())
        .arg(golden("scenes/tiny.toml"))
        .current_dir(lab.folder())
        .env("NO_COLOR", "1");
    let ended = Process::start(&mut command).ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
}
