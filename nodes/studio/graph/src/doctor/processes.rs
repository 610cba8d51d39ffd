//! Processes of a domain that are stopped. Discovery does not show them to a process that starts later.

use super::finding::Finding;
use grainlab_node_kit::processes::{Status, pids, sockets_of, udp_sockets};
use std::collections::BTreeSet;

/// The first port of a domain (RTPS 9.6.2.3).
pub(super) fn first_port(domain: u16) -> u16 {
    7400 + 250 * domain
}

/// Findings about stopped processes of this host that hold a UDP port of the domain.
pub(super) fn stopped(domain: u16) -> Vec<Finding> {
    let first = first_port(domain);
    let ports = first..=first.saturating_add(249);
    let sockets = udp_sockets().into_iter().filter(|socket| ports.contains(&socket.port));
    let inodes: BTreeSet<u64> = sockets.map(|socket| socket.inode).collect();
    let found = pids().filter_map(|pid| {
        let Status { name, .. } = Status::of(pid).filter(Status::is_stopped)?;
        sockets_of(pid).any(|inode| inodes.contains(&inode)).then(|| {
            Finding::error(
                "stopped_process",
                format!("process {pid} ({name}) takes part in domain {domain} and is stopped"),
                format!("continue it (fg in its shell, or kill -CONT {pid}), or end it"),
            )
        })
    });
    found.collect()
}
