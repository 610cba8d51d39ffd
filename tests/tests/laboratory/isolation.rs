//! The laboratory needs only loopback, sends only to loopback, and receives only from loopback.

use std::process::Command;
use system_tests::hosts;
use system_tests::lab::{LIMIT, Lab, example, golden, grainlab};
use system_tests::process::{Ended, Process};

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
fn the_main_job_works_where_only_loopback_exists() {
    let lab = Lab::new();
    let Some(ended) = in_namespace(&lab, "ip link set lo up; exec \"$0\" launch --scene \"$1\"") else {
        return;
    };
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
}

#[test]
fn no_packet_leaves_loopback_although_another_interface_has_the_default_route() {
    let lab = Lab::new();
    let script = "
        ip link set lo up
        ip link add away0 type veth peer name away1
        for i in away0 away1; do sysctl -qw net.ipv6.conf.$i.disable_ipv6=1; done
        ip addr add 192.0.2.1/24 dev away0
        ip link set away0 up
        ip link set away1 up
        ip route add default dev away0
        \"$0\" launch --scene \"$1\" >&2
        ip -s link show away0";
    let Some(ended) = in_namespace(&lab, script) else { return };
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
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
    sleep .3
    ip link add here type veth peer name there
    ip link set there netns $peer
    ip addr add 192.0.2.1/24 dev here
    ip link set here up
    nsenter -t $peer -n sh -ec 'ip addr add 192.0.2.2/24 dev there; ip link set there up; ip route add default dev there'
    ROS_DOMAIN_ID=0 ROS_AUTOMATIC_DISCOVERY_RANGE=$RANGE \"$0\" run emt_inversion >&2 & node=$!
    until ss -lun | grep -q :7411; do sleep .1; done
    sleep 2
    count() { grep '^Udp: [0-9]' /proc/net/snmp; grep VmRSS /proc/$node/status; }
    count
    nsenter -t $peer -n \"$2\" \"$3\" >&2
    sleep 1
    count
    kill -0 $node";

/// Datagrams that reached a socket, that reached none, and memory growth of the node in MB.
fn sprayed(range: &str, lo: &str) -> Option<[u64; 3]> {
    let lab = Lab::new();
    let ended = in_namespace(&lab, &format!("RANGE={range} LO='{lo}' node=; {SPRAYED}"))?;
    assert_eq!(ended.code, Some(0), "{}\n{}", ended.stdout, ended.stderr);
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
