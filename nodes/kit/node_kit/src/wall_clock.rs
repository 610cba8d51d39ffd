//! The wall clock of this process, for stamps: it stands still where the clock of the host was set back.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

/// The latest time that any thread of this process was given, ns since 1970.
static LATEST: AtomicU64 = AtomicU64::new(0);

/// Wall-clock time, ns since 1970. No call returns less than one that ended before it began, in any thread.
pub(crate) fn wall_nanos() -> u64 {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_nanos() as u64);
    not_before(&LATEST, now)
}

/// `now`, or the latest time before it, if that is later.
fn not_before(latest: &AtomicU64, now: u64) -> u64 {
    latest.fetch_max(now, Ordering::AcqRel).max(now)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_is_set_back_stands_still_until_it_has_caught_up() {
        let latest = AtomicU64::new(0);
        let given = [5, 9, 3, 8, 10].map(|now| not_before(&latest, now));
        assert_eq!(given, [5, 9, 9, 9, 10]);
    }
}
