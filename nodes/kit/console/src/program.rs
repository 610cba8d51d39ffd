//! The words that start this program again.

use std::ffi::OsString;
use std::io;
use std::sync::OnceLock;

/// Words of a host, such as Python, whose executable is not this program.
static OF_HOST: OnceLock<Vec<OsString>> = OnceLock::new();

/// Sets program and first arguments by which this program is started again, once, before [`program`] is asked.
pub fn set_program(words: Vec<OsString>) {
    _ = OF_HOST.set(words);
}

/// Program and first arguments that start this program again: its own executable, unless a host has set others.
///
/// # Errors
/// If the executable is not known.
pub fn program() -> io::Result<Vec<OsString>> {
    OF_HOST
        .get()
        .map_or_else(|| std::env::current_exe().map(|path| vec![path.into()]), |words| Ok(words.clone()))
}

/// This program as it was called, for advice to a reader.
pub fn called() -> String {
    let of_host =
        OF_HOST.get().map(|words| words.iter().map(|w| w.to_string_lossy()).collect::<Vec<_>>().join(" "));
    of_host.or_else(|| std::env::args().next()).unwrap_or_else(|| "grainlab".to_owned())
}
