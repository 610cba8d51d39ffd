//! Processes outside a run change none of its bytes and no exit code, and are named.

use grainlab_buskit::{EARLY_ANSWER, ESTIMATES, FORGERIES, Forger, OLD_RESULT};
use grainlab_msgs::msg::Microstructure;
use grainlab_msgs::{to_cdr, topics};
use serde_json::Value;
use std::os::unix::fs::{PermissionsExt, chown};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Command;
use system_tests::bodies::{REPRODUCIBLE, assert_same, decoded, recorded};
use system_tests::lab::{Lab, golden, grainlab, scene_path, summary, undisturbed};
use system_tests::process::Process;
use system_tests::python::say_skipped;
use system_tests::wait::{LIMIT, until};

fn strangers(run: &Path) -> Vec<Value> {
    let summary = summary(run);
    assert_eq!(summary["exit"], 0, "{summary}");
    summary["strangers"].as_array().unwrap().clone()
}

#[test]
fn a_launched_run_gives_the_same_bytes_under_forged_messages_and_names_every_stranger() {
    assert!(strangers(&undisturbed(&[])).is_empty());
    let lab = Lab::new();
    let forgeries = || FORGERIES.into_iter().chain([ESTIMATES]);
    let forgers: Vec<_> = forgeries().map(|forgery| Forger::start(lab.domain, forgery, None)).collect();
    lab.start_launch("tiny", &[]).ended(LIMIT).assert_code(0).assert_says(&["not of this run"]);
    for (forger, forgery) in forgers.iter().zip(forgeries()) {
        assert!(forger.sent() > 0, "{forgery:?}: nothing was forged");
    }
    let run = lab.last_run();
    assert_same(&undisturbed(&[]), &run);
    // All forgers are in one process.
    let strangers = strangers(&run);
    for forged in REPRODUCIBLE.into_iter().chain(["/run_state"]) {
        assert!(strangers[0]["ignored"][forged].as_u64() > Some(0), "{forged}: {strangers:?}");
    }
    lab.run(&["bag", "info", &run.to_string_lossy()]).assert_prints(&["left out"]);
}

/// An old result that is latched does not end a run early, and an inversion with other settings changes nothing.
#[test]
fn an_old_result_and_an_inversion_started_before_the_run_change_nothing() {
    let (expected, lab) = (undisturbed(&[]), Lab::new());
    let last: Microstructure = decoded(&expected, "/microstructure").pop().unwrap();
    let (source_step, source) = (last.source_step, "packing_report".to_owned());
    let old = Microstructure { source_step, source, ..Microstructure::default() };
    let _forger = Forger::start(lab.domain, OLD_RESULT, Some(to_cdr(&old)));
    let other = ["-p", "models:=ratio", "-p", "gamma_over_delta:=zero"];
    let _idle = lab.start(&[&["run", "emt_inversion", "--ros-args"], &other[..]].concat());
    lab.until_announced(&topics::MICROSTRUCTURE);
    for _ in 0..2 {
        let run = lab.launch(&golden("scenes/tiny.toml"), &[]);
        assert_same(&expected, &run);
        assert!(!strangers(&run).is_empty());
    }
}

#[test]
fn two_labs_in_one_domain_give_the_bytes_of_each_alone() {
    let lab = Lab::new();
    let first = lab.start_launch("tiny", &["--seed", "3", "--out", "a"]);
    until("the first one begins", || lab.folder().join("a/tiny-3-1").exists());
    let second = lab.start_launch("tiny", &["--seed", "4", "--out", "b"]);
    let alone = [undisturbed(&[]), undisturbed(&["--seed", "4"])];
    for (process, name, expected) in [(first, "a/tiny-3-1", &alone[0]), (second, "b/tiny-4-1", &alone[1])] {
        process.ended(LIMIT).assert_code(0);
        assert_same(expected, &lab.folder().join(name));
    }
}

#[test]
fn by_hand_a_second_inversion_is_an_error_that_names_it_and_a_forged_result_is_left_out() {
    for (forgery, second) in [(Some(EARLY_ANSWER), false), (Some(FORGERIES[2]), false), (None, true)] {
        let lab = Lab::new();
        let folder = lab.folder().join("run");
        let output = format!("output:={}", folder.display());
        let scene = format!("scene:={}", scene_path("tiny"));
        let node = |words: &str| {
            let words = words.replace("SCENE", &scene).replace("OUTPUT", &output);
            lab.start(&[&["run"], &words.split(' ').collect::<Vec<_>>()[..]].concat())
        };
        let mut others = vec![node("emt_inversion"), node("fabric_analyzer")];
        if second {
            others.push(node("emt_inversion --ros-args -r __node:=other -p models:=ratio"));
        }
        others.push(node("servo_controller --ros-args -p min_readers:=2"));
        let recorder = node("recorder --ros-args -p SCENE -p OUTPUT");
        let simulator = node(
            "dem_simulator --ros-args -p SCENE -p wait_for:=[stress,packing,clock] -p min_readers:=2 \
             -p finish:=at_once",
        );
        // After the start of the run, like the forger of answers: before it, two servos are an error.
        until("the run begins", || recorded(&folder, "/stress") > 0);
        let forger = forgery.map(|f| Forger::start(lab.domain, f, None));
        let ended = simulator.ended(LIMIT);
        if ended.code == Some(0) {
            until("the results of both packings", || recorded(&folder, "/microstructure") >= 2);
        }
        let recorder = recorder.ended_by(libc::SIGINT);
        drop(forger);
        if second {
            recorder.assert_code(1).assert_says(&["microstructure", "pid"]);
        } else if ended.code == Some(0) {
            recorder.assert_code(0);
            assert_same(&undisturbed(&[]), &folder);
        } else {
            ended.assert_says(&["two writers of strain_rate"]);
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
        ("$0 param list /recorder", "append"),
        // The one parameter that changes while a node runs; it stamps diagnostics.
        ("$0 param set /servo_controller use_sim_time true", "set"),
        // Messages outside the run: left out below.
        ("$0 topic pub --times 3 -r 10 /stress grainlab_msgs/msg/Stress '{sequence: 1}'", "#3"),
        ("$0 bag info $run || true", "/stress"),
    ] {
        other(can).assert_code(0).assert_prints(&[output]);
    }
    // The id of the run is in every GUID, and a number of a member is easy to choose.
    let member = "id=$($0 topic info /stress | grep -o '0112[0-9a-f]*' | head -n 1 | cut -c 5-16)
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
    run.ended_by(libc::SIGINT).assert_code(130);
    other("$0 launch --resume $run").assert_code(1).assert_says(&["ermission denied"]);
    let summary = summary(&folder);
    let ignored = |topic: &str| {
        let strangers = summary["strangers"].as_array().unwrap();
        strangers.iter().any(|s| s["ignored"][topic].as_u64() > Some(0))
    };
    assert!(ignored("/stress") && ignored("/diagnostics"), "{summary}");
    assert!(!summary.to_string().contains("two processes"), "{summary}");

    // Files of the run are those of its user's umask.
    by_user(&lab, OWNER, "umask 077; $0 launch --scene tiny.toml --out closed").ended(LIMIT).assert_code(0);
    let ended = other("$0 bag info closed/*");
    assert!(ended.code != Some(0) && ended.stderr.contains("ermission denied"), "{ended:?}");
}
