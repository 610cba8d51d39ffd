//! An instrument that has only the message files in common with grainlab: CycloneDDS, from Python.

use grainlab_emt_inversion::{Settings, microstructure_of_speeds};
use grainlab_msgs::msg::{Estimate, Microstructure, WaveSpeeds};
use grainlab_msgs::{Message, from_cdr};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use system_tests::bodies::distinct;
use system_tests::lab::{LIMIT, Lab, golden, grainlab};
use system_tests::process::{Ended, Process};
use system_tests::python;

fn here(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A program of the instrument, in the domain of the laboratory and on loopback.
fn peer(lab: &Lab, command: &mut Command) -> Ended {
    let ended = Process::start(
        command
            .current_dir(lab.folder())
            .env("ROS_DOMAIN_ID", lab.domain.to_string())
            .env_remove("ROS_STATIC_PEERS")
            .env_remove("ROS_LOCALHOST_ONLY")
            .env_remove("ROS_AUTOMATIC_DISCOVERY_RANGE")
            .env_remove("CYCLONEDDS_URI"),
    )
    .ended(LIMIT);
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
    ended
}

/// The answer of the inversion to a message that the instrument has sent.
fn expected(sent: &Value) -> Microstructure {
    let sent: WaveSpeeds =
        serde_json::from_value(sent.clone()).expect("the fields of our message, all of them");
    assert!(sent.speeds.len() >= 5 && sent.density > 0.0, "{sent:?}");
    microstructure_of_speeds(&sent, &Settings::default()).message
}

fn received(message: &Value) -> Microstructure {
    serde_json::from_value(message.clone()).expect("the fields of our message, all of them")
}

#[test]
fn an_instrument_of_another_vendor_receives_every_digit_of_its_microstructure() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let script = here("../nodes/launch/instrument.sh");
    let run = |arguments: &[&str]| {
        let mut command = Command::new("sh");
        peer(&lab, command.arg(&script).args(arguments).env("GRAINLAB", grainlab()).env("PYTHON", &python))
    };
    let whole: Value = serde_json::from_str(&run(&["--json"]).stdout).unwrap();
    let answer = received(&whole["received"]);
    assert_eq!(answer, expected(&whole["sent"]));
    assert_eq!((answer.source.as_str(), answer.estimates.len()), ("wave_speeds", emt_models()));
    // As text, one line per model, with the same numbers.
    let printed = run(&[]).stdout;
    for estimate in &answer.estimates {
        let line = printed.lines().find(|l| l.split_whitespace().next() == Some(&estimate.model));
        let line = line.unwrap_or_else(|| panic!("no line of {}:\n{printed}", estimate.model));
        for value in estimate.k.iter().chain(&estimate.z) {
            assert!(line.contains(&format!("{value:.4} +- ")), "{line}");
        }
    }
}

#[test]
fn an_instrument_of_another_vendor_that_a_launch_file_lists_is_of_the_run_and_recorded() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    // The run begins when this program, which has its answer, reads packings too.
    let folder = here("../nodes/launch");
    let text = format!(
        "import sys; sys.path.insert(0, {folder:?})\nimport instrument as i\ni.main()\n\
         kind = i.message('grainlab_msgs/msg/Packing')\n\
         packings = i.reader(i.participant(), 'packing', kind, i.LATCHED)\n\
         while not packings.take(): i.time.sleep(0.01)\n"
    );
    let program = lab.folder().join("listed.py");
    std::fs::write(&program, text).unwrap();
    let program = format!("{} {}", python.display(), program.display());
    let listed = format!("- executable:\n    cmd: {program}\n    name: instrument\n    output: screen\n");
    let file = lab.folder().join("plugged.launch.yaml");
    let demo = include_str!("../../../nodes/launch/demo.launch.yaml");
    let demo = demo.replace(" min_readers:=2 -p exit", " min_readers:=2 -p min_packing_readers:=3 -p exit");
    assert!(demo.contains("min_packing_readers"));
    std::fs::write(&file, demo + &listed).unwrap();
    let scene = golden("scenes/tiny.toml");
    let run = lab.run(&["launch", &file.to_string_lossy(), "--scene", &scene.to_string_lossy()]);
    assert_eq!(run.code, Some(0), "{}\n{}", run.stdout, run.stderr);

    let folder = lab.last_run();
    let summary = std::fs::read_to_string(folder.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["strangers"], serde_json::json!([]), "{}", run.stdout);
    let sent: Vec<WaveSpeeds> = decoded(&folder, "/wave_speeds");
    let answers: Vec<Microstructure> = decoded(&folder, "/microstructure");
    let answers: Vec<_> = answers.into_iter().filter(|m| m.source == "wave_speeds").collect();
    assert_eq!((sent.len(), answers.len()), (1, 1));
    assert_eq!(answers[0], microstructure_of_speeds(&sent[0], &Settings::default()).message);
}

#[test]
fn records_that_are_written_into_a_folder_are_picked_and_inverted_when_a_state_is_complete() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let _node = lab.start(&["run", "emt_inversion"]);
    let (from, folder) = (here("golden/beads"), lab.folder().join("records"));
    std::fs::create_dir(&folder).unwrap();
    let late = "p90-250kPa.csv";
    for file in std::fs::read_dir(&from).unwrap().map(|f| f.unwrap().file_name()) {
        if file != late {
            std::fs::copy(from.join(&file), folder.join(&file)).unwrap();
        }
    }
    let script = here("../nodes/launch/record_instrument.py");
    let mut command = Command::new(&python);
    command.arg(&script).arg(&folder).args(["--grain-shear-modulus", "29e9", "--poisson", "0.2", "--once"]);
    let writer = std::thread::spawn(move || {
        std::thread::sleep(std::time::Duration::from_secs(5));
        std::fs::copy(from.join(late), folder.join(late)).unwrap();
    });
    let ended = peer(&lab, command.env("GRAINLAB", grainlab()));
    writer.join().unwrap();
    let states: Vec<&str> = ended.stdout.lines().filter(|l| l.starts_with("beads ")).collect();
    assert_eq!(states, ["beads 50e3 Pa", "beads 250e3 Pa"], "{}", ended.stdout);
    let estimates = ended.stdout.lines().filter(|l| l.starts_with("free-contact") && l.ends_with("ok"));
    assert_eq!(estimates.count(), 2, "{}", ended.stdout);
}

/// The distinct messages of a topic of a recording.
fn decoded<T: Message>(run: &Path, topic: &str) -> Vec<T> {
    distinct(run, topic).iter().map(|body| from_cdr(body).unwrap()).collect()
}

fn emt_models() -> usize {
    Settings::default().models.len()
}

#[test]
fn every_message_of_an_instrument_gets_its_own_answer_and_an_invalid_one_the_reason() {
    let Some(python) = python::with("cyclonedds") else { return };
    let lab = Lab::new();
    let mut node = lab.start(&["run", "emt_inversion"]);
    let script = here("tools/bad_instrument.py");
    let ended = peer(&lab, Command::new(&python).arg(&script));
    let said: Value = serde_json::from_str(&ended.stdout).unwrap();
    // The third instrument comes when the first two are answered, and does not take their answers for its own.
    for case in ["good", "nameless", "other"] {
        assert_eq!(received(&said[case]["received"]), expected(&said[case]["sent"]), "{case}");
    }
    assert_eq!(said["nameless"]["sent"]["axis"]["z"], 0.0);
    assert_ne!(said["other"]["received"]["estimates"], said["nameless"]["received"]["estimates"]);
    let reasons = [
        "WaveSpeeds.speeds[2].speed = NaN is refused",
        "WaveSpeeds.density = -1498.0 is refused",
        "WaveSpeeds.|axis| = 2.0 is refused",
        "WaveSpeeds.speeds[0].method = 250 is refused",
        "WaveSpeeds.header.stamp.nanosec = 4294967295.0 is refused",
    ];
    let bad = said["bad"].as_array().unwrap();
    assert_eq!(bad.len(), reasons.len());
    for (bad, reason) in bad.iter().zip(reasons) {
        let answer = received(&bad["received"]);
        assert_eq!(answer.name, bad["name"].as_str().unwrap());
        assert_eq!(answer.estimates.len(), emt_models());
        for e in &answer.estimates {
            assert!(e.status == Estimate::STATUS_UNKNOWN && e.warnings[0].starts_with(reason), "{e:?}");
        }
    }
    assert_eq!(said["refused"], 7);
    assert_eq!(said["again"]["estimates"], said["good"]["received"]["estimates"], "the node lives on");
    assert!(node.runs());
    node.signal(libc::SIGINT);
    let node = node.ended(LIMIT);
    assert_eq!(node.code, Some(0), "{}", node.stderr);
    for word in reasons.into_iter().chain(["refused: grainlab_msgs/msg/WaveSpeeds: "]) {
        assert!(node.stderr.contains(word), "{word:?} is missing:\n{}", node.stderr);
    }
    assert!(!node.stderr.contains("panicked"), "{}", node.stderr);
}
