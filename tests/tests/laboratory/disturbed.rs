//! What happens on a host while a run is under way: Ctrl-Z and fg, a debugger, a clock that is set, a domain full of programs of
//! other makers. No byte of the run changes.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use system_tests::bodies::assert_same;
use system_tests::crowd::Crowd;
use system_tests::lab::{Lab, SLOW, appeared, scene_path, undisturbed};
use system_tests::process::{Process, send};
use system_tests::python::say_skipped;
use system_tests::wait::{LIMIT, until};

/// The run of a launcher that ended as it should, with the bytes of `expected`.
fn assert_done(lab: &Lab, launcher: Process, expected: &Path) {
    launcher.ended(LIMIT).assert_code(0);
    assert_same(expected, &lab.last_run());
}

#[test]
fn a_process_that_is_stopped_for_a_while_changes_no_byte_and_is_named() {
    let (expected, lab) = (undisturbed(&SLOW), Lab::new());
    let launcher = lab.start_launch("tiny", &SLOW);
    // The first one during its start.
    for node in ["dem_simulator", "servo_controller", "fabric_analyzer", "emt_inversion", "recorder"] {
        let pid = appeared(&launcher, &format!("run {node}"));
        send(pid, libc::SIGSTOP);
        launcher.until_says(&format!("{node} (pid {pid}) is stopped"));
        send(pid, libc::SIGCONT);
    }
    assert_done(&lab, launcher, &expected);
}

/// A launcher that is stopped reports the run all the same, and one of a program outside the run holds nothing up.
#[test]
fn a_launcher_and_a_listener_outside_the_run_that_are_stopped_do_not_hold_it_up() {
    let (expected, lab) = (undisturbed(&[]), Lab::new());
    let listener = lab.start(&["bag", "record", "-a", "-o", "listened"]);
    until("the listener records", || lab.folder().join("listened").exists());
    let launcher = lab.start_launch("tiny", &[]);
    lab.until_recorded(20);
    listener.signal(libc::SIGSTOP);
    launcher.signal(libc::SIGSTOP);
    std::thread::sleep(Duration::from_secs(3));
    launcher.signal(libc::SIGCONT);
    // Well below the lease after which DDS drops a participant.
    let ended = launcher.ended(Duration::from_secs(30)).assert_code(0).assert_prints(&["relaxed"]);
    listener.signal(libc::SIGCONT);
    drop(ended);
    assert_same(&expected, &lab.last_run());
}

/// Most bytes that a run of a few seconds says, on the terminal and in its logs.
const FEW: u64 = 20_000;

/// The library that gives a process another wall clock. Its monotonic clock stays as it is.
fn faketime() -> Option<PathBuf> {
    let folders = std::fs::read_dir("/usr/lib").ok()?.flatten().map(|e| e.path());
    folders.map(|d| d.join("faketime/libfaketimeMT.so.1")).find(|library| library.exists())
}

/// Sets the clock of processes that were started with this file.
fn set(file: &Path, offset: &str) {
    let new = file.with_extension("new");
    std::fs::write(&new, offset).unwrap();
    std::fs::rename(new, file).unwrap();
}

#[test]
fn a_run_whose_clock_is_set_back_or_forward_goes_on_to_the_same_bytes_in_a_few_lines() {
    let Some(library) = faketime() else {
        return say_skipped("no libfaketime (package faketime)");
    };
    let expected = undisturbed(&SLOW);
    // By a second, a minute, a day, and to a time before 1970, which computers without a clock have at their start.
    for steps in [&["+0", "-1", "-61", "+0", "-70y"][..], &["+1d", "+0"], &["-70y", "+0"]] {
        let lab = Lab::new();
        let clock = lab.folder().join("clock");
        set(&clock, steps[0]);
        let mut command = lab.command(&[&["launch", "--scene", &scene_path("tiny")], &SLOW[..]].concat());
        command
            .env("LD_PRELOAD", &library)
            .env("FAKETIME_TIMESTAMP_FILE", &clock)
            .env("FAKETIME_NO_CACHE", "1")
            .env("DONT_FAKE_MONOTONIC", "1")
            .env("NO_FAKE_STAT", "1");
        let mut launcher = Process::start(&mut command);
        for step in &steps[1..] {
            lab.until_recorded(lab.recorded() + 50);
            assert!(launcher.runs(), "{steps:?}: the run was over");
            set(&clock, step);
        }
        let ended = launcher.ended(LIMIT).assert_code(0);
        let run = lab.last_run();
        assert_same(&expected, &run);
        let logs = std::fs::read_dir(run.join("logs")).unwrap();
        let logs: u64 = logs.map(|log| log.unwrap().metadata().unwrap().len()).sum();
        assert!(ended.stderr.len() as u64 + logs < FEW, "{steps:?}: {logs} bytes\n{}", ended.stderr);
    }
}

/// More participants than discovery has room for, and enough more that some may be lost.
const CROWD: u16 = 520;
const LARGE_CROWD: u16 = 700;

/// Announcements each second: all within a second, and all within the ten seconds after which real ones are repeated.
const FAST: f64 = 900.0;
const GENTLE: f64 = 50.0;

const PERIOD: Duration = Duration::from_secs(10);

/// Time within which a run begins.
const BEGINS_WITHIN: Duration = Duration::from_secs(10);

/// More grains, so that the run is under way long enough.
const GRAINS: [&str; 2] = ["--set", "grains.count=200"];

#[test]
fn a_node_that_is_killed_joins_its_run_again_in_a_full_domain_and_tools_say_that_it_is_full() {
    let (expected, lab) = (undisturbed(&GRAINS), Lab::new());
    let crowd = Crowd::start(lab.domain, LARGE_CROWD, FAST, PERIOD);
    let full = format!("DDS domain {} is full", lab.domain);
    let launcher = lab.start_launch("tiny", &GRAINS);
    let servo = appeared(&launcher, "run servo_controller");
    lab.until_recorded(20);
    until("the crowd is announced", || crowd.rounds() > 0);
    send(servo, libc::SIGKILL);
    // "restarted": the servo was not killed too late.
    launcher.ended(LIMIT).assert_code(0).assert_says(&["restarted", &full, "ROS_DOMAIN_ID"]);
    assert_same(&expected, &lab.last_run());
    drop(crowd);

    let _crowd = Crowd::start(lab.domain, LARGE_CROWD, FAST, Duration::ZERO);
    lab.run(&["doctor", "--format", "json"]).assert_prints(&["full_domain"]);
    lab.run(&["topic", "list", "--spin-time", "5"]).assert_says(&[&full]);
}

#[test]
fn fifty_announcements_a_second_before_during_and_after_the_start_change_no_byte() {
    let expected = undisturbed(&GRAINS);
    for wait_for_all in [true, false] {
        let lab = Lab::new();
        let crowd = Crowd::start(lab.domain, CROWD, GENTLE, PERIOD);
        until("the crowd is announced", || !wait_for_all || crowd.rounds() > 0);
        let begin = Instant::now();
        let launcher = lab.start_launch("tiny", &GRAINS);
        lab.until_recorded(1);
        assert!(begin.elapsed() < BEGINS_WITHIN, "begun after {:?}", begin.elapsed());
        assert_done(&lab, launcher, &expected);
    }
    let lab = Lab::new();
    let launcher = lab.start_launch("tiny", &GRAINS);
    lab.until_recorded(1);
    let _crowd = Crowd::start(lab.domain, CROWD, GENTLE, PERIOD);
    assert_done(&lab, launcher, &expected);
}
