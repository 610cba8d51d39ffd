//! Waiting for what another process does, for a limited time.

use std::time::{Duration, Instant};

/// Time limit of any command of a test.
pub const LIMIT: Duration = Duration::from_secs(120);

/// Waits until `holds`; the test fails with `what` after [`LIMIT`].
pub fn until(what: &str, holds: impl FnMut() -> bool) {
    until_within(LIMIT, what, holds);
}

/// Waits until `holds`; the test fails with `what` after `limit`.
pub fn until_within(limit: Duration, what: &str, mut holds: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(begin.elapsed() < limit, "within {limit:?}: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}
