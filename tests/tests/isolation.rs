//! The laboratory needs nothing but loopback, and uses nothing but loopback.

use std::process::Command;
use system_tests::lab::{LIMIT, Lab, golden, grainlab};
use system_tests::process::{Ended, Process};
use system_tests::python;

/// Runs a shell script in a network namespace of its own, with the binary as `$0` and the small scene as `$1`; `None`,
/// loudly, where there is no right to make one.
fn in_namespace(lab: &Lab, script: &str) -> Option<Ended> {
    let can = Command::new("unshare").args(["-n", "ip", "link"]).output().is_ok_and(|o| o.status.success());
    if !can {
        python::say_skipped("no right to make a network namespace here, or no `ip`");
        return None;
    }
    let mut command = Command::new("unshare");
    command
        .args(["-n", "sh", "-ec", script])
        .arg(grainlab())
        .arg(golden("scenes/tiny.toml"))
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
