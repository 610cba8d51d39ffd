//! What ties a node to its launcher: a pipe that only the launcher holds open.
//!
//! The kernel's own way (PR_SET_PDEATHSIG) sends its signal once for every thread of a launcher that is killed, and the second
//! one would end a recorder before its file is finished.

use std::io::Read;
use std::time::Duration;

/// Set by a launcher for the processes whose standard input is its lifeline.
pub(crate) const VARIABLE: &str = "GRAINLAB_LIFELINE";

/// How long a node may take to end in good order after its launcher died.
const PATIENCE: Duration = Duration::from_secs(10);

/// Ends this process when the launcher that started it is gone: in good order, as SIGTERM does, and else the hard way.
pub(crate) fn watch() {
    if std::env::var_os(VARIABLE).is_none() {
        return;
    }
    let wait = || {
        let mut byte = [0];
        // Nothing is ever written: a read returns when the other end is closed.
        while matches!(std::io::stdin().read(&mut byte), Ok(1)) {}
        // SAFETY: both take or return integers and touch no memory of ours.
        unsafe { libc::kill(libc::getpid(), libc::SIGTERM) };
        std::thread::sleep(PATIENCE);
        std::process::exit(i32::from(grainlab_node_kit::Exit::Interrupted.code()));
    };
    // Without the thread the node only loses this protection.
    if let Err(error) = std::thread::Builder::new().name("lifeline".into()).spawn(wait) {
        grainlab_console::say!("grainlab: no thread to watch the launcher: {error}");
    }
}
