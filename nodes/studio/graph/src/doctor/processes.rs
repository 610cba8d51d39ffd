//! Processes of a domain that are stopped. Discovery does not show them to a process that starts later.

use super::finding::Finding;
use grainlab_console::escape_name;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// The first port of a domain (RTPS 9.6.2.3).
pub(super) fn first_port(domain: u16) -> u16 {
    7400 + 250 * domain
}

/// Findings about stopped processes of this host that hold a UDP port of the domain.
pub(super) fn stopped(domain: u16) -> Vec<Finding> {
    let (first, sockets) = (first_port(domain), udp_sockets());
    let ports = first..=first.saturating_add(249);
    let inodes: BTreeSet<_> =
        sockets.into_iter().filter(|(port, _)| ports.contains(port)).map(|(_, inode)| inode).collect();
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let found = processes.filter_map(|entry| {
        let pid: u32 = entry.file_name().to_str()?.parse().ok()?;
        let (name, state) =
            name_and_state(&String::from_utf8_lossy(&fs::read(entry.path().join("stat")).ok()?))?;
        let stopped = matches!(state, 'T' | 't') && holds_any(&entry.path(), &inodes);
        stopped.then(|| {
            Finding::error(
                "stopped_process",
                format!("process {pid} ({name}) takes part in domain {domain} and is stopped"),
                format!("continue it (fg in its shell, or kill -CONT {pid}), or end it"),
            )
        })
    });
    found.collect()
}

/// Ports of the UDP sockets of this host with their inodes: the second and the tenth column of `/proc/net/udp`.
pub(super) fn udp_sockets() -> Vec<(u16, String)> {
    let text = fs::read_to_string("/proc/net/udp").unwrap_or_default();
    let socket = |line: &str| {
        let columns: Vec<&str> = line.split_whitespace().collect();
        let (_, port) = columns.get(1)?.split_once(':')?;
        Some((u16::from_str_radix(port, 16).ok()?, (*columns.get(9)?).to_owned()))
    };
    text.lines().skip(1).filter_map(socket).collect()
}

fn holds_any(process: &Path, inodes: &BTreeSet<String>) -> bool {
    let descriptors = fs::read_dir(process.join("fd")).into_iter().flatten().flatten();
    let mut links = descriptors.filter_map(|fd| fs::read_link(fd.path()).ok()?.to_str().map(str::to_owned));
    links.any(|link| {
        let inode = link.strip_prefix("socket:[").and_then(|rest| rest.strip_suffix(']'));
        inode.is_some_and(|inode| inodes.contains(inode))
    })
}

/// From `/proc/PID/stat`; the name, in brackets, may contain spaces and brackets.
fn name_and_state(stat: &str) -> Option<(String, char)> {
    let (before, behind) = stat.rsplit_once(')')?;
    let (_, name) = before.split_once('(')?;
    Some((escape_name(name).into_owned(), behind.trim_start().chars().next()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_state_is_found_behind_any_name() {
        assert_eq!(name_and_state("12 (a b) c) T 1 1"), Some(("a b) c".into(), 'T')));
        assert_eq!(name_and_state("12"), None);
    }

    #[test]
    fn a_name_is_shown_without_what_a_terminal_obeys() {
        assert_eq!(name_and_state("12 (a\x1b[31m\nb) T 1 1"), Some((r"a\u{1b}[31m\nb".into(), 'T')));
    }
}
