//! Several hosts on one switch: network namespaces inside an outer one, so that no packet leaves them.

use crate::lab::Lab;
use crate::process::Process;
use crate::python;
use crate::wait::LIMIT;
use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, Instant};

/// Makes the switch and the hosts in `$*`, with the addresses 192.0.2.1 and following, and shows that they are ready by
/// the file `$0`. The names of namespaces are files under /run, which is separate here.
const NETWORK: &str = "
    mount -t tmpfs none /run
    ip link add switch type bridge
    ip link set switch up
    n=0
    for host in $*; do
        n=$((n + 1))
        ip netns add $host
        ip link add to-$host type veth peer name eth0 netns $host
        ip link set to-$host master switch up
        ip -n $host addr add 192.0.2.$n/24 dev eth0
        ip -n $host link set lo up
        ip -n $host link set eth0 up
    done
    touch \"$0\"
    exec sleep 600";

/// True if this process may make network namespaces; if not, the test says that it is skipped.
pub fn can_isolate() -> bool {
    let can = Command::new("unshare").args(["-n", "ip", "link"]).output().is_ok_and(|o| o.status.success());
    if !can {
        python::say_skipped("no right to make a network namespace here, or no `ip`");
    }
    can
}

/// Hosts with one network interface each, `eth0`, and one switch between them.
#[derive(Debug)]
pub struct Hosts {
    /// The process that keeps the outer namespace.
    keeper: Process,
    folder: PathBuf,
}

impl Hosts {
    /// Hosts with these names, the first with the address 192.0.2.1, the next 192.0.2.2 and so on. `None`, with a
    /// message, without the right to make namespaces.
    pub fn new(lab: &Lab, names: &[&str]) -> Option<Self> {
        if !can_isolate() {
            return None;
        }
        let ready = lab.folder().join("network_ready");
        let mut keeper = Command::new("unshare");
        keeper.args(["-n", "-m", "sh", "-ec", NETWORK]).arg(&ready).args(names);
        let mut hosts = Self { keeper: Process::start(&mut keeper), folder: lab.folder().into() };
        let begin = Instant::now();
        while !ready.exists() {
            assert!(hosts.keeper.runs() && begin.elapsed() < LIMIT, "no network of hosts {names:?}");
            std::thread::sleep(Duration::from_millis(10));
        }
        Some(hosts)
    }

    /// Runs a command of `ip` or `bridge`, as in `ip -n HOST link set eth0 down`. The ports of the switch are `to-HOST`.
    pub fn set(&self, command: &str) {
        let output = self.inside().args(command.split_whitespace()).output();
        let output = output.unwrap_or_else(|e| panic!("{command}: {e}"));
        assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    }

    /// Runs a command on one of the hosts, in the folder of the laboratory.
    pub fn on(&self, host: &str, command: &Command) -> Command {
        let mut there = self.inside();
        there.args(["ip", "netns", "exec", host]).arg(command.get_program()).args(command.get_args());
        for (name, value) in command.get_envs() {
            match value {
                Some(value) => there.env(name, value),
                None => there.env_remove(name),
            };
        }
        there
    }

    fn inside(&self) -> Command {
        let mut command = Command::new("nsenter");
        command
            .arg(format!("--target={}", self.keeper.pid()))
            .args(["--net", "--mount"])
            .arg(format!("--wd={}", self.folder.display()));
        command
    }
}
