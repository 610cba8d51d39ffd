//! Finds the process of this host that listens on a port: the owner of a participant of any vendor.

use crate::admission::Process;
use grainlab_console::escape_name;
use std::collections::BTreeMap;
use std::fs;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

/// Maximum number of ancestors that are checked, more than any chain of launchers and shells has.
const GENERATIONS: usize = 32;

/// The process that listens on these addresses of one participant, and whether it descends from `root`; `None` if it is
/// on another host, or belongs to another user.
pub(super) fn listening_on(addresses: &[SocketAddr], root: Option<u32>) -> Option<Process> {
    // Another host announces its loopback address, too, and the same port.
    if !addresses.iter().all(|a| is_local(a.ip())) {
        return None;
    }
    let inodes = inodes_by_port()?;
    let inode = addresses.iter().find_map(|a| inodes.get(&a.port()))?;
    let pid = owner_of(*inode)?;
    Some(Process { pid, name: name_of(pid), below_root: root.is_some_and(|root| is_below(pid, root)) })
}

/// True if processes of other users alone, root excepted, listen on these addresses of one participant. False if it is on
/// another host.
pub(super) fn of_another_user(addresses: &[SocketAddr]) -> bool {
    let (Ok(own), Ok(text)) = (fs::metadata("/proc/self"), fs::read_to_string("/proc/net/udp")) else {
        return false;
    };
    // The user is in the eighth column, the address in hexadecimal digits of the memory.
    let user = |line: &str| -> Option<u32> {
        let columns: Vec<&str> = line.split_whitespace().collect();
        let (ip, port) = columns.get(1)?.split_once(':')?;
        let ip = Ipv4Addr::from(u32::from_str_radix(ip, 16).ok()?.to_ne_bytes());
        let port = u16::from_str_radix(port, 16).ok()?;
        let listens = |a: &SocketAddr| a.port() == port && (ip.is_unspecified() || a.ip() == ip);
        columns.get(7).filter(|_| addresses.iter().any(listens))?.parse().ok()
    };
    let users: Vec<u32> = text.lines().skip(1).filter_map(user).collect();
    let trusted = |user: &u32| [0, own.uid()].contains(user);
    !users.is_empty() && !users.iter().any(trusted) && addresses.iter().all(|a| is_local(a.ip()))
}

/// Only an address of this host can be bound.
fn is_local(ip: IpAddr) -> bool {
    ip.is_loopback() || UdpSocket::bind((ip, 0)).is_ok()
}

/// Socket inodes of all UDP ports in use. `/proc/net/udp` has a line for each: number, local address, …, inode in the
/// tenth column.
fn inodes_by_port() -> Option<BTreeMap<u16, u64>> {
    let text = fs::read_to_string("/proc/net/udp").ok()?;
    let entry = |line: &str| {
        let columns: Vec<&str> = line.split_whitespace().collect();
        let (_, port) = columns.get(1)?.split_once(':')?;
        Some((u16::from_str_radix(port, 16).ok()?, columns.get(9)?.parse().ok()?))
    };
    Some(text.lines().skip(1).filter_map(entry).collect())
}

fn owner_of(inode: u64) -> Option<u32> {
    let link = format!("socket:[{inode}]");
    let holds = |directory: &Path| {
        let descriptors = fs::read_dir(directory.join("fd")).into_iter().flatten().flatten();
        descriptors
            .into_iter()
            .any(|fd| fs::read_link(fd.path()).is_ok_and(|l| l.as_os_str() == link.as_str()))
    };
    let processes = fs::read_dir("/proc").ok()?.flatten();
    processes
        .filter_map(|entry| Some((entry.file_name().to_str()?.parse().ok()?, entry.path())))
        .find(|(_, directory)| holds(directory))
        .map(|(pid, _)| pid)
}

fn is_below(pid: u32, root: u32) -> bool {
    let parents = std::iter::successors(Some(pid), |pid| parent_of(*pid));
    parents.take(GENERATIONS).any(|ancestor| ancestor == root)
}

/// Returns the name of a process as one line of text. A process chooses its name, which may hold any bytes.
fn name_of(pid: u32) -> String {
    let name = fs::read(format!("/proc/{pid}/comm")).unwrap_or_default();
    escape_name(String::from_utf8_lossy(&name).trim()).into_owned()
}

/// Returns the fourth field of `/proc/PID/stat`. The second field, the name, may hold any bytes.
fn parent_of(pid: u32) -> Option<u32> {
    let stat = fs::read(format!("/proc/{pid}/stat")).ok()?;
    let stat = String::from_utf8_lossy(&stat);
    let (_, behind_name) = stat.rsplit_once(')')?;
    behind_name.split_whitespace().nth(1)?.parse().ok().filter(|parent| *parent > 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;

    #[test]
    fn the_process_that_holds_a_socket_is_found_and_so_is_what_started_it() {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let address = socket.local_addr().unwrap();
        let own = std::process::id();
        let found = listening_on(&[address], Some(own)).unwrap();
        assert_eq!((found.pid, found.below_root), (own, true));
        let parent = parent_of(own).unwrap();
        assert!(listening_on(&[address], Some(parent)).unwrap().below_root);
        assert!(!listening_on(&[address], None).unwrap().below_root);
        drop(socket);
        assert_eq!(listening_on(&[address], None), None);
    }

    #[test]
    fn a_process_cannot_name_itself_by_an_escape_sequence_or_hide_its_parent_by_other_bytes() {
        let script = r"printf '\033[31m)\377' > /proc/$$/comm; echo named; read end";
        let mut shell = std::process::Command::new("sh");
        let pipes = shell.args(["-c", script]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = pipes.spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        assert_eq!(name_of(child.id()), "\\u{1b}[31m)\u{fffd}");
        assert_eq!(parent_of(child.id()), Some(std::process::id()));
        drop(child.stdin.take());
        child.wait().unwrap();
    }

    #[test]
    fn an_address_of_another_host_is_nobody_of_this_one() {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let elsewhere = SocketAddr::new("192.0.2.1".parse().unwrap(), socket.local_addr().unwrap().port());
        assert_eq!(listening_on(&[elsewhere], None), None);
        assert_eq!(listening_on(&[socket.local_addr().unwrap(), elsewhere], None), None);
    }
}
