//! SIGINT, SIGTERM and SIGHUP: the first signal stops the node, the second ends the process at once.

use crate::exit::Exit;
use mio::net::UnixStream;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::{flag, low_level::pipe};
use std::io::{self, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Handlers of SIGINT, SIGTERM and SIGHUP for the whole process, installed once.
#[derive(Debug)]
pub struct Signals {
    requested: Arc<AtomicBool>,
    arrivals: UnixStream,
}

/// Whether the process was started with this signal ignored.
fn is_ignored(signal: i32) -> bool {
    // SAFETY: with a null action, `sigaction` only writes the current one into `present`.
    unsafe {
        let mut present: libc::sigaction = std::mem::zeroed();
        libc::sigaction(signal, std::ptr::null(), &mut present) == 0 && present.sa_sigaction == libc::SIG_IGN
    }
}

impl Signals {
    /// Installs the handlers.
    pub fn install() -> io::Result<Self> {
        let requested = Arc::new(AtomicBool::new(false));
        let (arrivals, sender) = std::os::unix::net::UnixStream::pair()?;
        arrivals.set_nonblocking(true)?;
        // Under `nohup` the process must continue after the terminal closes.
        let hangup = (!is_ignored(SIGHUP)).then_some(SIGHUP);
        for signal in [SIGINT, SIGTERM].into_iter().chain(hangup) {
            // Handlers run in this order: the first signal finds the flag unset and sets it, the second ends the
            // process.
            flag::register_conditional_shutdown(
                signal,
                i32::from(Exit::Interrupted.code()),
                Arc::clone(&requested),
            )?;
            flag::register(signal, Arc::clone(&requested))?;
            pipe::register(signal, sender.try_clone()?)?;
        }
        Ok(Self { requested, arrivals: UnixStream::from_std(arrivals) })
    }

    /// Whether a signal arrived.
    pub fn requested(&self) -> bool {
        self.requested.load(Ordering::Relaxed)
    }

    /// A flag that becomes true with the first signal, for code that runs after the bus was closed.
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.requested)
    }

    pub(crate) fn source(&mut self) -> &mut UnixStream {
        &mut self.arrivals
    }

    /// Clears the pending wake-ups; true if there were any.
    pub(crate) fn drain(&mut self) -> bool {
        let mut bytes = [0; 16];
        let mut any = false;
        while matches!(self.arrivals.read(&mut bytes), Ok(n) if n > 0) {
            any = true;
        }
        any
    }
}
