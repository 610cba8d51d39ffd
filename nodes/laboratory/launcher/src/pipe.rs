//! Ends a node when its launcher has ended: its standard input is a pipe that only the launcher holds open.
//!
//! The kernel's own mechanism (PR_SET_PDEATHSIG) sends one signal for each thread of a killed launcher, and the second
//! one would end a recorder before its file is finished.

use std::io::Read;
use std::time::Duration;

/// Environment variable that a launcher sets for processes whose standard input is its pipe.
pub const VARIABLE: &str = "GRAINLAB_LAUNCHER_PIPE";

/// Time for an orderly end after the launcher has ended.
const TIME_LIMIT: Duration = Duration::from_secs(10);

/// Ends this process when the launcher that started it has ended: by SIGTERM, and after some time by exit.
pub fn watch() {
    if std::env::var_os(VARIABLE).is_none() {
        return;
    }
    let wait = || {
        let mut byte = [0];
        // Nothing is written to the pipe: a read returns when its other end is closed.
        while matches!(std::io::stdin().read(&mut byte), Ok(1)) {}
        // SAFETY: both take or return integers and access no memory of this process.
        unsafe { libc::kill(libc::getpid(), libc::SIGTERM) };
        std::thread::sleep(TIME_LIMIT);
        std::process::exit(i32::from(grainlab_node_kit::Exit::Interrupted.code()));
    };
    // Without the thread the node runs without this protection.
    if let Err(error) = std::thread::Builder::new().name("launcher pipe".into()).spawn(wait) {
        grainlab_console::say!("grainlab: no thread to watch the launcher: {error}");
    }
}
