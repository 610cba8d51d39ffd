//! LAMMPS on two processes as the engine of a laboratory.

use grainlab_msgs::msg;
use std::path::Path;
use std::time::Duration;
use system_tests::bodies::{decoded, distinct};
use system_tests::lab::{Lab, appeared, golden, summary};
use system_tests::process::{children, runs, send};
use system_tests::python;
use system_tests::wait::{until, until_within};

/// Time limit of a run: MPI waits in a loop, and processes that share a core with others are many times slower.
const PATIENCE: Duration = Duration::from_secs(900);

/// The command of LAMMPS on two processes, from the packages of the Python of the tests.
fn two_processes() -> Option<String> {
    let folder = python::with("lammps")?.parent()?.to_owned();
    Some(format!("{} -n 2 {}", folder.join("mpiexec").display(), folder.join("lmp").display()))
}

/// Every process below this one.
fn below(pid: u32) -> Vec<u32> {
    children(pid, "").into_iter().flat_map(|child| [vec![child], below(child)].concat()).collect()
}

fn engines(run: &Path) -> Vec<String> {
    let ranges = summary(run)["engines"].as_array().cloned().unwrap_or_default();
    ranges.iter().map(|range| range["engine"].as_str().unwrap().to_owned()).collect()
}

fn last_report(run: &Path) -> msg::PackingReport {
    decoded(run, "/packing_report").pop().unwrap()
}

#[test]
fn lammps_ends_with_a_killed_run_and_its_files_are_removed() {
    let Some(command) = two_processes() else { return };
    let lab = Lab::new();
    let scene = golden("scenes/pressed.toml");
    let given = ["launch", "--one-process", "--engine", "lammps", "--engine-command", &command, "--scene"];
    // Its last phase lasts until the run is killed.
    let long = ["--set", "phase.settle.until.unbalanced=1e-12", "--set", "phase.settle.until.timeout=1e9"];
    let launcher = lab.start(&[given.as_slice(), &[&scene.to_string_lossy()], &long].concat());
    let begins = format!("grainlab-lammps-{}-", launcher.pid());
    let files = || {
        let all = std::fs::read_dir(std::env::temp_dir()).unwrap().flatten();
        all.filter(|entry| entry.file_name().to_string_lossy().starts_with(&begins)).count()
    };
    until_within(PATIENCE, "LAMMPS has its first packing", || lab.recorded() > 60);
    let processes = below(launcher.pid());
    assert!(files() == 1 && processes.len() > 2);
    launcher.signal(libc::SIGKILL);
    until_within(PATIENCE, "processes of LAMMPS end", || !processes.iter().any(|pid| runs(*pid)));
    until_within(PATIENCE, "files are removed", || files() == 0);
}

#[test]
fn a_run_with_lammps_goes_on_after_one_of_its_processes_ended_and_with_our_engine() {
    let Some(command) = two_processes() else { return };
    let scene = golden("scenes/pressed.toml");
    // A long last phase, which an interrupt hits also on a fast machine.
    let long = ["--set", "phase.settle.until.unbalanced=1e-6"];
    let with = [["--engine", "lammps"], ["--engine-command", &command], long].concat();
    let with = [with.as_slice(), &["--no-report"]].concat();
    let lab = Lab::new();
    let path = scene.to_string_lossy();
    let given = [&["launch", "--scene", &path], with.as_slice()].concat();
    lab.start(&given).ended(PATIENCE).assert_code(0);
    let whole = lab.last_run();
    assert!(
        matches!(engines(&whole).as_slice(), [one] if one.starts_with("lammps ") && one.ends_with(", 2 ranks"))
    );
    let requests: Vec<msg::Stress> = decoded(&whole, "/stress");
    let last_phase = requests.iter().position(|request| request.phase == 3).unwrap();
    // Both engines press the same gas to packings that differ as those of two seeds do.
    let (theirs, ours) = (last_report(&whole), last_report(&Lab::new().launch(&scene, &["--no-report"])));
    assert!((theirs.solid_fraction - ours.solid_fraction).abs() < 0.01);
    assert!((theirs.contacts.mechanical_coordination - ours.contacts.mechanical_coordination).abs() < 0.4);
    // One of the two processes ends in the last phase: the run goes on from the packing before it, to the same requests.
    let start = |lab: &Lab| {
        let launcher = lab.start(&given);
        let simulator = appeared(&launcher, "run dem_simulator");
        until_within(PATIENCE, "the last phase", || lab.recorded() >= last_phase + 30);
        (launcher, below(simulator))
    };
    let lab = Lab::new();
    let (launcher, processes) = start(&lab);
    send(*processes.last().unwrap(), libc::SIGKILL);
    let continues = "the run continues from the last packing recorded";
    launcher.ended(PATIENCE).assert_code(0).assert_says(&[continues]);
    assert!(distinct(&whole, "/stress") == distinct(&lab.last_run(), "/stress"));
    until("processes of LAMMPS end", || !processes.iter().any(|pid| runs(*pid)));
    // An interrupted run goes on with another engine, and the results name both.
    let lab = Lab::new();
    let (launcher, _) = start(&lab);
    launcher.signal(libc::SIGINT);
    launcher.ended(PATIENCE).assert_code(130);
    let run = lab.last_run();
    let resumed = lab.run(&["launch", "--resume", &run.to_string_lossy(), "--engine", "grainlab"]);
    resumed.assert_code(0).assert_prints(&["; grainlab, packings from step"]);
    assert!(
        matches!(engines(&run).as_slice(), [first, last] if first.starts_with("lammps") && last == "grainlab")
    );
}
