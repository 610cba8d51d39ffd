//! A member in a copy of this process: all that was read once, such as calibrations, is there.

use std::fs::File;
use std::io;
use std::os::fd::AsRawFd;

/// A copy of this process, which ends with it.
#[derive(Debug)]
pub(super) struct Copied {
    pid: i32,
}

impl Copied {
    /// Runs `member` in a copy of this process, with its output in `log`; the copy ends with the exit code of `member`.
    ///
    /// # Errors
    /// If the system refuses, or this process has several threads, of which a copy has only one.
    pub(super) fn start(log: &File, member: impl FnOnce() -> u8) -> io::Result<Self> {
        if std::fs::read_dir("/proc/self/task")?.count() != 1 {
            return Err(io::Error::other("a process with several threads cannot be copied: this is a bug"));
        }
        let null = File::open("/dev/null")?;
        // SAFETY: this process has one thread, so no lock is held by another one.
        match unsafe { libc::fork() } {
            0 => {
                // SAFETY: the calls take integers, and the files are open.
                unsafe {
                    // A group of its own: Ctrl-C reaches the campaign, which passes it on.
                    libc::setpgid(0, 0);
                    // A campaign that is killed ends its runs.
                    libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGTERM);
                    for (from, to) in [(&null, 0), (log, 1), (log, 2)] {
                        libc::dup2(from.as_raw_fd(), to);
                    }
                }
                let member = std::panic::AssertUnwindSafe(member);
                std::process::exit(std::panic::catch_unwind(member).map_or(1, i32::from));
            }
            -1 => Err(io::Error::last_os_error()),
            pid => Ok(Self { pid }),
        }
    }

    /// Process id.
    pub(super) fn id(&self) -> u32 {
        self.pid.unsigned_abs()
    }

    /// True once it has ended; not to be asked again then.
    pub(super) fn has_ended(&self) -> io::Result<bool> {
        // SAFETY: a null status is allowed, and the process is a child that was not waited for.
        match unsafe { libc::waitpid(self.pid, std::ptr::null_mut(), libc::WNOHANG) } {
            -1 => Err(io::Error::last_os_error()),
            ended => Ok(ended == self.pid),
        }
    }
}
