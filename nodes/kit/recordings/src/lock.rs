//! One process at a time in a directory.

use grainlab_console::{Failure, append_to, input};
use std::fmt;
use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::Path;
use std::str::FromStr;
use std::time::{Duration, Instant};

const POLL_PERIOD: Duration = Duration::from_millis(50);

/// The lock of a directory, which ends with the process that holds it, however that ends.
#[derive(Debug)]
pub struct Lock {
    file: File,
}

/// The process at work in a directory, as `process 12 on HOST`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AtWork {
    /// None is at work: the last one ended, or was killed.
    Nobody,
    /// This one holds the lock.
    Holder(String),
    /// This one of another host left no end, and locks need not be seen from host to host.
    Elsewhere(String),
}

impl Lock {
    /// Name of the file.
    pub const FILE: &str = ".lock";

    /// Locks an existing directory. The previous holder has `patience` to end.
    pub fn take(directory: &Path, patience: Duration) -> Result<Self, Failure> {
        let path = directory.join(Self::FILE);
        let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("{}: {e}", path.display()));
        let mut file = append_to(&path).map_err(|e| failed(&e))?;
        let until = Instant::now() + patience;
        let mut told = patience.is_zero();
        loop {
            match file.try_lock() {
                Ok(()) => {
                    let found = std::fs::read(&path).unwrap_or_default();
                    // A power cut may leave zeros.
                    if !found.starts_with(HOLDER.as_bytes()) && found.iter().any(|byte| *byte != 0) {
                        return Err(Failure::usage(format!(
                            "{}: this file is of another program: choose another directory, or remove it",
                            path.display()
                        )));
                    }
                    // A full disk does not keep the lock from holding.
                    let _ = file.set_len(0);
                    let since = Moment::now().map_or_else(String::new, |now| now.to_string());
                    let _ = file.write_all(format!("{}\n{since}", holder(&host_name())).as_bytes());
                    return Ok(Self { file });
                }
                Err(TryLockError::WouldBlock) => {
                    let who = written_holder(&path);
                    let who = if who.is_empty() { "another process" } else { &who };
                    let at_work = format!("{who} is at work in this directory");
                    if Instant::now() >= until {
                        return Err(failed(&format!("{at_work}: wait for it, or end it")));
                    }
                    if !std::mem::replace(&mut told, true) {
                        let (path, s) = (path.display(), patience.as_secs());
                        grainlab_console::say!(
                            "grainlab: {path}: {at_work}: waiting at most {s} s for its end"
                        );
                    }
                    std::thread::sleep(POLL_PERIOD);
                }
                Err(TryLockError::Error(error)) => return Err(failed(&error)),
            }
        }
    }

    /// Returns the time for which the process at work in a directory has held the lock. `None` if that process is on another host, whose
    /// clock is another one, or runs an earlier version. The wall clock has no influence.
    pub fn held_for(directory: &Path) -> Option<Duration> {
        let text = std::fs::read_to_string(directory.join(Self::FILE)).ok()?;
        let (since, now) = (text.lines().nth(1)?.parse::<Moment>().ok()?, Moment::now()?);
        now.uptime.checked_sub(since.uptime).filter(|_| now.boot == since.boot)
    }

    /// The process at work in a directory.
    pub fn at_work(directory: &Path) -> AtWork {
        let path = directory.join(Self::FILE);
        let Ok((file, _)) = input::open(&path) else { return AtWork::Nobody };
        let held = file.try_lock_shared();
        // A process that is being started may have this file as well for a moment.
        let _ = file.unlock();
        let who = written_holder(&path);
        match held {
            Err(TryLockError::WouldBlock) => AtWork::Holder(who),
            Ok(()) if who.is_empty() || who.ends_with(&format!(" on {}", host_name())) => AtWork::Nobody,
            _ => AtWork::Elsewhere(who),
        }
    }
}

/// A moment on the clock of this host that counts from its boot and is never set.
#[derive(Debug)]
struct Moment {
    boot: String,
    uptime: Duration,
}

impl Moment {
    fn now() -> Option<Self> {
        let boot = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
        let uptime = std::fs::read_to_string("/proc/uptime").ok()?;
        format!("{} {}", boot.trim(), uptime.split_whitespace().next()?).parse().ok()
    }
}

impl fmt::Display for Moment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:.2}", self.boot, self.uptime.as_secs_f64())
    }
}

impl FromStr for Moment {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let (boot, seconds) = text.split_once(' ').ok_or(())?;
        let uptime = seconds.parse().ok().and_then(|s| Duration::try_from_secs_f64(s).ok()).ok_or(())?;
        Ok(Self { boot: boot.to_owned(), uptime })
    }
}

/// Returns the process that wrote the file of a lock last; empty if that process left it in order.
fn written_holder(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    text.lines().next().unwrap_or_default().to_owned()
}

impl Drop for Lock {
    fn drop(&mut self) {
        let _ = self.file.set_len(0);
        // A process that is being started has this file as well until its program begins, and would hold the lock.
        let _ = self.file.unlock();
    }
}

/// Name of this host; `unknown` if the system does not say it.
pub fn host_name() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    if name.trim().is_empty() { "unknown".to_owned() } else { name.trim().to_owned() }
}

const HOLDER: &str = "process ";

fn holder(host: &str) -> String {
    format!("{HOLDER}{} on {host}", std::process::id())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_directory_has_one_holder_and_is_free_after_it() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Lock::at_work(folder.path()), AtWork::Nobody);
        let first = Lock::take(folder.path(), Duration::ZERO).unwrap();
        let second = Lock::take(folder.path(), 2 * POLL_PERIOD).unwrap_err().to_string();
        let me = holder(&host_name());
        assert!(second.contains(&format!("{me} is at work")), "{second}");
        assert_eq!(Lock::at_work(folder.path()), AtWork::Holder(me));
        // As after the wall clock was set by a day.
        let (now, day) = (std::time::SystemTime::now(), Duration::from_secs(86_400));
        for set in [now - day, now + day] {
            first.file.set_modified(set).unwrap();
            assert!(Lock::held_for(folder.path()).is_some_and(|time| time < Duration::from_secs(60)));
        }
        std::thread::sleep(3 * POLL_PERIOD);
        assert!(Lock::held_for(folder.path()) > Some(2 * POLL_PERIOD));
        drop(first);
        let left = |text: &str| std::fs::write(folder.path().join(Lock::FILE), text).unwrap();
        left(&holder(&host_name()));
        assert_eq!(Lock::at_work(folder.path()), AtWork::Nobody, "it was killed");
        left(&format!("{}\n1-2-3 4.00", holder("node7")));
        assert_eq!(Lock::held_for(folder.path()), None, "the clock of another host");
        assert_eq!(Lock::at_work(folder.path()), AtWork::Elsewhere(holder("node7")));
        drop(Lock::take(folder.path(), Duration::ZERO).unwrap());
        assert_eq!(Lock::at_work(folder.path()), AtWork::Nobody);
    }

    #[test]
    fn the_lock_ends_with_its_holder_even_if_a_process_is_being_started() {
        let folder = tempfile::tempdir().unwrap();
        let lock = Lock::take(folder.path(), Duration::ZERO).unwrap();
        let in_the_child = lock.file.try_clone().unwrap();
        drop(lock);
        assert_eq!(Lock::at_work(folder.path()), AtWork::Nobody);
        drop(Lock::take(folder.path(), Duration::ZERO).unwrap());
        drop(in_the_child);
    }

    #[test]
    fn a_link_in_the_place_of_the_lock_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let other = folder.path().join("precious");
        std::fs::write(&other, "old").unwrap();
        std::os::unix::fs::symlink(&other, folder.path().join(Lock::FILE)).unwrap();
        let error = Lock::take(folder.path(), Duration::ZERO).unwrap_err().to_string();
        assert!(error.contains("it is a link"), "{error}");
        assert_eq!(std::fs::read_to_string(other).unwrap(), "old");
    }

    #[test]
    fn a_lock_file_of_another_program_keeps_its_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(Lock::FILE);
        std::fs::write(&path, "4711\n").unwrap();
        let refused = Lock::take(folder.path(), Duration::ZERO).unwrap_err().to_string();
        assert!(refused.contains("is of another program"), "{refused}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "4711\n");
    }
}
