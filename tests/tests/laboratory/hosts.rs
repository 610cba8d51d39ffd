//! One laboratory over several hosts: the same bytes as on one.

use grainlab_recordings::{Recording, Selection};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use system_tests::bodies::{assert_same, assert_same_under, distinct};
use system_tests::hosts::Hosts;
use system_tests::lab::{LIMIT, Lab, golden, until};
use system_tests::process::{Ended, Process, handles};
use system_tests::python;

/// Each node and its host. The order is that of starting; the recorder ends last.
type Places = [(&'static str, &'static str); 5];

/// Simulator, servo and recorder on one host, what measures on the other.
const MEASURED_ELSEWHERE: Places = [
    ("recorder", "left"),
    ("emt_inversion", "right"),
    ("fabric_analyzer", "right"),
    ("servo_controller", "left"),
    ("dem_simulator", "left"),
];

/// Driven with the servo on the other host.
const DRIVEN_FROM_ELSEWHERE: Places = [
    ("recorder", "left"),
    ("emt_inversion", "right"),
    ("fabric_analyzer", "right"),
    ("servo_controller", "right"),
    ("dem_simulator", "left"),
];

/// A run whose nodes were started by hand.
struct Run {
    /// In the order of starting.
    nodes: Vec<(&'static str, Process)>,
    folder: PathBuf,
    namespace: &'static str,
}

impl Run {
    /// Starts every node on its host, with `variables` by host.
    fn start<const N: usize>(
        hosts: &Hosts,
        lab: &Lab,
        (name, namespace): (&str, &'static str),
        (scene, places): (&Path, Places),
        variables: &BTreeMap<&str, [(&str, &str); N]>,
    ) -> Self {
        let folder = lab.folder().join(name);
        let scene = format!("scene:={}", scene.display());
        let output = format!("output:={}", folder.display());
        let node_of = |(node, host): (&'static str, &'static str)| {
            let mut arguments = vec!["run", node, "--ros-args"];
            let namespaced = format!("__ns:={namespace}");
            if !namespace.is_empty() {
                arguments.extend(["-r", &namespaced]);
            }
            match node {
                "recorder" => arguments.extend(["-p", &scene, "-p", &output]),
                "servo_controller" => arguments.extend(["-p", "min_readers:=2"]),
                "dem_simulator" => arguments.extend([
                    "-p",
                    &scene,
                    "-p",
                    "wait_for:=[stress,packing,clock]",
                    "-p",
                    "min_readers:=2",
                ]),
                _ => {}
            }
            let mut command = hosts.on(host, &lab.command(&arguments));
            command.env("GRAINLAB_RUN", name).envs(variables[host]);
            (node, Process::start(&mut command))
        };
        Self { nodes: places.map(node_of).into(), folder, namespace }
    }

    /// Number of recorded messages of a topic so far.
    fn recorded(&self, topic: &str) -> usize {
        let topic = format!("{}{topic}", self.namespace);
        let Ok(recording) = Recording::open(&self.folder) else { return 0 };
        recording.messages(&Selection::topics([topic.as_str()])).map_or(0, Iterator::count)
    }

    /// Waits until so many messages of a topic are recorded.
    fn until_recorded(&mut self, topic: &str, messages: usize) {
        let begin = Instant::now();
        while self.recorded(topic) < messages {
            let ended = self.nodes.iter_mut().find_map(|(node, process)| (!process.runs()).then_some(*node));
            if ended.is_some() || begin.elapsed() > LIMIT / 2 {
                let recorded = self.recorded(topic);
                let outputs = self.end();
                panic!(
                    "{recorded} of {messages} messages of {topic}; ended by itself: {ended:?}\n{outputs:#?}"
                );
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Ends every node, the recorder last; their exit codes and messages.
    fn end(&mut self) -> Vec<(&'static str, Option<i32>, String)> {
        let end = |(node, process): (&'static str, Process)| {
            process.signal(libc::SIGTERM);
            let ended = process.ended(LIMIT);
            (node, ended.code, ended.stderr)
        };
        self.nodes.drain(..).rev().map(end).collect()
    }

    /// Waits for the results of every packing, ends the nodes, and compares the recording with `expected`.
    fn finish_as(mut self, expected: &Path) {
        let results = distinct(expected, "/microstructure").len();
        self.until_recorded("/microstructure", results);
        for (node, code, stderr) in self.end() {
            assert_eq!(code, Some(0), "{node}\n{stderr}");
        }
        match self.namespace {
            "" => assert_same(expected, &self.folder),
            namespace => assert_same_under(expected, &self.folder, namespace),
        }
    }
}

const SUBNET: [(&str, &str); 1] = [("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")];

/// One variable on every host.
fn by_multicast() -> BTreeMap<&'static str, [(&'static str, &'static str); 1]> {
    ["left", "right", "third"].map(|host| (host, SUBNET)).into()
}

#[test]
fn two_hosts_that_find_each_other_by_multicast_give_the_bytes_of_one() {
    let lab = Lab::new();
    let Some(hosts) = Hosts::new(&lab, &["left", "right"]) else { return };
    let scene = golden("scenes/tiny.toml");
    let expected = lab.launch(&scene, &[]);
    let run = Run::start(&hosts, &lab, ("both", ""), (&scene, MEASURED_ELSEWHERE), &by_multicast());
    run.finish_as(&expected);
}

#[test]
fn two_hosts_without_multicast_find_each_other_as_static_peers() {
    let lab = Lab::new();
    let Some(hosts) = Hosts::new(&lab, &["left", "right"]) else { return };
    for host in ["left", "right"] {
        hosts.set(&format!("ip -n {host} link set eth0 multicast off"));
        // The switch drops what is sent all the same.
        hosts.set(&format!("bridge link set dev to-{host} mcast_flood off"));
    }
    let scene = golden("scenes/tiny.toml");
    let expected = lab.launch(&scene, &[]);
    let peers = [
        ("left", [("ROS_STATIC_PEERS", "192.0.2.2")]),
        ("right", [("ROS_STATIC_PEERS", "192.0.2.77;192.0.2.1")]),
    ];
    let run = Run::start(&hosts, &lab, ("both", ""), (&scene, DRIVEN_FROM_ELSEWHERE), &peers.into());
    run.finish_as(&expected);
}

#[test]
fn a_host_with_static_peers_and_one_that_multicasts_exchange_data() {
    let lab = Lab::new();
    let Some(hosts) = Hosts::new(&lab, &["left", "right"]) else { return };
    let scene = golden("scenes/tiny.toml");
    let expected = lab.launch(&scene, &[]);
    let ranges = [("left", [("ROS_STATIC_PEERS", "192.0.2.2")]), ("right", SUBNET)];
    let run = Run::start(&hosts, &lab, ("both", ""), (&scene, DRIVEN_FROM_ELSEWHERE), &ranges.into());
    run.finish_as(&expected);
}

#[test]
fn a_link_that_is_cut_for_a_while_changes_no_byte() {
    // More exchanges than the scene has, so that the run is under way for a while.
    let text = std::fs::read_to_string(golden("scenes/tiny.toml")).unwrap();
    let text = text.replace("control_period = 10\n", "control_period = 2\n");
    let cuts = [
        ("ip -n right link set eth0 down", "ip -n right link set eth0 up"),
        ("ip link set to-right down", "ip link set to-right up"),
        // Datagrams are lost, and neither host is told.
        ("bridge link set dev to-right state 0", "bridge link set dev to-right state 3"),
    ];
    let first = Lab::new();
    let scene = first.folder().join("long.toml");
    std::fs::write(&scene, text).unwrap();
    let Some(_) = Hosts::new(&first, &["left", "right"]) else { return };
    let expected = first.launch(&scene, &[]);
    let exchanges = distinct(&expected, "/stress").len();
    for (cut, restore) in cuts {
        let lab = Lab::new();
        let Some(hosts) = Hosts::new(&lab, &["left", "right"]) else { return };
        let places = (scene.as_path(), DRIVEN_FROM_ELSEWHERE);
        let mut run = Run::start(&hosts, &lab, ("both", ""), places, &by_multicast());
        run.until_recorded("/stress", 100);
        hosts.set(cut);
        std::thread::sleep(Duration::from_secs(5));
        let recorded = distinct(&run.folder, "/stress").len();
        assert!(recorded < exchanges, "{cut}: the run was over");
        hosts.set(restore);
        run.finish_as(&expected);
    }
}

#[test]
fn two_laboratories_of_one_domain_on_three_hosts_come_to_their_own_results() {
    let lab = Lab::new();
    let Some(hosts) = Hosts::new(&lab, &["left", "right", "third"]) else { return };
    let scene = golden("scenes/tiny.toml");
    let other = lab.folder().join("other.toml");
    let text = std::fs::read_to_string(&scene).unwrap();
    std::fs::write(&other, text.replace("seed = 3\n", "seed = 4\n")).unwrap();
    let expected = [&scene, &other].map(|scene| lab.launch(scene, &[]));
    let shared = |own: &'static str| {
        [
            ("recorder", own),
            ("emt_inversion", "third"),
            ("fabric_analyzer", "third"),
            ("servo_controller", "third"),
            ("dem_simulator", own),
        ]
    };
    let start = |name: &'static str, namespace, scene: &Path| {
        Run::start(&hosts, &lab, (name, namespace), (scene, shared(name)), &by_multicast())
    };
    let runs = [start("left", "/left", &scene), start("right", "/right", &other)];
    for (run, expected) in runs.into_iter().zip(&expected) {
        run.finish_as(expected);
    }
}

const README: &str = include_str!("../../../nodes/README.md");

/// A block of the recipe for WireGuard: that of the first host, with the addresses of the second one as its peer's.
fn recipe(language: &str, number: usize) -> &'static str {
    let section = README.split_once("## An encrypted network\n").unwrap().1;
    let fence = format!("```{language}\n");
    section.split(&fence).nth(number).and_then(|block| block.split("```").next()).unwrap()
}

/// The hosts `left` and `right` with the tunnel of the recipe. A kernel without WireGuard uses wireguard-go, which ends
/// with its interface.
struct Tunnel<'a>(&'a Hosts);

impl<'a> Tunnel<'a> {
    /// `None`, with a message, without WireGuard's programs.
    fn new(hosts: &'a Hosts, lab: &Lab) -> Option<Self> {
        let installed =
            |program| Command::new(program).arg("--version").output().is_ok_and(|o| o.status.success());
        if !["wg", "wireguard-go"].into_iter().all(installed) || !Path::new("/dev/net/tun").exists() {
            python::say_skipped("no wg, wireguard-go or /dev/net/tun");
            return None;
        }
        let run = |host: &str, script: &str| {
            std::fs::create_dir_all(lab.folder().join(host)).unwrap();
            let script = format!("cd {host}\n{script}");
            let ended =
                Process::start(&mut hosts.on(host, Command::new("sh").args(["-ec", &script]))).ended(LIMIT);
            assert_eq!(ended.code, Some(0), "{script}\n{}", ended.stderr);
            ended.stdout.trim().to_owned()
        };
        let public = ["left", "right"].map(|host| run(host, recipe("sh", 1)));
        for (host, own, other) in [("left", 1, 2), ("right", 2, 1)] {
            let private = std::fs::read_to_string(lab.folder().join(host).join("wg0.key")).unwrap();
            let config = recipe("ini", 1)
                .replace("PRIVATE_KEY_OF_THIS_HOST", private.trim())
                .replace("PUBLIC_KEY_OF_THE_OTHER_HOST", &public[other - 1])
                .replace("192.0.2.2", &format!("192.0.2.{other}"))
                .replace("10.9.0.2", &format!("10.9.0.{other}"));
            std::fs::write(lab.folder().join(host).join("wg0.conf"), config).unwrap();
            let up = recipe("sh", 2).replace("10.9.0.1", &format!("10.9.0.{own}"));
            // The hosts share /run, where wireguard-go has its socket, and it keeps what it inherits open.
            run(
                host,
                &format!("mkdir -p /run/wireguard; mount -t tmpfs none /run/wireguard\n{{ {up} }} >up 2>&1"),
            );
        }
        Some(Self(hosts))
    }
}

impl Drop for Tunnel<'_> {
    fn drop(&mut self) {
        for host in ["left", "right"] {
            let mut command = Command::new("ip");
            let _ = self.0.on(host, command.args(["link", "delete", "wg0"])).output();
        }
    }
}

/// Frames of the other two hosts that the third one hears meanwhile.
fn overheard(hosts: &Hosts, meanwhile: impl FnOnce()) -> Option<serde_json::Value> {
    let python = python::with("socket")?;
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tools/eavesdrop.py");
    let listener = Process::start(&mut hosts.on("third", Command::new(python).args([script, "eth0"])));
    until("the third host listens", || handles(listener.pid(), libc::SIGTERM));
    let begin = Instant::now();
    meanwhile();
    listener.signal(libc::SIGTERM);
    let Ended { code, stdout, stderr } = listener.ended(LIMIT);
    assert_eq!(code, Some(0), "{stderr}");
    eprintln!("{:.1?}: {stdout}", begin.elapsed());
    Some(serde_json::from_str(&stdout).unwrap())
}

#[test]
fn over_wireguard_two_hosts_give_the_bytes_of_one_and_a_third_reads_nothing() {
    let lab = Lab::new();
    let Some(hosts) = Hosts::new(&lab, &["left", "right", "third"]) else { return };
    // A switch that forgets at once sends every frame to every host.
    hosts.set("ip link set switch type bridge ageing_time 0");
    let Some(tunnel) = Tunnel::new(&hosts, &lab) else { return };
    let scene = golden("scenes/tiny.toml");
    let expected = lab.launch(&scene, &[]);
    let run = |interface, peers: [&'static str; 2]| {
        let variables = |peer| [("ROS_STATIC_PEERS", peer), ("GRAINLAB_INTERFACE", interface)];
        let variables = [("left", variables(peers[0])), ("right", variables(peers[1]))].into();
        Run::start(&hosts, &lab, (interface, ""), (&scene, DRIVEN_FROM_ELSEWHERE), &variables)
            .finish_as(&expected);
    };
    let inside = ["10.9.0.2", "10.9.0.1"];
    let Some(heard) = overheard(&hosts, || run("wg0", inside)) else { return };
    assert!(heard["wireguard"].as_u64() > Some(1000), "{heard}");
    assert_eq!((heard["clear"].as_u64(), &heard["others"]), (Some(0), &serde_json::json!([])), "{heard}");

    // Without the variable the addresses outside the tunnel are announced, too.
    let node = |host, peer, interface| {
        let mut command = hosts.on(host, &lab.command(&["run", "fabric_analyzer"]));
        Process::start(command.env("ROS_STATIC_PEERS", peer).env("GRAINLAB_INTERFACE", interface))
    };
    let heard = overheard(&hosts, || {
        let _nodes = [node("left", inside[0], ""), node("right", inside[1], "")];
        std::thread::sleep(Duration::from_secs(5));
    });
    assert!(heard.as_ref().unwrap()["clear"].as_u64() > Some(0), "{heard:?}");

    // A tunnel that is down is an error, and nothing goes around it.
    drop(tunnel);
    let refused = node("left", inside[0], "wg0").ended(LIMIT);
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    assert!(refused.stderr.contains("GRAINLAB_INTERFACE=\"wg0\""), "{}", refused.stderr);

    let heard = overheard(&hosts, || run("eth0", ["192.0.2.2", "192.0.2.1"])).unwrap();
    assert!(heard["clear"].as_u64() > Some(1000) && heard["wireguard"] == 0, "{heard}");
}
