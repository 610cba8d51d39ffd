//! CPU time, which is independent of other load on a shared machine.

use grainlab_console::Failure;
use grainlab_page::median;

/// Result of some work, and the median CPU time of its repetitions by all threads, s. A failure ends them.
pub(super) fn timed<T, E>(
    repetitions: u32,
    work: impl Fn() -> Result<T, E>,
) -> Result<(f64, Result<T, E>), Failure> {
    let mut times = Vec::new();
    loop {
        let begin = process_seconds()?;
        let result = work();
        times.push(process_seconds()? - begin);
        if times.len() as u32 >= repetitions || result.is_err() {
            return Ok((median(times), result));
        }
    }
}

/// CPU time that the calling thread has used, s.
pub(super) fn thread_seconds() -> Result<f64, Failure> {
    seconds(libc::CLOCK_THREAD_CPUTIME_ID)
}

/// CPU time that all threads of this process have used, s.
pub(super) fn process_seconds() -> Result<f64, Failure> {
    seconds(libc::CLOCK_PROCESS_CPUTIME_ID)
}

fn seconds(clock: libc::clockid_t) -> Result<f64, Failure> {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `now` is a timespec that outlives the call, which writes nothing else.
    match unsafe { libc::clock_gettime(clock, &raw mut now) } {
        0 => Ok(now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64),
        _ => Err(Failure::failed(format!("no CPU clock: {}", std::io::Error::last_os_error()))),
    }
}
