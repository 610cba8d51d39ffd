use super::*;
use crate::agreement::names_of_run;
use NodeKind::{
    AcousticProbe, DemSimulator, EmtInversion, FabricAnalyzer, PackingPictures, Recorder, ServoController,
};
use std::path::Path;

const DEFAULT: &str = BUILT_IN[0].1;
const ACOUSTIC: &str = BUILT_IN[1].1;

fn nodes(text: &str, values: &[(&'static str, &str)]) -> Result<Vec<NodePlan>, PlanError> {
    let values = values.iter().map(|(k, v)| (*k, (*v).to_owned())).collect();
    LaunchFile::parse(text, Path::new("."))?.nodes(&values)
}

#[test]
fn the_default_file_starts_one_of_each_node_on_the_demo() {
    let file = LaunchFile::parse(DEFAULT, Path::new(".")).unwrap();
    assert_eq!(file.default_of("scene"), Some("demo"));
    let plans = file.nodes(&BTreeMap::new()).unwrap();
    let started: Vec<NodeKind> = plans.iter().map(|p| p.node.unwrap()).collect();
    assert_eq!(started, [Recorder, EmtInversion, FabricAnalyzer, ServoController, DemSimulator]);
    assert!(plans.iter().all(|p| p.respawn != [Recorder, DemSimulator].contains(&p.node.unwrap())));
}

#[test]
fn the_acoustic_file_is_the_default_one_with_a_probe_that_the_run_waits_for() {
    let file = LaunchFile::parse(ACOUSTIC, Path::new(".")).unwrap();
    let (default, acoustic) = (nodes(DEFAULT, &[]).unwrap(), file.nodes(&BTreeMap::new()).unwrap());
    let (probe, others): (Vec<_>, Vec<_>) = acoustic.iter().partition(|p| p.is(AcousticProbe));
    let [probe] = probe.as_slice() else { panic!("{} probes", probe.len()) };
    assert!(probe.respawn && probe.arguments.contains(&"speed_noise:=0.003".to_owned()), "{probe:?}");
    let without_wait = |plan: &NodePlan| {
        let words = plan.arguments.join(" ").replace(" -p min_packing_readers:=3", "");
        (plan.name.clone(), words, plan.respawn)
    };
    let [default, others] = [default.iter().collect(), others]
        .map(|p: Vec<&NodePlan>| p.into_iter().map(without_wait).collect::<Vec<_>>());
    assert_eq!(default, others);
    for (name, text) in BUILT_IN {
        assert_eq!(
            LaunchFile::parse(text, Path::new(".")).unwrap().default_of("scene"),
            Some("demo"),
            "{name}"
        );
    }
}

#[test]
fn a_value_with_blanks_stays_one_word() {
    let plans = nodes(DEFAULT, &[("out", "some where/$(x)"), ("scene", "a b.toml")]).unwrap();
    assert!(plans[0].arguments.contains(&"output:=some where/$(x)".to_owned()), "{:?}", plans[0]);
    assert!(plans[0].arguments.contains(&"scene:=a b.toml".to_owned()));
}

#[test]
fn a_third_party_program_gets_its_words_as_a_shell_would_split_them_and_values_without_quotes() {
    let cmd = r#"python3 probe.py "two words" '' --scene $(var scene)"#;
    let text = format!("{DEFAULT}- executable:\n    cmd: {cmd}\n    name: probe\n");
    let plans = nodes(&text, &[("scene", r#""/a b/scene.toml""#)]).unwrap();
    let probe = plans.last().unwrap();
    assert_eq!(probe.arguments, ["probe.py", "two words", "", "--scene", "/a b/scene.toml"]);
    let ours = plans[0].arguments.iter().any(|word| word == r#"scene:="/a b/scene.toml""#);
    assert!(ours, "parameters of nodes are YAML: {:?}", plans[0]);
}

#[test]
fn what_is_not_supported_is_refused_and_named() {
    let one = |entry: &str| format!("launch:\n- {entry}\n");
    for (text, needle) in [
        (one("node: {pkg: a, exec: b}"), "node"),
        (one("executable: {cmd: grainlab run recorder, shell: true}"), "shell"),
        (one("executable: {cmd: grainlab bag record}"), "grainlab bag record"),
        (one("executable: {cmd: ''}"), "a program with its arguments"),
        (one("executable: {cmd: 'python3 \"probe.py'}"), "a program with its arguments"),
        (one("executable: {cmd: 'grainlab run recorder -p x:=$(eval 1)'}"), "$(var NAME)"),
        (one("executable: {cmd: 'grainlab run recorder -p x:=$(var y)'}"), "\"y\""),
        (one("executable: {cmd: grainlab run recorder, respawn: often}"), "often"),
        (one("executable: {cmd: grainlab run recorder, on_exit: restart}"), "on_exit: \"restart\""),
        (
            one("executable: {cmd: grainlab run emt_inversion, on_exit: shutdown}"),
            "for dem_simulator and recorder",
        ),
        (one("executable: {cmd: sleep 1, on_exit: shutdown}"), "for dem_simulator and recorder"),
        (one("executable: {cmd: grainlab run recorder}"), "0 of dem_simulator"),
        (one("executable: {cmd: grainlab run recoder}"), "executable recoder: there is no node \"recoder\""),
        (one("executable: {cmd: grainlab run recorder, name: ../../evil}"), "../../evil"),
        (one("executable: {cmd: grainlab run recorder, name: ''}"), "lower case"),
        (one("executable: {cmd: grainlab run recorder}\n- executable: {cmd: grainlab run recorder}"), "two"),
        (one("arg: {name: scene}"), "line 2: arg \"scene\" has no default"),
        (one("group:\n  - arg: {name: x, default: a}\n  - node: {pkg: grainlab}"), "missing field `exec`"),
        (one("executable: {cmd: sleep 1}\n- executable: {cmd: sleep 2}"), "line 3: two executables"),
        ("lunch: []".to_owned(), "lunch"),
    ] {
        let error = nodes(&text, &[]).expect_err(&text).to_string();
        assert!(error.contains(needle), "{text}: {error}");
    }
    let error = nodes("launch: []", &[("seed", "3")]).unwrap_err();
    assert!(error.to_string().contains("does not declare the arg"), "{error}");
    let misspelt = nodes(&one("executable: {cmd: grainlab run recorder, respwan: true}"), &[]).unwrap_err();
    assert!(!misspelt.to_string().contains("ros2 launch"), "ROS 2 does not know it either: {misspelt}");
}

#[test]
fn values_that_repeat_themselves_are_refused_before_they_fill_the_memory() {
    let twice = "- let: {name: a, value: $(var a)$(var a)}\n".repeat(40);
    let file = format!("launch:\n- let: {{name: a, value: x}}\n{twice}");
    let error = nodes(&file, &[]).unwrap_err().to_string();
    assert!(error.contains("more than 4096 bytes") && error.starts_with("line 15: "), "{error}");
    let long = "x".repeat(5_000);
    let file = format!("launch:\n- let: {{name: a, value: {long}}}\n- let: {{name: b, value: $(var a)}}\n");
    assert!(nodes(&file, &[]).unwrap_err().to_string().contains("more than 4096 bytes"));
    // A value that is given is refused also where nothing uses it.
    let error =
        nodes("launch:\n- arg: {name: a, default: x}\n", &[("a", long.as_str())]).unwrap_err().to_string();
    assert_eq!(error, "the value of the arg \"a\" has more than 4096 bytes");
}

#[test]
fn what_only_ros_2_launch_has_is_refused_with_its_line_and_that_advice() {
    let argument = |key: &str| format!("launch:\n- arg: {{name: a, default: b}}\n- {key}");
    for (text, needle) in [
        ("arg: {name: x, default: y, choice: [{value: y}]}", "choice"),
        ("group: {scoped: false, children: []}", "sequence"),
        ("set_parameter: {name: x, value: y}", "set_parameter"),
        ("set_remap: {from: x, to: y}", "set_remap"),
        ("timer: {period: 3}", "timer"),
        ("executable: {cmd: sleep 1, shell: true}", "shell"),
        ("executable: {cmd: sleep 1, env: [{name: x, value: y}]}", "env"),
        ("node: {pkg: grainlab, exec: emt_inversion, ros_args: --log-level info}", "ros_args"),
        ("let: {name: x, value: $(env HOME)}", "$(env HOME)"),
        ("let: {name: x, value: $(find-pkg-share grainlab)}", "find-pkg-share"),
        ("include: {file: $(find-pkg-share grainlab)/launch/demo.launch.yaml}", "find-pkg-share"),
    ] {
        let error = nodes(&argument(text), &[]).expect_err(text).to_string();
        assert!(error.contains("line 3") && error.contains(needle), "{text}: {error}");
        assert!(error.ends_with("`grainlab run NODE` as executable"), "{text}: {error}");
    }
}

#[test]
fn a_value_that_a_node_does_not_take_is_refused_before_anything_is_started() {
    let refused = |values: &[(&'static str, &str)]| {
        let plans = nodes(DEFAULT, values).unwrap();
        plans.iter().try_for_each(NodePlan::check_parameters).map_err(|e| e.to_string())
    };
    assert_eq!(refused(&[]), Ok(()));
    assert_eq!(refused(&[("threads", "2"), ("simd", "scalar")]), Ok(()));
    for (name, value) in [("threads", "nope"), ("threads", "-1"), ("simd", "mmx"), ("out", "[1]")] {
        let error = refused(&[(name, value)]).unwrap_err();
        assert!(error.starts_with("executable ") && error.contains(value), "{error}");
    }
    let misspelt = DEFAULT.replace("-p threads:=", "-p treads:=");
    let error = nodes(&misspelt, &[]).unwrap().iter().find_map(|p| p.check_parameters().err()).unwrap();
    assert!(error.to_string().contains("treads") && error.to_string().contains("dem_simulator"), "{error}");
}

#[test]
fn a_launched_simulator_does_not_look_for_duplicates_by_default() {
    let mut plans = nodes(DEFAULT, &[]).unwrap();
    plans.iter_mut().for_each(NodePlan::supervised);
    for plan in plans {
        let (ros, plain) = grainlab_node_kit::RosArgs::parse(&plan.arguments).unwrap();
        let given = ros.parameters.iter().find(|p| p.name == "look_around").map(|p| p.value.as_str());
        assert_eq!(given, plan.is(DemSimulator).then_some("0.0"));
        assert_eq!(plain, ["run", plan.node.unwrap().name()]);
    }
    let told = DEFAULT.replace("wait_for:=", "look_around:=2.0 -p wait_for:=");
    let mut plans = nodes(&told, &[]).unwrap();
    plans.iter_mut().for_each(NodePlan::supervised);
    let simulator = plans.iter().find(|p| p.is(DemSimulator)).unwrap();
    let (ros, _) = grainlab_node_kit::RosArgs::parse(&simulator.arguments).unwrap();
    assert_eq!(ros.parameters.iter().rfind(|p| p.name == "look_around").unwrap().value, "2.0");
}

#[test]
fn the_simulator_of_a_shipped_file_ends_by_itself_and_under_our_launcher_stays_for_restarted_readers() {
    for file in [DEFAULT, ACOUSTIC] {
        assert_eq!(file.matches("on_exit: shutdown").count(), 2, "simulator and recorder");
        let mut plans = nodes(file, &[]).unwrap();
        let value = |plan: &NodePlan, name: &str| {
            let (ros, _) = grainlab_node_kit::RosArgs::parse(&plan.arguments).unwrap();
            ros.parameters.iter().rfind(|p| p.name == name).map(|p| p.value.clone())
        };
        let simulator = plans.iter_mut().find(|p| p.is(DemSimulator)).unwrap();
        assert_eq!(value(simulator, "finish").as_deref(), Some("inverted"));
        simulator.supervised();
        assert_eq!(value(simulator, "finish").as_deref(), Some("never"));
        simulator.check_parameters().unwrap();
    }
}

#[test]
fn a_program_that_is_not_ours_is_started_with_its_arguments_and_named_after_itself() {
    let more = DEFAULT.to_owned()
        + "- executable: {cmd: python3 tools/instrument.py --rate 2}\n- executable: {cmd: /opt/x/probe.sh, name: probe}\n";
    let plans = nodes(&more, &[]).unwrap();
    let [.., instrument, probe] = plans.as_slice() else { panic!("{} plans", plans.len()) };
    assert_eq!((instrument.node, instrument.name.as_str()), (None, "python3"));
    assert_eq!(
        (instrument.program.as_str(), instrument.arguments.join(" ").as_str()),
        ("python3", "tools/instrument.py --rate 2")
    );
    assert_eq!((probe.node, probe.name.as_str(), probe.program.as_str()), (None, "probe", "/opt/x/probe.sh"));
}

#[test]
fn a_run_may_have_several_inversions_and_one_of_everything_else() {
    let again =
        |node: NodeKind| format!("{DEFAULT}- executable: {{cmd: grainlab run {node}, name: second}}\n");
    assert_eq!(nodes(&again(EmtInversion), &[]).unwrap().len(), 6);
    for node in [ServoController, FabricAnalyzer, DemSimulator, Recorder] {
        let error = nodes(&again(node), &[]).unwrap_err().to_string();
        assert!(error.contains("starts 2 of"), "{error}");
    }
}

#[test]
fn pictures_are_started_and_checked_like_every_node_and_the_bridge_of_earlier_versions_gets_advice() {
    let with = |arguments: &str| {
        format!("{DEFAULT}- executable: {{cmd: 'grainlab run packing_pictures --ros-args {arguments}'}}\n")
    };
    let plans = nodes(&with("-p use_sim_time:=true"), &[]).unwrap();
    let pictures = plans.last().unwrap();
    assert!(pictures.is(PackingPictures) && pictures.name == "packing_pictures", "{pictures:?}");
    assert_eq!(pictures.check_parameters(), Ok(()));
    let misspelt = nodes(&with("-p prot:=2"), &[]).unwrap();
    assert!(misspelt.last().unwrap().check_parameters().unwrap_err().to_string().contains("prot"));
    let apart = names_of_run(&nodes(&with("-r packing:=grains"), &[]).unwrap()).unwrap_err().to_string();
    assert!(apart.contains("executable packing_pictures: the topic packing is /grains there"), "{apart}");
    let twice = format!("{}- executable: {{cmd: grainlab run packing_pictures, name: second}}\n", with(""));
    assert_eq!(nodes(&twice, &[]).unwrap_err(), PlanError::count(PackingPictures, 2));
    let removed = with("").replace("packing_pictures", "foxglove_bridge");
    let removed = nodes(&removed, &[]).unwrap_err().to_string();
    assert!(removed.contains("line ") && removed.contains("open a recording in Foxglove"), "{removed}");
}

#[test]
fn a_mutated_launch_file_gives_plans_or_an_error() {
    fuzzing::Target {
        name: "launch",
        seeds: [DEFAULT, ACOUSTIC].map(|t| t.as_bytes().to_vec()).into(),
        words: &[
            "launch:",
            "- arg:",
            "- executable:",
            "cmd:",
            "name:",
            "$(var",
            ")",
            "$(",
            "'",
            "&a",
            "*a",
            "respawn",
            "on_exit",
        ],
        memory: (usize::MAX, 0),
        decode: &mut |bytes| {
            let text = String::from_utf8_lossy(bytes);
            for plan in nodes(&text, &[("scene", "s 1.toml"), ("seed", "3")]).unwrap_or_default() {
                let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
                assert!(plan.name.chars().all(plain) && !plan.name.is_empty(), "{:?}", plan.name);
            }
        },
    }
    .run();
}

/// The default file with these ROS arguments for every node.
fn with_arguments(arguments: &str) -> String {
    let nodes = ["recorder", "emt_inversion", "fabric_analyzer", "servo_controller", "dem_simulator"];
    nodes.iter().fold(DEFAULT.to_owned(), |text, node| {
        let (with, bare) = (format!("run {node} --ros-args "), format!("run {node}"));
        let given = format!("{with}{arguments} ");
        if text.contains(&with) { text.replace(&with, &given) } else { text.replace(&bare, &given) }
    })
}

#[test]
fn the_names_of_a_run_are_those_that_all_its_processes_use() {
    let resolved = |arguments: &str, topic: &str| {
        let names = names_of_run(&nodes(&with_arguments(arguments), &[]).unwrap()).unwrap();
        names.for_node("launcher").resolve(topic).unwrap()
    };
    assert_eq!(resolved("", "stress"), "/stress");
    assert_eq!(resolved("-r __ns:=/left", "run_state"), "/left/run_state");
    assert_eq!(resolved("-r __ns:=/left", "/diagnostics"), "/diagnostics");
    assert_eq!(resolved("--remap __ns:=/left -r run_state:=/x/state", "run_state"), "/x/state");
}

#[test]
fn processes_that_would_not_meet_are_refused_with_the_topic_and_both_names() {
    let refused = |text: &str| names_of_run(&nodes(text, &[]).unwrap()).unwrap_err().to_string();
    let one_side = |rule: &str| {
        DEFAULT.replace("run dem_simulator --ros-args", &format!("run dem_simulator --ros-args -r {rule}"))
    };
    for (text, topic, name) in [
        (one_side("__ns:=/left"), "stress", "/left/stress"),
        (one_side("packing:=grains"), "packing", "/grains"),
        (one_side("/diagnostics:=/d"), "/diagnostics", "/d"),
        (
            DEFAULT.replace("run emt_inversion", "run emt_inversion --ros-args -r microstructure:=/m"),
            "microstructure",
            "/m",
        ),
    ] {
        let error = refused(&text);
        assert!(error.contains(&format!("the topic {topic} is {name} there")), "{error}");
    }
    let error = refused(&with_arguments("-r stress:=strain_rate"));
    assert!(error.contains("stress and strain_rate are both /strain_rate"), "{error}");
    // A rule for a topic that a node does not use changes nothing.
    let unused = DEFAULT.replace("run emt_inversion", "run emt_inversion --ros-args -r stress:=/s");
    assert!(names_of_run(&nodes(&unused, &[]).unwrap()).is_ok());
}

#[test]
fn args_that_the_launcher_sets_are_declared_and_handed_on() {
    let values = [("scene", "/r/scene.toml"), ("seed", "3"), ("out", "/r")];
    let undeclared = DEFAULT.replace("name: out\n", "name: where\n");
    let error = nodes(&undeclared, &values).unwrap_err().to_string();
    assert!(error.contains("\"out\"") && error.contains("- arg: {name: out, default:"), "{error}");
    let check = |text: &str| {
        let plans = nodes(text, &values).unwrap();
        let agrees = |p: &NodePlan| p.check_handed_on(Path::new("/r/scene.toml"), 3, Path::new("/r"));
        plans.iter().try_for_each(agrees).map_err(|e| e.to_string())
    };
    assert_eq!(check(DEFAULT), Ok(()));
    let simulator = "run dem_simulator --ros-args -p scene:=$(var scene) -p seed:=$(var seed)";
    for (kept, parameter) in [("-p scene:=$(var scene)", "seed"), ("-p seed:=$(var seed)", "scene")] {
        let error =
            check(&DEFAULT.replace(simulator, &format!("run dem_simulator --ros-args {kept}"))).unwrap_err();
        assert!(
            error.starts_with("executable dem_simulator: its parameter ") && error.contains(parameter),
            "{error}"
        );
    }
    let error = check(&DEFAULT.replace("-p output:=$(var out)", "")).unwrap_err();
    assert!(error.contains("executable recorder: its parameter output"), "{error}");
}

#[test]
fn an_included_file_that_is_too_large_is_refused_before_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let large = folder.path().join("large.launch.yaml");
    std::fs::write(&large, "#".repeat(2 << 20)).unwrap();
    let error = nodes(&format!("launch:\n- include: {{file: {}}}\n", large.display()), &[]).unwrap_err();
    assert!(error.to_string().contains("more than 1048576 bytes"), "{error}");
}
