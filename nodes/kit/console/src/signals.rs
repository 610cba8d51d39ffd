//! SIGINT, SIGTERM and SIGHUP: the first signal stops the node, the second ends the process at once.
//!
//! A node of a launched run is ended by its launcher alone. A service manager or a batch system sends its signal to all
//! processes of a run at once: the recorder and the readers of the simulator would end before its state is saved.

use grainlab_msgs::Exit;
use mio::net::UnixStream;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::low_level::{self, pipe};
use signal_hook_registry::register_sigaction;
use std::io::{self, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Handlers of SIGINT, SIGTERM and SIGHUP for the whole process, installed once.
#[derive(Debug)]
pub struct Signals {
    requested: Arc<AtomicBool>,
    arrivals: UnixStream,
}

/// True if the process was started with this signal ignored.
fn is_ignored(signal: i32) -> bool {
    // SAFETY: with a null action, `sigaction` only writes the current one into `present`.
    unsafe {
        let mut present: libc::sigaction = std::mem::zeroed();
        libc::sigaction(signal, std::ptr::null(), &mut present) == 0 && present.sa_sigaction == libc::SIG_IGN
    }
}

const IGNORED: &[u8] =
    b"a signal that the launcher did not send is ignored: end the launcher, or send SIGKILL\n";

/// The launcher `root` if it is the parent of this process, so that it ends it.
fn launcher(root: Option<u32>) -> Option<i32> {
    // SAFETY: it takes nothing and returns an integer.
    let parent = unsafe { libc::getppid() };
    root.and_then(|pid| i32::try_from(pid).ok()).filter(|pid| *pid == parent)
}

impl Signals {
    /// Installs the handlers of a program that anyone may end.
    pub fn install() -> io::Result<Self> {
        Self::of_node(None)
    }

    /// Installs the handlers of a node of the run of launcher `root`, if there is one.
    pub fn of_node(root: Option<u32>) -> io::Result<Self> {
        let launcher = launcher(root);
        let own = i32::try_from(std::process::id()).ok();
        let requested = Arc::new(AtomicBool::new(false));
        let (arrivals, sender) = std::os::unix::net::UnixStream::pair()?;
        arrivals.set_nonblocking(true)?;
        // Under `nohup` the process must continue after the terminal closes.
        let hangup = (!is_ignored(SIGHUP)).then_some(SIGHUP);
        for signal in [SIGINT, SIGTERM].into_iter().chain(hangup) {
            let asked = Arc::clone(&requested);
            let handler = move |info: &libc::siginfo_t| {
                // SAFETY: a signal of this kind has a sender.
                let sender = Some(unsafe { info.si_pid() });
                if launcher.is_some() && sender != launcher && sender != own {
                    // SAFETY: the bytes are valid, and `write` may be called in a handler.
                    unsafe { libc::write(libc::STDERR_FILENO, IGNORED.as_ptr().cast(), IGNORED.len()) };
                } else if asked.swap(true, Ordering::SeqCst) {
                    low_level::exit(i32::from(Exit::Interrupted.code()));
                }
            };
            // SAFETY: the handler only sets a flag, writes, and exits, as a handler may.
            unsafe { register_sigaction(signal, handler) }?;
            pipe::register(signal, sender.try_clone()?)?;
        }
        Ok(Self { requested, arrivals: UnixStream::from_std(arrivals) })
    }

    /// True once a signal arrived.
    pub fn requested(&self) -> bool {
        self.requested.load(Ordering::Relaxed)
    }

    /// A flag that becomes true with the first signal, for code that runs after the bus was closed.
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.requested)
    }

    /// The stream that becomes readable with a signal.
    pub fn source(&mut self) -> &mut UnixStream {
        &mut self.arrivals
    }

    /// Clears the pending wake-ups; true if there were any and a signal was obeyed.
    pub fn drain(&mut self) -> bool {
        let mut bytes = [0; 16];
        let mut any = false;
        while matches!(self.arrivals.read(&mut bytes), Ok(n) if n > 0) {
            any = true;
        }
        any && self.requested()
    }
}
