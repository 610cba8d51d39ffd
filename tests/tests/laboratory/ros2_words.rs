//! The page of the commands of ROS 2: every row does what it says, in a domain with a running laboratory.

use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::time::{Duration, Instant};
use system_tests::lab::{LIMIT, Lab, golden, grainlab};
use system_tests::process::Process;

const PAGE: &str = include_str!("../../../nodes/studio/graph/README.md");

/// Time after which a command that goes on gets Ctrl-C.
const GOES_ON: Duration = Duration::from_secs(8);

/// Time after which a command that should end by itself gets it, which is a fault.
const TOO_LONG: Duration = Duration::from_secs(60);

/// Commands that run at a time: most wait for discovery.
const AT_A_TIME: usize = 5;

/// The words behind `ros2` of each row, and the second column.
fn rows() -> Vec<(&'static str, &'static str)> {
    let row = |line: &'static str| {
        let (command, here) = line.strip_prefix("| `ros2 ")?.split_once("` | ")?;
        Some((command, here.strip_suffix(" |")?))
    };
    PAGE.lines().filter_map(row).collect()
}

/// The fault of a row, if it does not do what it says.
fn fault(lab: &Lab, command: &str, here: &str) -> Option<String> {
    let mut shell = Command::new("sh");
    let line = format!("exec {} {command}", grainlab().display());
    let plain = lab.command(&[]);
    shell.args(["-c", &line]).current_dir(plain.get_current_dir().unwrap_or(lab.folder()));
    shell.envs(plain.get_envs().filter_map(|(name, value)| Some((name, value?))));
    let mut process = Process::start(&mut shell);
    let goes_on = here.contains("until Ctrl-C");
    let begin = Instant::now();
    while process.runs() && begin.elapsed() < if goes_on { GOES_ON } else { TOO_LONG } {
        std::thread::sleep(Duration::from_millis(50));
    }
    process.signal(libc::SIGINT);
    let ended = process.ended(LIMIT);
    let is_right = match here.strip_prefix('`').and_then(|rest| rest.split('`').next()) {
        Some(form) => ended.code == Some(2) && ended.stderr.contains(form),
        None => [Some(0), Some(130).filter(|_| goes_on)].contains(&ended.code) && ended.code.is_some(),
    };
    let silent = here.starts_with("same") && !goes_on && ended.stdout.is_empty() && ended.stderr.is_empty();
    (!is_right || silent)
        .then(|| format!("{command}: exit {:?}\n{}{}", ended.code, ended.stdout, ended.stderr))
}

/// The faults of these rows, some at a time.
fn faults(lab: &Lab, rows: &[(&str, &str)]) -> Vec<String> {
    let (left, faults) = (Mutex::new(rows.iter()), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                while let Some((command, here)) = { left.lock().unwrap().next() } {
                    let found = fault(lab, command, here);
                    faults.lock().unwrap().extend(found);
                }
            });
        }
    });
    faults.into_inner().unwrap()
}

#[test]
fn commands_of_ros_2_work_or_name_the_form_that_does() {
    let rows = rows();
    let same = rows.iter().filter(|(_, here)| here.starts_with("same")).count();
    assert!(rows.len() >= 60 && same >= 45, "{} rows, {same} of them the same", rows.len());
    let lab = Lab::new();
    let endless = golden("scenes/endless.toml");
    let run = lab.start(&["launch", "--scene", endless.to_str().unwrap()]);
    lab.until_recorded(1000);
    let folder = lab.folder().to_owned();
    let talk = lab.start(&["topic", "pub", "-r", "20", "/chatter", "std_msgs/msg/String", "{data: hello}"]);
    let listen = lab.start(&["topic", "echo", "/listened", "std_msgs/msg/String"]);
    bag(&lab, &folder);
    std::fs::write(folder.join("emt_inversion.yaml"), lab.run(&["param", "dump", "/emt_inversion"]).stdout)
        .unwrap();
    std::fs::copy(golden("scenes/tiny.toml"), folder.join("tiny.toml")).unwrap();
    let launch = Path::new(env!("CARGO_MANIFEST_DIR")).join("../nodes/launch/demo.launch.yaml");
    std::fs::copy(launch, folder.join("demo.launch.yaml")).unwrap();
    // The doctor reports what the commands beside it start twice, and a name that two nodes have answers no question.
    let (alone, others): (Vec<_>, Vec<_>) = rows.into_iter().partition(|(command, _)| *command == "doctor");
    let starts =
        |command: &str| ["launch ", "run ", "bag record "].iter().any(|word| command.starts_with(word));
    let (nodes, questions): (Vec<_>, Vec<_>) = others.into_iter().partition(|(command, _)| starts(command));
    let phases = [&alone[..], &questions].into_iter().chain(nodes.chunks(1));
    let faults = phases.flat_map(|rows| faults(&lab, rows)).collect::<Vec<_>>();
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
    for process in [talk, listen, run] {
        process.signal(libc::SIGINT);
        process.ended(LIMIT);
    }
}

/// A recording of one topic of this test.
fn bag(lab: &Lab, folder: &Path) {
    let said = lab.start(&["topic", "pub", "-r", "20", "/played", "std_msgs/msg/String", "{data: again}"]);
    let recorder = lab.start(&["bag", "record", "/played", "-o", folder.join("my_bag").to_str().unwrap()]);
    std::thread::sleep(GOES_ON);
    for process in [recorder, said] {
        process.signal(libc::SIGINT);
        process.ended(LIMIT);
    }
}
