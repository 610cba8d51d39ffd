//! Processes of this host and the UDP ports that they listen on: the owner of a participant of any vendor.

use crate::admission::Process;
use grainlab_console::escape_name;
use std::fs;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::os::unix::fs::MetadataExt;

/// Maximum number of ancestors that are checked, more than any chain of launchers and shells has.
const GENERATIONS: usize = 32;

/// A UDP socket of this host.
#[derive(Clone, Copy, Debug)]
pub struct UdpEntry {
    ip: Ipv4Addr,
    /// Port that it is bound to.
    pub port: u16,
    user: u32,
    /// Inode, which is in the links of its owner; see [`sockets_of`].
    pub inode: u64,
}

/// Returns the UDP sockets of this host.
pub fn udp_sockets() -> Vec<UdpEntry> {
    // A line for each: number, local address in hexadecimal digits of the memory, …, user in the eighth column, inode in the tenth.
    let text = fs::read_to_string("/proc/net/udp").unwrap_or_default();
    let entry = |line: &str| {
        let columns: Vec<&str> = line.split_whitespace().collect();
        let (ip, port) = columns.get(1)?.split_once(':')?;
        Some(UdpEntry {
            ip: Ipv4Addr::from(u32::from_str_radix(ip, 16).ok()?.to_ne_bytes()),
            port: u16::from_str_radix(port, 16).ok()?,
            user: columns.get(7)?.parse().ok()?,
            inode: columns.get(9)?.parse().ok()?,
        })
    };
    text.lines().skip(1).filter_map(entry).collect()
}

/// Returns the ids of all processes of this host.
pub fn pids() -> impl Iterator<Item = u32> {
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok())
}

/// Returns the inodes of the sockets that a process holds; none of a process of another user.
pub fn sockets_of(pid: u32) -> impl Iterator<Item = u64> {
    let descriptors = fs::read_dir(format!("/proc/{pid}/fd")).into_iter().flatten().flatten();
    descriptors.filter_map(|fd| {
        let link = fs::read_link(fd.path()).ok()?;
        link.to_str()?.strip_prefix("socket:[")?.strip_suffix(']')?.parse().ok()
    })
}

/// Name, state and parent of a process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    /// Name as one line of text. A process chooses its name, which may hold any bytes.
    pub name: String,
    state: char,
    parent: u32,
}

impl Status {
    /// Reads the status of a process; `None` if there is no such process.
    pub fn of(pid: u32) -> Option<Self> {
        let stat = fs::read(format!("/proc/{pid}/stat")).ok()?;
        let stat = String::from_utf8_lossy(&stat);
        // The name in brackets may contain spaces and brackets.
        let (before, behind) = stat.rsplit_once(')')?;
        let mut fields = behind.split_whitespace();
        Some(Self {
            name: escape_name(before.split_once('(')?.1).into_owned(),
            state: fields.next()?.chars().next()?,
            parent: fields.next()?.parse().ok()?,
        })
    }

    /// True if a signal (T) or a debugger (t) stopped the process.
    pub fn is_stopped(&self) -> bool {
        matches!(self.state, 'T' | 't')
    }
}

/// The process that listens on these addresses of one participant, and whether it descends from `root`; `None` if it is
/// on another host, or belongs to another user.
pub(crate) fn listening_on(addresses: &[SocketAddr], root: Option<u32>) -> Option<Process> {
    // Another host announces its loopback address, too, and the same port.
    if !addresses.iter().all(|a| is_local(a.ip())) {
        return None;
    }
    let sockets = udp_sockets();
    let inode = addresses.iter().find_map(|a| sockets.iter().rfind(|s| s.port == a.port()))?.inode;
    let pid = pids().find(|pid| sockets_of(*pid).any(|held| held == inode))?;
    let name = Status::of(pid).map(|status| status.name).unwrap_or_default();
    Some(Process { pid, name, below_root: root.is_some_and(|root| is_below(pid, root)) })
}

/// True if processes of other users alone, root excepted, listen on these addresses of one participant. False if it is on
/// another host.
pub(crate) fn of_another_user(addresses: &[SocketAddr]) -> bool {
    let Ok(own) = fs::metadata("/proc/self") else { return false };
    let listens =
        |s: &UdpEntry, a: &SocketAddr| a.port() == s.port && (s.ip.is_unspecified() || a.ip() == s.ip);
    let mut sockets = udp_sockets();
    sockets.retain(|socket| addresses.iter().any(|address| listens(socket, address)));
    let is_trusted = |socket: &UdpEntry| [0, own.uid()].contains(&socket.user);
    !sockets.is_empty() && !sockets.iter().any(is_trusted) && addresses.iter().all(|a| is_local(a.ip()))
}

/// Only an address of this host can be bound.
fn is_local(ip: IpAddr) -> bool {
    ip.is_loopback() || UdpSocket::bind((ip, 0)).is_ok()
}

fn is_below(pid: u32, root: u32) -> bool {
    let parent = |pid: &u32| Status::of(*pid).map(|status| status.parent).filter(|parent| *parent > 0);
    std::iter::successors(Some(pid), parent).take(GENERATIONS).any(|ancestor| ancestor == root)
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
        let parent = Status::of(own).unwrap().parent;
        assert!(listening_on(&[address], Some(parent)).unwrap().below_root);
        assert!(!listening_on(&[address], None).unwrap().below_root);
        drop(socket);
        assert_eq!(listening_on(&[address], None), None);
    }

    #[test]
    fn a_process_cannot_name_itself_by_an_escape_sequence_or_hide_its_state_by_other_bytes() {
        let script = r"printf '\033[31m)\377' > /proc/$$/comm; echo named; read end";
        let mut shell = std::process::Command::new("sh");
        let pipes = shell.args(["-c", script]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = pipes.spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        // SAFETY: kill takes two integers. The child was not waited for, so the id is its own.
        assert_eq!(unsafe { libc::kill(child.id() as i32, libc::SIGSTOP) }, 0);
        std::thread::sleep(std::time::Duration::from_millis(100));
        let found = Status::of(child.id()).unwrap();
        assert_eq!((found.name.as_str(), found.parent), ("\\u{1b}[31m)\u{fffd}", std::process::id()));
        assert!(found.is_stopped());
        // SAFETY: as above.
        assert_eq!(unsafe { libc::kill(child.id() as i32, libc::SIGCONT) }, 0);
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
