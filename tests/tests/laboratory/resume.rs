//! A run is a pure function of scene and seed, also when it is interrupted or its processes are killed: what is saved, what is
//! said about it, and how it goes on.

use grainlab_msgs::msg;
use grainlab_recordings::{Recording, Selection};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use system_tests::bodies::{assert_same, decoded, distinct, recorded};
use system_tests::lab::{LONG, Lab, SLOW, golden, scene_path, summary, undisturbed};
use system_tests::process::{Ended, Process, children, runs, send};
use system_tests::wait::{LIMIT, until};

/// Steps of the recorded packings.
fn steps(run: &Path) -> Vec<u64> {
    decoded::<msg::Packing>(run, "/packing").iter().map(|packing| packing.step).collect()
}

/// Fails the test unless a launch was interrupted, and its text names the state that is in the recording.
fn says_what_is_saved(ended: Ended, run: &Path) -> Option<u64> {
    let saved = steps(run).last().copied();
    let (state, next) = match saved {
        Some(step) => {
            (format!("the last saved state is that of step {step}"), format!("goes on from step {step}"))
        }
        None => ("no state was saved".to_owned(), "begins anew".to_owned()),
    };
    ended.assert_code(130).assert_prints(&[&state, &next]);
    saved
}

fn resume(lab: &Lab, run: &Path) -> Ended {
    lab.run(&["launch", "--resume", &run.to_string_lossy()])
}

/// Fails the test unless the run has the requests, answers and packings of `expected`, and one packing more: the state that was
/// saved when it was interrupted.
fn has_the_same_bytes_and_a_saved_state(run: &Path, expected: &Path) {
    for topic in ["/stress", "/strain_rate"] {
        assert!(distinct(expected, topic) == distinct(run, topic), "{topic}");
    }
    let (all, known) = (distinct(run, "/packing"), distinct(expected, "/packing"));
    assert!(known.iter().all(|body| all.contains(body)) && all.len() == known.len() + 1);
}

/// A slow run that has recorded its first requests.
fn launched(lab: &Lab) -> (Process, PathBuf) {
    let launcher = lab.start_launch("tiny", &SLOW);
    lab.until_recorded(20);
    let run = lab.last_run();
    (launcher, run)
}

/// The files of a run with messages.
fn files(run: &Path) -> Vec<PathBuf> {
    let all = std::fs::read_dir(run).map(|entries| entries.flatten().map(|e| e.path()).collect::<Vec<_>>());
    let is_recording = |path: &PathBuf| path.extension().is_some_and(|e| e == "mcap");
    all.unwrap_or_default().into_iter().filter(is_recording).collect()
}

#[test]
fn a_run_has_the_bytes_of_another_one_of_its_seed_and_not_those_of_another_seed() {
    let lab = Lab::new();
    let run = lab.launch(Path::new(&scene_path("tiny")), &[]);
    assert_same(&undisturbed(&[]), &run);
    assert_ne!(distinct(&run, "/packing"), distinct(&undisturbed(&["--seed", "4"]), "/packing"));
}

#[test]
fn killing_simulator_servo_analyzer_and_inversion_changes_no_byte() {
    let expected = undisturbed(&LONG);
    let lab = Lab::new();
    let mut launcher = lab.start_launch("tiny", &LONG);
    let (begin, mut last_kill) = (Instant::now(), Instant::now());
    for (node, signal) in [
        ("servo_controller", libc::SIGKILL),
        ("fabric_analyzer", libc::SIGKILL),
        ("dem_simulator", libc::SIGKILL),
        ("servo_controller", libc::SIGKILL),
        ("emt_inversion", libc::SIGKILL),
        ("dem_simulator", libc::SIGABRT),
        ("servo_controller", libc::SIGKILL),
    ] {
        // Long enough for a restarted servo to be discovered and to answer.
        until(node, || {
            assert!(launcher.runs() && begin.elapsed() < LIMIT, "the run ended before {node} was killed");
            let children = children(launcher.pid(), &format!("run {node}"));
            let due = last_kill.elapsed() > Duration::from_millis(500);
            due && children.len() == 1 && (send(children[0], signal), true).1
        });
        last_kill = Instant::now();
    }
    launcher.ended(LIMIT).assert_code(0);
    assert_same(&expected, &lab.last_run());
}

#[test]
fn a_run_whose_launcher_or_recorder_was_killed_ends_whole_and_is_resumed_to_the_same_bytes() {
    let expected = undisturbed(&LONG);
    for node in ["launcher", "recorder"] {
        let lab = Lab::new();
        let launcher = lab.start_launch("tiny", &LONG);
        lab.until_recorded(300);
        let run = lab.last_run();
        let nodes = children(launcher.pid(), "run ");
        assert_eq!(nodes.len(), 5);
        if node == "launcher" {
            launcher.ended_by(libc::SIGKILL);
        } else {
            children(launcher.pid(), "run recorder").iter().for_each(|pid| send(*pid, libc::SIGKILL));
            launcher.ended(LIMIT).assert_code(3).assert_says(&["recorder"]);
        }
        until("every process ends", || !nodes.iter().any(|pid| runs(*pid)));
        assert!(recorded(&run, "/stress") >= 300, "half a second at most is lost");
        if node == "launcher" {
            let warnings = Recording::open(&run).unwrap().warnings();
            assert_eq!(warnings.len(), 0, "the recorder finishes its file: {warnings:?}");
        }
        resume(&lab, &run).assert_code(0);
        match node {
            "launcher" => has_the_same_bytes_and_a_saved_state(&run, &expected),
            _ => assert_same(&expected, &run),
        }
        resume(&lab, &run).assert_code(2).assert_says(&["the run is finished"]);
    }
}

#[test]
fn a_run_interrupted_in_the_gas_saves_its_state_says_so_and_goes_on_to_the_same_bytes() {
    let (expected, lab) = (undisturbed(&SLOW), Lab::new());
    let (launcher, run) = launched(&lab);
    let begin = Instant::now();
    let saved = says_what_is_saved(launcher.ended_by(libc::SIGINT), &run).expect("a saved state");
    assert!(begin.elapsed() < Duration::from_secs(30));
    assert!(saved > 0 && saved < steps(&expected)[0], "step {saved} is not within the gas");

    let path = run.to_string_lossy();
    let first = lab.start(&["launch", "--resume", &path]);
    until("a second file", || files(&run).len() > 1);
    // It waits for the first launcher, and starts no node.
    let second = resume(&lab, &run);
    first.ended(LIMIT).assert_code(0);
    second.assert_code(2).assert_says(&["is at work in this directory", "the run is finished"]);

    has_the_same_bytes_and_a_saved_state(&run, &expected);
    for topic in ["/packing_report", "/microstructure"] {
        assert_eq!(distinct(&expected, topic).last(), distinct(&run, topic).last(), "{topic}");
    }
    // The counts are those of the whole run.
    let (count, summary) = (|topic: &str| distinct(&expected, topic).len() as u64, summary(&run));
    assert_eq!(summary["exchanges"].as_u64(), Some(count("/strain_rate")), "{summary}");
    let of_stress = summary["topics"].as_array().unwrap().iter().find(|t| t["name"] == "/stress").unwrap();
    assert_eq!(of_stress["recorded"].as_u64(), Some(count("/stress")), "{summary}");
}

#[test]
fn a_run_whose_processes_are_all_terminated_at_once_saves_its_state_and_says_what_is_lost_with_its_file() {
    let lab = Lab::new();
    let (launcher, run) = launched(&lab);
    // As a service manager and a batch system do it: nodes first, which do not wait for the launcher.
    let nodes = children(launcher.pid(), "run ");
    assert_eq!(nodes.len(), 5);
    nodes.iter().for_each(|pid| send(*pid, libc::SIGTERM));
    std::thread::sleep(Duration::from_millis(300));
    let saved = says_what_is_saved(launcher.ended_by(libc::SIGTERM), &run);
    assert!(saved > Some(0), "{saved:?}");
    files(&run).iter().for_each(|file| std::fs::remove_file(file).unwrap());
    resume(&lab, &run).assert_code(0).assert_says(&["what this run has recorded is lost"]);
}

#[test]
fn a_second_interrupt_ends_every_process_at_once_and_the_recording_is_whole() {
    let lab = Lab::new();
    let (launcher, run) = launched(&lab);
    let nodes = children(launcher.pid(), "run ");
    let [simulator] = children(launcher.pid(), "run dem_simulator")[..] else { panic!("no simulator") };
    // It saves nothing, and the launcher would wait for it.
    send(simulator, libc::SIGSTOP);
    launcher.signal(libc::SIGINT);
    until("the end begins", || children(launcher.pid(), "run emt_inversion").is_empty());
    assert_eq!(says_what_is_saved(launcher.ended_by(libc::SIGINT), &run), None);
    assert!(nodes.iter().all(|pid| !runs(*pid)), "a process is left");
    let recording = Recording::open(&run).unwrap();
    assert!(recording.check().warnings.is_empty() && recording.unaccounted().is_empty());
}

#[test]
fn a_run_interrupted_before_it_has_a_state_says_that_nothing_was_saved_and_begins_anew() {
    let lab = Lab::new();
    let run = lab.folder().join("mine");
    let launcher = lab.start_launch("tiny", &["--run", "mine"]);
    until("a recording", || !files(&run).is_empty());
    says_what_is_saved(launcher.ended_by(libc::SIGINT), &run);
    resume(&lab, &run).assert_code(0);
    assert!(distinct(&undisturbed(&[]), "/stress") == distinct(&run, "/stress"));
}

#[test]
fn a_run_that_lacks_a_measurement_of_its_last_packing_makes_it_when_it_is_resumed() {
    let lab = Lab::new();
    let mut launcher = lab.start(&["launch", "acoustic", "--scene", &scene_path("tiny")]);
    lab.until_recorded(20);
    let run = lab.last_run();
    // The inversion of the moduli is the first answer, that of the slower waves the second.
    until("three inversions", || distinct(&run, "/microstructure").len() >= 3 || !launcher.runs());
    let ended = launcher.ended_by(libc::SIGINT);
    // Interrupted too late, it was complete.
    resume(&lab, &run).assert_code(if ended.code == Some(0) { 2 } else { 0 });
    assert_eq!((distinct(&run, "/wave_speeds").len(), distinct(&run, "/microstructure").len()), (2, 4));
}

#[test]
fn a_result_whose_recording_was_removed_is_not_said_to_be_in_it() {
    let lab = Lab::new();
    let (launcher, run) = launched(&lab);
    std::fs::remove_dir_all(&run).unwrap();
    let ended = launcher.ended(LIMIT).assert_says(&["summary.json: "]);
    assert!(ended.code != Some(0) && !ended.stderr.contains("is in the recording"), "{}", ended.stderr);
}

/// The recorder counts the messages that it wrote, whatever becomes of its file.
#[test]
fn messages_that_a_file_has_lost_since_they_were_written_count_as_lost() {
    use std::os::unix::fs::FileExt;
    let lab = Lab::new();
    let (launcher, run) = launched(&lab);
    let [file] = &files(&run)[..] else { panic!("one file") };
    let size = || file.metadata().unwrap().len();
    until("several chunks", || size() > 200_000);
    let damaged = std::fs::OpenOptions::new().write(true).open(file).unwrap();
    damaged.write_all_at(&[0xa5; 20_000], size() / 2).unwrap();
    let ended = launcher.ended(LIMIT).assert_code(3);
    let summary = summary(&run);
    let total = |key: &str| {
        summary["topics"].as_array().unwrap().iter().map(|t| t[key].as_u64().unwrap()).sum::<u64>()
    };
    let readable = Recording::open(&run).unwrap().messages(&Selection::default()).unwrap().count() as u64;
    assert!(total("lost") > 0 && total("recorded") == readable, "{readable} of {summary}");
    let said = ended.stdout + &ended.stderr;
    assert!(said.contains("chunk"), "the damage is not named: {said}");
}

/// The recording was interrupted in the last phase, with one packing measured. The definitions of its messages have no paths of
/// packings and no notes.
#[test]
fn a_run_of_an_earlier_version_is_read_reported_and_resumed_to_the_bytes_of_this_one() {
    let lab = Lab::new();
    let run = lab.folder().join("earlier");
    std::fs::create_dir(&run).unwrap();
    for file in ["earlier_0.mcap", "metadata.yaml", "scene.toml", "launch.json", "summary.json"] {
        std::fs::copy(golden("earlier_version").join(file), run.join(file)).unwrap();
    }
    let path = run.to_string_lossy();
    for command in ["analyze", "report"] {
        lab.run(&[command, &path]).assert_code(0);
    }
    resume(&lab, &run).assert_code(0);
    let expected = undisturbed(&["--set", "grains.count=200", "--set", "phase.settle.until.hold=2e-4"]);
    for topic in ["/packing", "/packing_report"] {
        assert_eq!(distinct(&run, topic).last(), distinct(&expected, topic).last(), "{topic}");
    }
    let recording = Recording::open(&run).unwrap();
    let packings = recording.messages(&Selection::topics(["/packing"])).unwrap();
    let steps: Vec<_> = packings.map(|packing| packing.decoded::<msg::Packing>().unwrap().step).collect();
    assert!(steps.is_sorted() && steps.len() == 4, "{steps:?}");
    assert_eq!(recording.check().warnings, []);
    let states = lab.run(&["analyze", &path, "--format", "json"]).assert_code(0).json();
    // The saved state is there twice: as it was recorded, and with its path.
    assert_eq!(states.as_array().map(Vec::len), Some(steps.len()));
    lab.run(&["report", &path]).assert_code(0);
}
