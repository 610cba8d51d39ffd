//! One laboratory over several hosts: the same bytes as on one. On one host it needs only loopback, sends only to loopback, and
//! receives only from loopback.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};
use system_tests::bodies::{assert_same_under, distinct, recorded};
use system_tests::hosts::{self, Hosts};
use system_tests::lab::{Lab, example, golden, grainlab, undisturbed};
use system_tests::process::{Ended, Process, handles};
use system_tests::python;
use system_tests::wait::{LIMIT, until};

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

    /// Waits until so many messages of a topic are recorded.
    fn until_recorded(&mut self, topic: &str, messages: usize) {
        let begin = Instant::now();
        let name = format!("{}{topic}", self.namespace);
        while recorded(&self.folder, &name) < messages {
            let ended = self.nodes.iter_mut().find_map(|(node, process)| (!process.runs()).then_some(*node));
            if ended.is_some() || begin.elapsed() > LIMIT / 2 {
                let recorded = recorded(&self.folder, &name);
                let outputs = self.end();
                panic!("{recorded} of {messages} of {name}; ended by itself: {ended:?}\n{outputs:#?}");
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
        assert_same_under(expected, &self.folder, self.namespace);
    }
}

const SUBNET: [(&str, &str); 1] = [("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")];

/// One variable on every host.
fn by_multicast() -> BTreeMap<&'static str, [(&'static str, &'static str); 1]> {
    ["left", "right", "third"].map(|host| (host, SUBNET)).into()
}

/// Runs the small scene over the hosts `left` and `right`, and expects the bytes of one host.
fn two_hosts<const N: usize>(prepare: impl Fn(&Hosts), places: Places, variables: [[(&str, &str); N]; 2]) {
    let lab = Lab::new();
    let Some(hosts) = Hosts::new(&lab, &["left", "right"]) else { return };
    prepare(&hosts);
    let scene = golden("scenes/tiny.toml");
    let [left, right] = variables;
    let variables = [("left", left), ("right", right)].into();
    Run::start(&hosts, &lab, ("both", ""), (&scene, places), &variables).finish_as(&undisturbed(&[]));
}

#[test]
fn two_hosts_that_find_each_other_by_multicast_give_the_bytes_of_one() {
    two_hosts(|_| {}, MEASURED_ELSEWHERE, [SUBNET, SUBNET]);
}

#[test]
fn two_hosts_without_multicast_find_each_other_as_static_peers() {
    let without_multicast = |hosts: &Hosts| {
        for host in ["left", "right"] {
            hosts.set(&format!("ip -n {host} link set eth0 multicast off"));
            // The switch drops what is sent all the same.
            hosts.set(&format!("bridge link set dev to-{host} mcast_flood off"));
        }
    };
    let peers = ["192.0.2.2", "192.0.2.77;192.0.2.1"].map(|peers| [("ROS_STATIC_PEERS", peers)]);
    two_hosts(without_multicast, DRIVEN_FROM_ELSEWHERE, peers);
}

#[test]
fn a_host_with_static_peers_and_one_that_multicasts_exchange_data() {
    two_hosts(|_| {}, DRIVEN_FROM_ELSEWHERE, [[("ROS_STATIC_PEERS", "192.0.2.2")], SUBNET]);
}

#[test]
fn a_link_that_is_cut_for_a_while_changes_no_byte() {
    let cuts = [
        ("ip -n right link set eth0 down", "ip -n right link set eth0 up"),
        ("ip link set to-right down", "ip link set to-right up"),
        // Datagrams are lost, and neither host is told.
        ("bridge link set dev to-right state 0", "bridge link set dev to-right state 3"),
    ];
    if !hosts::can_isolate() {
        return;
    }
    // More exchanges than the scene has, so that the run is under way for a while.
    let first = Lab::new();
    let scene = first.tiny_with("long.toml", &[("control_period = 10\n", "control_period = 2\n")]);
    let expected = first.launch(&scene, &[]);
    let exchanges = distinct(&expected, "/stress").len();
    let lab = Lab::new();
    let Some(hosts) = Hosts::new(&lab, &["left", "right"]) else { return };
    let places = (scene.as_path(), DRIVEN_FROM_ELSEWHERE);
    let mut run = Run::start(&hosts, &lab, ("both", ""), places, &by_multicast());
    for (cut, restore) in cuts {
        let begun = recorded(&run.folder, "/stress");
        run.until_recorded("/stress", begun + 100);
        hosts.set(cut);
        std::thread::sleep(Duration::from_secs(5));
        let done = distinct(&run.folder, "/stress").len();
        assert!(done < exchanges, "{cut}: the run was over");
        hosts.set(restore);
    }
    run.finish_as(&expected);
}

#[test]
fn two_laboratories_of_one_domain_on_three_hosts_come_to_their_own_results() {
    let lab = Lab::new();
    let Some(hosts) = Hosts::new(&lab, &["left", "right", "third"]) else { return };
    let scene = golden("scenes/tiny.toml");
    let other = lab.tiny_with("other.toml", &[("seed = 3\n", "seed = 4\n")]);
    let expected = [undisturbed(&[]), undisturbed(&["--seed", "4"])];
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
            let ended = Process::start(&mut hosts.on(host, Command::new("sh").args(["-ec", &script])));
            ended.ended(LIMIT).assert_code(0).stdout.trim().to_owned()
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
    let heard = listener.ended_by(libc::SIGTERM).assert_code(0).json();
    eprintln!("{:.1?}: {heard}", begin.elapsed());
    Some(heard)
}

#[test]
fn over_wireguard_two_hosts_give_the_bytes_of_one_and_a_third_reads_nothing() {
    let lab = Lab::new();
    let Some(hosts) = Hosts::new(&lab, &["left", "right", "third"]) else { return };
    // A switch that forgets at once sends every frame to every host.
    hosts.set("ip link set switch type bridge ageing_time 0");
    let Some(tunnel) = Tunnel::new(&hosts, &lab) else { return };
    let scene = golden("scenes/tiny.toml");
    // Not while somebody listens.
    let expected = undisturbed(&[]);
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
    node("left", inside[0], "wg0").ended(LIMIT).assert_code(2).assert_says(&["GRAINLAB_INTERFACE=\"wg0\""]);

    let heard = overheard(&hosts, || run("eth0", ["192.0.2.2", "192.0.2.1"])).unwrap();
    assert!(heard["clear"].as_u64() > Some(1000) && heard["wireguard"] == 0, "{heard}");
}

/// Runs a shell script in a separate network namespace, with the binary as `$0`, the small scene as `$1` and
/// the sender of [`SPRAYS`] datagrams as `$2`; `None`, with a message, without the right to create one.
fn in_namespace(lab: &Lab, script: &str) -> Option<Ended> {
    if !hosts::can_isolate() {
        return None;
    }
    let mut command = Command::new("unshare");
    command
        .args(["-n", "sh", "-ec", script])
        .arg(grainlab())
        .arg(golden("scenes/tiny.toml"))
        .arg(example("spray"))
        .arg(SPRAYS.to_string())
        .current_dir(lab.folder())
        .env("NO_COLOR", "1");
    Some(Process::start(&mut command).ended(LIMIT))
}

#[test]
fn a_run_works_where_only_loopback_exists_and_no_packet_leaves_it_for_another_default_route() {
    let lab = Lab::new();
    let script = r#"
        ip link set lo up
        "$0" launch --scene "$1" --out alone >&2
        ip link add away0 type veth peer name away1
        for i in away0 away1; do sysctl -qw net.ipv6.conf.$i.disable_ipv6=1; done
        ip addr add 192.0.2.1/24 dev away0
        ip link set away0 up
        ip link set away1 up
        ip route add default dev away0
        "$0" launch --scene "$1" >&2
        ip -s link show away0"#;
    let Some(ended) = in_namespace(&lab, script).map(|ended| ended.assert_code(0)) else { return };
    let sent = ended.stdout.lines().skip_while(|l| !l.contains("TX:")).nth(1).unwrap_or("").trim();
    assert!(
        sent.starts_with("0 "),
        "bytes and packets sent on the other interface: {sent}\n{}",
        ended.stdout
    );
}

/// Another host, by the name of its interface on this host, that sends to every port of domain 0. Prints the
/// counters of this namespace and the memory of a node before and after. `RANGE` is the discovery range of
/// the node, `LO` a setting of loopback.
const SPRAYED: &str = "
    ip link set lo up $LO
    unshare -n sleep 600 & peer=$!
    trap 'kill $peer $node' EXIT
    until [ \"$(readlink /proc/$peer/ns/net)\" != \"$(readlink /proc/$$/ns/net)\" ]; do sleep .1; done
    ip link add here type veth peer name there
    ip link set there netns $peer
    ip addr add 192.0.2.1/24 dev here
    ip link set here up
    nsenter -t $peer -n sh -ec 'ip addr add 192.0.2.2/24 dev there; ip link set there up; ip route add default dev there'
    ROS_DOMAIN_ID=0 ROS_AUTOMATIC_DISCOVERY_RANGE=$RANGE \"$0\" run emt_inversion >&2 & node=$!
    until ss -lun | grep -q :7411; do sleep .1; done
    memory() { grep VmRSS /proc/$node/status; }
    until [ \"$before\" = \"$(memory)\" ]; do before=$(memory); sleep 1; done
    count() { grep '^Udp: [0-9]' /proc/net/snmp; memory; }
    count
    nsenter -t $peer -n \"$2\" \"$3\" >&2
    sleep 1
    until [ -z \"$(ss -lunH | awk '$2 > 0')\" ]; do sleep .1; done
    count
    kill -0 $node";

/// Datagrams that reached a socket, that reached none, and memory growth of the node in MB.
fn sprayed(range: &str, lo: &str) -> Option<[u64; 3]> {
    let lab = Lab::new();
    let ended =
        in_namespace(&lab, &format!("RANGE={range} LO='{lo}' node= before=; {SPRAYED}"))?.assert_code(0);
    let column = |n: usize, what: &str| -> Vec<u64> {
        let lines = ended.stdout.lines().filter(|l| l.starts_with(what));
        lines.map(|l| l.split_whitespace().nth(n).and_then(|v| v.parse().ok()).unwrap_or(0)).collect()
    };
    let grown = |n, what: &str| match column(n, what)[..] {
        [before, after] => after.saturating_sub(before),
        _ => panic!("no two counts of {what}: {}", ended.stdout),
    };
    Some([grown(1, "Udp:"), grown(2, "Udp:"), grown(1, "VmRSS:") / 1024])
}

#[test]
fn nothing_from_another_host_reaches_a_node_that_stays_on_this_one() {
    for lo in ["multicast off", "multicast on"] {
        let Some([reached, refused, grown]) = sprayed("LOCALHOST", lo) else { return };
        // Half of them are sent to the multicast group, which this host has not joined there, and are not
        // counted.
        assert!(refused > SPRAYS / 4, "only {refused} datagrams came, loopback {lo}");
        assert!(reached < 100, "{reached} datagrams of {SPRAYS} reached a socket, loopback {lo}");
        assert!(grown < 10, "the node grew by {grown} MB, loopback {lo}");
    }
}

#[test]
fn a_flood_from_another_host_does_not_exhaust_the_memory_of_a_node_that_receives_it() {
    let Some([reached, _, grown]) = sprayed("SUBNET", "multicast off") else { return };
    assert!(reached > SPRAYS / 200, "only {reached} datagrams of {SPRAYS} came");
    assert!(grown < 60, "the node grew by {grown} MB");
}

/// Datagrams that are sent to the ports of a domain.
const SPRAYS: u64 = 50_000;
