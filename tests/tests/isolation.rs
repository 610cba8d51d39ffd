//! The laboratory needs only loopback, sends only to loopback, and receives only from loopback.

use std::net::UdpSocket;
use std::process::Command;
use std::time::Duration;
use system_tests::hosts;
use system_tests::lab::{LIMIT, Lab, golden, grainlab};
use system_tests::process::{Ended, Process};

/// Runs a shell script in a separate network namespace, with the binary as `$0`, the small scene as `$1` and
/// this test executable as `$2`; `None`, with a message, without the right to create one.
fn in_namespace(lab: &Lab, script: &str) -> Option<Ended> {
    if !hosts::can_isolate() {
        return None;
    }
    let mut command = Command::new("unshare");
    command
        .args(["-n", "sh", "-ec", script])
        .arg(grainlab())
        .arg(golden("scenes/tiny.toml"))
        .arg(std::env::current_exe().unwrap_or_default())
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
    nsenter -t $peer -n \"$2\" --exact spray --ignored >&2
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

/// The other host. Announcements of participants that do not exist, samples, fragments of samples of 2 GB, and garbage.
#[test]
#[ignore = "the sender, started by other tests in a namespace"]
fn spray() {
    let Ok(socket) = UdpSocket::bind("192.0.2.2:0") else { return };
    let packets = |i: u64| {
        let prefix = [&i.to_le_bytes()[..], &[9; 4]].concat();
        let start = [&b"RTPS\x02\x04\x01\x12"[..], &prefix].concat();
        let submessage = |kind: u8, flags: u8, body: &[u8]| {
            [&start[..], &[kind, flags], &(body.len() as u16).to_le_bytes(), body].concat()
        };
        let announcement = {
            let parameter = |id: u8, value: &[u8]| [&[id, 0, value.len() as u8, 0][..], value].concat();
            let guid = [&prefix[..], &[0, 0, 1, 0xc1]].concat();
            let payload = [
                &[0, 3, 0, 0][..],
                &parameter(0x15, &[2, 4, 0, 0]),
                &parameter(0x16, &[1, 0x12, 0, 0]),
                &parameter(0x50, &guid),
                &parameter(0x02, &[0xff, 0xff, 0xff, 0x7f, 0, 0, 0, 0]),
                &parameter(0x58, &[0x3f, 0x0c, 0, 0]),
                &[1, 0, 0, 0],
            ]
            .concat();
            let ids = [0, 0, 16, 0, 0, 1, 0, 0xc7, 0, 1, 0, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0];
            submessage(0x15, 5, &[&ids[..], &payload].concat())
        };
        let sample = {
            let ids = [0, 0, 16, 0, 0, 0, 0, 0, 0, 0, 1, 0xc3, 0, 0, 0, 0, 1, 0, 0, 0];
            submessage(0x15, 5, &[&ids[..], &[0, 1, 0, 0, 1, 2, 3, 4]].concat())
        };
        let fragment = {
            let ids = [0, 0, 28, 0, 0, 0, 0, 0, 0, 0, 1, 0xc3, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];
            let sizes = [1, 0, 0, 1, 0, 0, 0, 0x80];
            submessage(0x16, 1, &[&ids[..], &sizes, &[0; 256]].concat())
        };
        [announcement, sample, fragment, vec![0x5a; 200]]
    };
    for i in 0..SPRAYS / 8 {
        // The well-known ports more often than the others.
        let port =
            if i % 2 == 0 { 7400 + [0, 1, 10, 11][i as usize / 2 % 4] } else { 7400 + (i / 2 % 250) as u16 };
        for packet in packets(i) {
            for host in ["192.0.2.1", "239.255.0.1"] {
                // Errors of earlier sends are reported here.
                let _ = socket.send_to(&packet, (host, port));
            }
        }
        if i % 20 == 0 {
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}
