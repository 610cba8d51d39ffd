//! Runs that are interrupted: what is saved, what is said about it, and how they go on.

use grainlab_msgs::{from_cdr, msg};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use system_tests::bodies::distinct;
use system_tests::lab::{LIMIT, Lab, golden, until};
use system_tests::process::{Ended, Process, children, runs, send};

/// The small scene with more grains and a gas that takes some seconds.
fn slow_gas(lab: &Lab) -> PathBuf {
    let text = std::fs::read_to_string(golden("scenes/tiny.toml")).unwrap();
    let path = lab.folder().join("slow.toml");
    assert!(text.contains("rate = -60.0"));
    std::fs::write(&path, text.replace("count = 80", "count = 400").replace("rate = -60.0", "rate = -0.6"))
        .unwrap();
    path
}

/// Steps of the recorded packings.
fn steps(run: &Path) -> Vec<u64> {
    distinct(run, "/packing").iter().map(|body| from_cdr::<msg::Packing>(body).unwrap().step).collect()
}

/// Fails the test unless a launch was interrupted, and its text names the state that is in the recording.
fn says_what_is_saved(ended: &Ended, run: &Path) -> Option<u64> {
    assert_eq!(ended.code, Some(130), "{}\n{}", ended.stdout, ended.stderr);
    let saved = steps(run).last().copied();
    let (state, next) = match saved {
        Some(step) => {
            (format!("the last saved state is that of step {step}"), format!("goes on from step {step}"))
        }
        None => ("no state was saved".to_owned(), "begins anew".to_owned()),
    };
    for words in [state, next] {
        assert!(ended.stdout.contains(&words), "{words:?} is missing from:\n{}", ended.stdout);
    }
    saved
}

/// Resumes the run, and fails the test unless it then has the bytes of `expected` and one packing more.
fn goes_on_to_the_same_bytes(lab: &Lab, run: &Path, expected: &Path) {
    let resumed = lab.run(&["launch", "--resume", &run.to_string_lossy()]);
    assert_eq!(resumed.code, Some(0), "{}\n{}", resumed.stdout, resumed.stderr);
    for topic in ["/stress", "/strain_rate"] {
        assert!(distinct(expected, topic) == distinct(run, topic), "{topic}");
    }
    let (all, known) = (distinct(run, "/packing"), distinct(expected, "/packing"));
    assert!(known.iter().all(|body| all.contains(body)) && all.len() == known.len() + 1);
    for topic in ["/packing_report", "/microstructure"] {
        assert_eq!(distinct(expected, topic).last(), distinct(run, topic).last(), "{topic}");
    }
    let both = [expected, run].map(|path| path.to_str().unwrap());
    let same = lab.run(&[&["bag", "diff"], &both[..], &["--topics", "stress", "strain_rate"]].concat());
    assert_eq!(same.code, Some(0), "{}{}", same.stdout, same.stderr);
    // The counts are those of the whole run.
    let count = |run: &Path, topic: &str| distinct(run, topic).len() as u64;
    let text = std::fs::read_to_string(run.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["exchanges"].as_u64(), Some(count(expected, "/strain_rate")), "{text}");
    let of_stress = summary["topics"].as_array().unwrap().iter().find(|t| t["name"] == "/stress").unwrap();
    assert_eq!(of_stress["recorded"].as_u64(), Some(count(expected, "/stress")), "{text}");
}

fn launched(lab: &Lab) -> (Process, PathBuf) {
    let launcher = lab.start(&["launch", "--scene", &slow_gas(lab).to_string_lossy()]);
    lab.until_recorded(20);
    let run = lab.last_run();
    (launcher, run)
}

#[test]
fn a_run_interrupted_in_the_gas_saves_its_state_says_so_and_goes_on_to_the_same_bytes() {
    let (quiet, lab) = (Lab::new(), Lab::new());
    let expected = quiet.launch(&slow_gas(&quiet), &[]);
    let (launcher, run) = launched(&lab);
    launcher.signal(libc::SIGINT);
    let begin = Instant::now();
    let saved = says_what_is_saved(&launcher.ended(LIMIT), &run).expect("a saved state");
    assert!(begin.elapsed() < Duration::from_secs(30));
    let first: msg::Packing = from_cdr(&distinct(&expected, "/packing")[0]).unwrap();
    assert!(saved > 0 && saved < first.step, "step {saved} is not within the gas");
    goes_on_to_the_same_bytes(&lab, &run, &expected);
}

#[test]
fn a_run_whose_processes_are_all_terminated_at_once_saves_its_state() {
    let lab = Lab::new();
    let (launcher, run) = launched(&lab);
    // As a service manager and a batch system do it: nodes first, which do not wait for the launcher.
    let nodes = children(launcher.pid(), "run ");
    assert_eq!(nodes.len(), 5);
    nodes.iter().for_each(|pid| send(*pid, libc::SIGTERM));
    std::thread::sleep(Duration::from_millis(300));
    launcher.signal(libc::SIGTERM);
    let saved = says_what_is_saved(&launcher.ended(LIMIT), &run);
    assert!(saved > Some(0), "{saved:?}");
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
    launcher.signal(libc::SIGINT);
    assert_eq!(says_what_is_saved(&launcher.ended(LIMIT), &run), None);
    assert!(nodes.iter().all(|pid| !runs(*pid)), "a process is left");
    let recording = grainlab_recordings::Recording::open(&run).unwrap();
    assert!(recording.check().warnings.is_empty() && recording.unaccounted().is_empty());
}

#[test]
fn a_run_interrupted_before_it_has_a_state_says_that_nothing_was_saved_and_begins_anew() {
    let (quiet, lab) = (Lab::new(), Lab::new());
    let scene = golden("scenes/tiny.toml").to_string_lossy().into_owned();
    let expected = quiet.launch(Path::new(&scene), &[]);
    let launcher = lab.start(&["launch", "--scene", &scene, "--run", "mine"]);
    let run = lab.folder().join("mine");
    // As soon as the recording exists.
    let recorded = || {
        std::fs::read_dir(&run)
            .is_ok_and(|mut d| d.any(|e| e.is_ok_and(|e| e.path().extension().is_some_and(|x| x == "mcap"))))
    };
    until("a recording", recorded);
    launcher.signal(libc::SIGINT);
    says_what_is_saved(&launcher.ended(LIMIT), &run);
    let resumed = lab.run(&["launch", "--resume", &run.to_string_lossy()]);
    assert_eq!(resumed.code, Some(0), "{}\n{}", resumed.stdout, resumed.stderr);
    assert!(distinct(&expected, "/stress") == distinct(&run, "/stress"));
}

#[test]
fn a_run_that_lacks_a_measurement_of_its_last_packing_makes_it_when_it_is_resumed() {
    let lab = Lab::new();
    let scene = golden("scenes/tiny.toml");
    let mut launcher = lab.start(&["launch", "acoustic", "--scene", &scene.to_string_lossy()]);
    lab.until_recorded(20);
    let run = lab.last_run();
    // The inversion of the moduli is the first answer, that of the slower waves the second.
    until("three inversions", || distinct(&run, "/microstructure").len() >= 3 || !launcher.runs());
    send(launcher.pid(), libc::SIGINT);
    let ended = launcher.ended(LIMIT);
    let resumed = lab.run(&["launch", "--resume", &run.to_string_lossy()]);
    // Interrupted too late, it was complete.
    let expected = if ended.code == Some(0) { 2 } else { 0 };
    assert_eq!(resumed.code, Some(expected), "{}\n{}", resumed.stdout, resumed.stderr);
    assert_eq!((distinct(&run, "/wave_speeds").len(), distinct(&run, "/microstructure").len()), (2, 4));
}
