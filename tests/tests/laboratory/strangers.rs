//! Processes outside a run change none of its bytes and no exit code, and are named.

use grainlab_msgs::topics;
use grainlab_recordings::{Recording, Selection};
use serde_json::Value;
use std::os::unix::fs::{PermissionsExt, chown};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};
use system_tests::bodies::assert_same;
use system_tests::forger::{FORGERIES, Forger, Forgery};
use system_tests::lab::{LIMIT, Lab, golden, grainlab, until};
use system_tests::process::Process;
use system_tests::python::say_skipped;

fn strangers(run: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(run.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(summary["exit"], 0, "{summary}");
    summary["strangers"].as_array().unwrap().clone()
}

/// Number of messages from outside the run that the recorder left out.
fn ignored(run: &Path) -> u64 {
    let counts =
        |s: &Value| s["ignored"].as_object().unwrap().values().map(|n| n.as_u64().unwrap()).sum::<u64>();
    strangers(run).iter().map(counts).sum()
}

#[test]
fn a_launched_run_gives_the_same_bytes_under_forged_messages_and_names_the_stranger() {
    let scene = golden("scenes/tiny.toml");
    let quiet = Lab::new();
    let expected = quiet.launch(&scene, &[]);
    assert!(strangers(&expected).is_empty());
    for forgery in FORGERIES {
        let lab = Lab::new();
        let forger = Forger::start(lab.domain, forgery);
        let scene = scene.to_string_lossy();
        let ended = lab.run(&["launch", "--scene", &scene]);
        assert_eq!(ended.code, Some(0), "{forgery:?}\n{}\n{}", ended.stdout, ended.stderr);
        assert!(forger.sent() > 0, "{forgery:?}: nothing was forged");
        let run = lab.last_run();
        assert_same(&expected, &run);
        assert!(ignored(&run) > 0, "{forgery:?}: {:?}", strangers(&run));
        assert!(ended.stderr.contains("not of this run"), "{forgery:?}\n{}", ended.stderr);
        let info = lab.run(&["bag", "info", &run.to_string_lossy()]);
        assert!(info.stdout.contains("left out"), "{forgery:?}\n{}", info.stdout);
    }
}

#[test]
fn an_old_result_that_is_latched_does_not_end_a_run_early() {
    let scene = golden("scenes/tiny.toml");
    let quiet = Lab::new();
    let expected = quiet.launch(&scene, &[]);
    let last = Recording::open(&expected).unwrap();
    let last = last.messages(&Selection::topics(["/microstructure"])).unwrap().last().unwrap();
    let last: grainlab_msgs::msg::Microstructure = grainlab_msgs::from_cdr(&last.payload).unwrap();
    let lab = Lab::new();
    let _forger = Forger::start(lab.domain, Forgery::OldMicrostructure { step: last.source_step });
    assert_same(&expected, &lab.launch(&scene, &[]));
}

#[test]
fn an_inversion_started_before_the_run_changes_nothing() {
    let scene = golden("scenes/tiny.toml");
    let (quiet, lab) = (Lab::new(), Lab::new());
    let expected = quiet.launch(&scene, &[]);
    let _idle = lab.start(&[
        "run",
        "emt_inversion",
        "--ros-args",
        "-p",
        "models:=ratio",
        "-p",
        "gamma_over_delta:=zero",
    ]);
    lab.until_announced(&topics::MICROSTRUCTURE);
    for _ in 0..2 {
        let run = lab.launch(&scene, &[]);
        assert_same(&expected, &run);
        assert!(!strangers(&run).is_empty());
    }
}

#[test]
fn two_labs_in_one_domain_give_the_bytes_of_each_alone() {
    let scene = golden("scenes/tiny.toml");
    let path = scene.to_string_lossy();
    let shared = Lab::new();
    let solo = Lab::new();
    let expected = ["3", "4"].map(|seed| solo.launch(&scene, &["--seed", seed]));
    let first = shared.start(&["launch", "--scene", &path, "--seed", "3", "--out", "a"]);
    std::thread::sleep(Duration::from_millis(300));
    let second = shared.start(&["launch", "--scene", &path, "--seed", "4", "--out", "b"]);
    for (process, name, expected) in
        [(first, "a/tiny-3-1", &expected[0]), (second, "b/tiny-4-1", &expected[1])]
    {
        let ended = process.ended(LIMIT);
        assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
        assert_same(expected, &shared.folder().join(name));
    }
}

#[test]
fn by_hand_a_second_inversion_is_an_error_that_names_it_and_a_forged_result_is_left_out() {
    let scene = golden("scenes/tiny.toml");
    let path = scene.to_string_lossy();
    let quiet = Lab::new();
    let expected = quiet.launch(&scene, &[]);
    for (forgery, second) in
        [(Some(Forgery::EarlyAnswer), false), (Some(Forgery::Packing), false), (None, true)]
    {
        let lab = Lab::new();
        let folder = lab.folder().join("run");
        let output = format!("output:={}", folder.display());
        let stress = Selection::topics(["/stress"]);
        let scene = format!("scene:={path}");
        let mut others = vec![lab.start(&["run", "emt_inversion"]), lab.start(&["run", "fabric_analyzer"])];
        if second {
            others.push(lab.start(&[
                "run",
                "emt_inversion",
                "--ros-args",
                "-r",
                "__node:=other",
                "-p",
                "models:=ratio",
            ]));
        }
        others.push(lab.start(&["run", "servo_controller", "--ros-args", "-p", "min_readers:=2"]));
        let recorder = lab.start(&["run", "recorder", "--ros-args", "-p", &scene, "-p", &output]);
        let wait = "wait_for:=[stress,packing,clock]";
        let simulator = [
            "run",
            "dem_simulator",
            "--ros-args",
            "-p",
            &scene,
            "-p",
            wait,
            "-p",
            "min_readers:=2",
            "-p",
            "exit_when_finished:=true",
        ];
        let simulator = lab.start(&simulator);
        // After the start of the run, like the forger of answers: before it, two servos are an error.
        until("the run begins", || {
            Recording::open(&folder).is_ok_and(|r| r.messages(&stress).is_ok_and(|m| m.count() > 0))
        });
        let forger = forgery.map(|f| Forger::start(lab.domain, f));
        let ended = simulator.ended(LIMIT);
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_secs(3) {
            std::thread::sleep(Duration::from_millis(100));
        }
        recorder.signal(libc::SIGINT);
        let recorded = recorder.ended(LIMIT);
        drop(forger);
        if second {
            assert_eq!(recorded.code, Some(1), "{}", recorded.stderr);
            assert!(
                recorded.stderr.contains("microstructure") && recorded.stderr.contains("pid"),
                "{}",
                recorded.stderr
            );
        } else if ended.code == Some(0) {
            assert_eq!(recorded.code, Some(0), "{forgery:?} {}", recorded.stderr);
            assert_same(&expected, &lab.folder().join("run"));
        } else {
            assert!(ended.stderr.contains("two writers of strain_rate"), "{forgery:?} {}", ended.stderr);
        }
    }
}

const OWNER: u32 = 65533;
const OTHER: u32 = 65534;

/// Starts a shell script as a user of this host, in the laboratory's folder, with the binary as `$0`.
fn by_user(lab: &Lab, user: u32, script: &str) -> Process {
    let mut command = Command::new("sh");
    command
        .args(["-ec", script, "./grainlab"])
        .current_dir(lab.folder())
        .env("HOME", "/nonexistent")
        .uid(user)
        .gid(user);
    for (name, value) in lab.command(&[]).get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    Process::start(&mut command)
}

#[test]
fn another_user_of_the_host_reads_and_asks_and_is_ignored_and_ends_and_alters_nothing() {
    let lab = Lab::new();
    let set = |mode| std::fs::set_permissions(lab.folder(), PermissionsExt::from_mode(mode)).unwrap();
    std::fs::copy(grainlab(), lab.folder().join("grainlab")).unwrap();
    for scene in ["endless.toml", "tiny.toml"] {
        std::fs::copy(golden("scenes").join(scene), lab.folder().join(scene)).unwrap();
    }
    if chown(lab.folder(), Some(OWNER), Some(OWNER)).is_err() {
        return say_skipped("no right to start processes of other users");
    }
    set(0o755);
    let run = by_user(&lab, OWNER, "umask 022; exec $0 launch --scene endless.toml");
    lab.until_recorded(1000);
    let folder = lab.last_run();
    let other =
        |script: &str| by_user(&lab, OTHER, &format!("run={}; {script}", folder.display())).ended(LIMIT);
    let launcher = run.pid();

    for (can, output) in [
        ("$0 topic echo /stress --once", "stress:"),
        ("$0 topic list", "/packing"),
        ("$0 param get /dem_simulator seed", "1"),
        ("$0 service call /recorder/get_parameters '{names: [append]}'", "\"boolean_value\": false"),
        // The one parameter that changes while a node runs; it stamps diagnostics.
        ("$0 param set /servo_controller use_sim_time true", "set"),
        // Messages outside the run: left out below.
        ("$0 topic pub --times 3 -r 10 /stress grainlab_msgs/msg/Stress '{sequence: 1}'", "#3"),
        ("$0 bag info $run || true", "/stress"),
    ] {
        let ended = other(can);
        assert!(ended.code == Some(0) && ended.stdout.contains(output), "{can}: {ended:?}");
    }
    // The id of the run is in every GUID, and a number of a member is easy to choose.
    let member = "id=$($0 topic info /stress -v | grep -o '0112[0-9a-f]*' | head -n 1 | cut -c 5-16)
        GRAINLAB_RUN=$id GRAINLAB_MEMBER=4 timeout 4 $0 run servo_controller";
    assert_eq!(other(member).code, Some(124));
    let processes = format!("kill -INT {launcher} || kill -KILL $(pgrep -P {launcher} | head -n 1)");
    for (cannot, reason) in [
        ("$0 param set /dem_simulator seed 5", "read-only"),
        (processes.as_str(), "not permitted"),
        ("echo >> $run/*.mcap", "ermission denied"),
        ("rm -f $run/*.mcap", "ermission denied"),
        ("mv $run elsewhere", "ermission denied"),
    ] {
        let ended = other(cannot);
        assert!(ended.code != Some(0) && ended.stderr.contains(reason), "{cannot}: {ended:?}");
    }
    run.signal(libc::SIGINT);
    let ended = run.ended(LIMIT);
    assert_eq!(ended.code, Some(130), "{}", ended.stderr);
    let resumed = other("$0 launch --resume $run");
    assert!(resumed.code == Some(1) && resumed.stderr.contains("ermission denied"), "{resumed:?}");
    let summary = std::fs::read_to_string(folder.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let ignored = |topic: &str| {
        let strangers = summary["strangers"].as_array().unwrap();
        strangers.iter().any(|s| s["ignored"][topic].as_u64() > Some(0))
    };
    assert!(ignored("/stress") && ignored("/diagnostics"), "{summary}");
    assert!(!summary.to_string().contains("two processes"), "{summary}");

    // Files of the run are those of its user's umask.
    let closed = by_user(&lab, OWNER, "umask 077; $0 launch --scene tiny.toml --out closed").ended(LIMIT);
    assert_eq!(closed.code, Some(0), "{}", closed.stderr);
    let ended = other("$0 bag info closed/*");
    assert!(ended.code != Some(0) && ended.stderr.contains("ermission denied"), "{ended:?}");
}
