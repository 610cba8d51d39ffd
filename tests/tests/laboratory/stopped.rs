//! Processes that are stopped by a signal for a while: Ctrl-Z and fg, a debugger.

use std::time::Duration;
use system_tests::bodies::assert_same;
use system_tests::lab::{LIMIT, Lab, appeared, golden, until};
use system_tests::process::send;

const NODES: [&str; 5] =
    ["dem_simulator", "servo_controller", "fabric_analyzer", "emt_inversion", "recorder"];

#[test]
fn a_process_that_is_stopped_for_a_while_changes_no_byte_and_is_named() {
    let scene = golden("scenes/tiny.toml");
    let quiet = Lab::new();
    let expected = quiet.launch(&scene, &[]);
    for (number, node) in NODES.iter().enumerate() {
        let lab = Lab::new();
        let launcher = lab.start(&["launch", "--scene", &scene.to_string_lossy()]);
        let pid = appeared(&launcher, &format!("run {node}"));
        // Some during their start, some during the run.
        std::thread::sleep(Duration::from_millis(100 * number as u64));
        send(pid, libc::SIGSTOP);
        std::thread::sleep(Duration::from_millis(1500));
        send(pid, libc::SIGCONT);
        let ended = launcher.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{node}\n{}\n{}", ended.stdout, ended.stderr);
        assert!(ended.stderr.contains(&format!("{node} (pid {pid}) is stopped")), "{node}\n{}", ended.stderr);
        assert_same(&expected, &lab.last_run());
    }
}

#[test]
fn a_launcher_that_is_stopped_for_a_while_reports_the_run_all_the_same() {
    let scene = golden("scenes/tiny.toml");
    let quiet = Lab::new();
    let expected = quiet.launch(&scene, &[]);
    let lab = Lab::new();
    let launcher = lab.start(&["launch", "--scene", &scene.to_string_lossy()]);
    lab.until_recorded(20);
    launcher.signal(libc::SIGSTOP);
    std::thread::sleep(Duration::from_secs(3));
    launcher.signal(libc::SIGCONT);
    let ended = launcher.ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    assert!(ended.stdout.contains("relaxed"), "{}", ended.stdout);
    assert_same(&expected, &lab.last_run());
}

#[test]
fn a_stopped_listener_that_is_not_of_the_run_does_not_hold_it_up() {
    let scene = golden("scenes/tiny.toml");
    let quiet = Lab::new();
    let expected = quiet.launch(&scene, &[]);
    let lab = Lab::new();
    let listener = lab.start(&["bag", "record", "-a", "-o", "listened"]);
    until("the listener records", || lab.folder().join("listened").exists());
    let launcher = lab.start(&["launch", "--scene", &scene.to_string_lossy()]);
    lab.until_recorded(20);
    listener.signal(libc::SIGSTOP);
    // Well below the lease after which DDS drops a participant.
    let ended = launcher.ended(Duration::from_secs(30));
    listener.signal(libc::SIGCONT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    assert_same(&expected, &lab.last_run());
}
