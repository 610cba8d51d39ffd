//! Free space of a file system.

use std::io;
use std::path::Path;

/// Free bytes for an ordinary user on the file system of `path`.
///
/// # Errors
/// If `path` does not exist or the call fails.
pub(crate) fn free_space(path: &Path) -> io::Result<u64> {
    let answer = rustix::fs::statvfs(path)?;
    Ok(answer.f_bavail.saturating_mul(answer.f_frsize))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_directory_is_an_error_and_a_real_one_has_room() {
        assert!(free_space(Path::new("/no/such/place")).is_err());
        assert!(free_space(&std::env::temp_dir()).unwrap() > 0);
    }
}
