//! Memory that a process can have, and memory that its allocator keeps.

use crate::Failure;
use std::fs;

#[cfg(all(target_os = "linux", target_env = "gnu"))]
const HEAPS: libc::c_int = 2;

/// Allocations of this size, and free memory of this size at the end of a heap, return to the system when freed, bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const RETURNED: libc::c_int = 1 << 20;

/// Bounds what the allocator keeps for itself: with a heap for each thread, a process that runs for days grows by the
/// largest backlog of each of its DDS threads. Other allocators keep their settings.
pub fn bound() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    for (setting, value) in
        [(libc::M_ARENA_MAX, HEAPS), (libc::M_TRIM_THRESHOLD, RETURNED), (libc::M_MMAP_THRESHOLD, RETURNED)]
    {
        // SAFETY: mallopt takes two integers; no other thread runs yet. Failure leaves the default, which is correct.
        unsafe { libc::mallopt(setting, value) };
    }
}

/// Refuses what needs more memory, bytes, than this process can have; `subject` begins the message, with its verb to follow.
///
/// # Errors
/// If the need is beyond memory and swap of the machine, the limit of the control group, or the one of the address space.
pub fn require(bytes: f64, subject: &str) -> Result<(), Failure> {
    match most() {
        Some(most) if bytes > most => Err(Failure::failed(format!(
            "{subject} at least {} of memory, and this process can have {}",
            gigabytes(bytes),
            gigabytes(most)
        ))),
        _ => Ok(()),
    }
}

fn gigabytes(bytes: f64) -> String {
    format!("{:.3} GB", 1e-9 * bytes)
}

/// Returns the largest memory of this process, bytes; `None` where the system does not say.
fn most() -> Option<f64> {
    let read = |path: &str| fs::read_to_string(path).unwrap_or_default();
    let groups = read("/proc/self/cgroup");
    let limits = groups.lines().filter_map(group_limit).map(|path| read(&path));
    let limits = limits.filter_map(|text| text.trim().parse().ok());
    [of_machine(&read("/proc/meminfo")), of_process(&read("/proc/self/limits"))]
        .into_iter()
        .flatten()
        .chain(limits)
        .reduce(f64::min)
}

/// Memory and swap, bytes, in the text of `/proc/meminfo`.
fn of_machine(text: &str) -> Option<f64> {
    let of = |name: &str| -> Option<f64> {
        text.lines().find_map(|line| line.strip_prefix(name)?.split_whitespace().next()?.parse().ok())
    };
    Some(1024.0 * (of("MemTotal:")? + of("SwapTotal:").unwrap_or(0.0)))
}

/// Address space, bytes, in the text of `/proc/self/limits`; `None` if it is unlimited.
fn of_process(text: &str) -> Option<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// File with the limit of a group in a line of `/proc/self/cgroup`, of either version.
fn group_limit(line: &str) -> Option<String> {
    let mut parts = line.splitn(3, ':').skip(1);
    let (controllers, path) = (parts.next()?, parts.next()?);
    if controllers.is_empty() {
        Some(format!("/sys/fs/cgroup{path}/memory.max"))
    } else {
        let of_memory = controllers.split(',').any(|name| name == "memory");
        of_memory.then(|| format!("/sys/fs/cgroup/memory{path}/memory.limit_in_bytes"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_the_system_give_its_limits() {
        let machine = "MemTotal:       1000 kB\nMemFree:  1 kB\nSwapTotal:  24 kB\n";
        assert_eq!((of_machine(machine), of_machine("")), (Some(1024.0 * 1024.0), None));
        let limits = |soft: &str| {
            format!("Max cpu time   1  2 seconds\nMax address space   {soft}   unlimited   bytes\n")
        };
        assert_eq!((of_process(&limits("4096")), of_process(&limits("unlimited"))), (Some(4096.0), None));
        assert_eq!(group_limit("0::/user/a:b").unwrap(), "/sys/fs/cgroup/user/a:b/memory.max");
        assert_eq!(group_limit("4:memory:/x").unwrap(), "/sys/fs/cgroup/memory/x/memory.limit_in_bytes");
        assert_eq!(group_limit("8:pids:/x"), None);
    }

    #[test]
    fn more_memory_than_there_is_is_refused_with_both_numbers() {
        let error = require(1e18, "the copies take").unwrap_err().to_string();
        assert!(
            error.starts_with(
                "the copies take at least 1000000000.000 GB of memory, and this process can have"
            ),
            "{error}"
        );
        assert!(require(1.0, "").is_ok());
    }
}
