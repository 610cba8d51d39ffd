//! Limits of a member on this machine.

use super::options::Options;
use grainlab_console::count;
use std::time::{Duration, Instant};

/// Time for a member at its time limit to save its state, before it is killed.
const SAVES_WITHIN: Duration = Duration::from_secs(30);

const MIB: u64 = 1 << 20;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Reached {
    pub(super) reason: String,
    pub(super) signal: i32,
}

pub(super) fn reached(options: &Options, pid: u32, began: Instant) -> Option<Reached> {
    let time = options.member_time.map(u64::from).filter(|t| began.elapsed() >= Duration::from_secs(*t));
    if let Some(seconds) = time {
        let late = began.elapsed() >= Duration::from_secs(seconds) + SAVES_WITHIN;
        let signal = if late { libc::SIGKILL } else { libc::SIGINT };
        let reason = format!("ended at the limit of {} (--member-time)", count(seconds as usize, "second"));
        return Some(Reached { reason, signal });
    }
    let limit = options.member_memory.map(u64::from)?;
    let used: u64 = family(pid).into_iter().map(resident).sum();
    let reason = format!("ended at {} MiB, over the limit of {limit} MiB (--member-memory)", used / MIB);
    (used > limit * MIB).then_some(Reached { reason, signal: libc::SIGKILL })
}

/// Sends a signal: SIGKILL to the process and all its descendants, another one to the process alone, which ends them in order.
pub(super) fn send(signal: i32, pid: u32) {
    let meant = if signal == libc::SIGKILL { family(pid) } else { vec![pid] };
    for pid in meant.into_iter().filter_map(|pid| i32::try_from(pid).ok()) {
        // SAFETY: kill takes two integers. The process is a child that was not waited for, or a descendant of it.
        unsafe { libc::kill(pid, signal) };
    }
}

/// A process and its descendants.
fn family(pid: u32) -> Vec<u32> {
    let path = format!("/proc/{pid}/task/{pid}/children");
    let children = std::fs::read_to_string(path).unwrap_or_default();
    let all = children.split_whitespace().filter_map(|child| child.parse().ok()).flat_map(family);
    std::iter::once(pid).chain(all).collect()
}

/// Resident memory of a process, bytes; 0 if it has ended.
fn resident(pid: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmRSS:"));
    let kib = line.and_then(|l| l.trim().strip_suffix("kB")).and_then(|l| l.trim().parse::<u64>().ok());
    kib.unwrap_or(0) * 1024
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_memory_of_a_member_contains_its_descendants() {
        let mut shell = std::process::Command::new("sh").args(["-c", "sleep 60 & wait"]).spawn().unwrap();
        let own = std::process::id();
        let until = Instant::now() + Duration::from_secs(10);
        while family(shell.id()).len() < 2 && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(10));
        }
        assert_eq!(family(shell.id()).len(), 2);
        assert!(resident(own) > 0);
        send(libc::SIGKILL, shell.id());
        assert!(!shell.wait().unwrap().success());
    }
}
