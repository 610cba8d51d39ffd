//! Free space of a file system.

use std::ffi::CString;
use std::io;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

/// Free bytes for an ordinary user on the file system of `path`.
///
/// # Errors
/// If `path` does not exist or the call fails.
pub(crate) fn free_space(path: &Path) -> io::Result<u64> {
    let name = CString::new(path.as_os_str().as_bytes())?;
    let mut answer = std::mem::MaybeUninit::<libc::statvfs>::uninit();
    // SAFETY: `name` ends in NUL and outlives the call; `answer` is large enough for the result.
    let status = unsafe { libc::statvfs(name.as_ptr(), answer.as_mut_ptr()) };
    if status != 0 {
        return Err(io::Error::last_os_error());
    }
    // SAFETY: a call that returns 0 has filled the structure.
    let answer = unsafe { answer.assume_init() };
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
