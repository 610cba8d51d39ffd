//! The terminal on stderr: its width and colours, and a line that is drawn again and again.

use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Width where the terminal does not tell its own, as in a terminal emulator without a size.
const WIDTH: usize = 80;

/// To the first column, and erase the line.
const ERASE: &str = "\r\x1b[2K";

/// True while the terminal shows a live line. The lock of stderr guards every change.
static SHOWN: AtomicBool = AtomicBool::new(false);

/// A terminal on stderr on which a line can be drawn again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terminal {
    /// Number of columns.
    pub width: usize,
    /// True if colours are wanted.
    pub colour: bool,
}

impl Terminal {
    /// That of this process; `None` if stderr is no terminal, or one that cannot erase a line (`TERM=dumb`).
    pub fn on_stderr() -> Option<Self> {
        let lookup = |name: &str| std::env::var(name).ok();
        let terminal = std::io::stderr().is_terminal();
        let can_erase = terminal && lookup("TERM").is_none_or(|v| v != "dumb");
        can_erase.then(|| Self { width: width(), colour: colour_wanted(lookup, terminal) })
    }
}

/// Columns of the terminal on stderr.
fn width() -> usize {
    let mut size = libc::winsize { ws_row: 0, ws_col: 0, ws_xpixel: 0, ws_ypixel: 0 };
    // SAFETY: `size` is a winsize that outlives the call, which writes nothing else.
    let result = unsafe { libc::ioctl(libc::STDERR_FILENO, libc::TIOCGWINSZ, &raw mut size) };
    if result == 0 && size.ws_col > 0 { usize::from(size.ws_col) } else { WIDTH }
}

/// Draws a line in place of the one drawn before; `line` is narrower than the terminal. The cursor stays behind it, so that
/// the `^C` of an interrupt does not begin another line.
pub fn draw_live_line(line: &str) {
    let mut stderr = std::io::stderr().lock();
    SHOWN.store(true, Ordering::Relaxed);
    let _ = stderr.write_all(format!("{ERASE}{line}").as_bytes());
}

/// Removes the live line, if there is one.
pub fn erase_live_line() {
    write_above_live_line("");
}

/// Writes whole lines to stderr at once, so that those of several processes on one terminal do not mix. A live line is
/// erased before; its owner draws it again. A closed stderr is ignored.
pub fn write_above_live_line(text: &str) {
    let mut stderr = std::io::stderr().lock();
    let erase = if SHOWN.swap(false, Ordering::Relaxed) { ERASE } else { "" };
    if !(erase.is_empty() && text.is_empty()) {
        let _ = stderr.write_all(format!("{erase}{text}").as_bytes());
    }
}

/// Colour on a terminal that has it (not `TERM=dumb`), unless `NO_COLOR` or `CLICOLOR=0` says no. `CLICOLOR_FORCE` demands it
/// everywhere, and so does `RCUTILS_COLORIZED_OUTPUT=1` of ROS 2, which comes first, as does its 0.
pub fn colour_wanted(lookup: impl Fn(&str) -> Option<String>, terminal: bool) -> bool {
    let value = |name: &str| lookup(name).unwrap_or_default();
    match value("RCUTILS_COLORIZED_OUTPUT").as_str() {
        "1" => return true,
        "0" => return false,
        _ => {}
    }
    let is_forced = !matches!(value("CLICOLOR_FORCE").as_str(), "" | "0");
    value("NO_COLOR").is_empty()
        && (is_forced || (terminal && value("CLICOLOR") != "0" && value("TERM") != "dumb"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colour_is_for_terminals_and_can_be_refused_or_forced() {
        let wanted = |variables: &[(&str, &str)], terminal| {
            let lookup =
                |name: &str| variables.iter().find(|(n, _)| *n == name).map(|(_, v)| (*v).to_owned());
            colour_wanted(lookup, terminal)
        };
        assert!(wanted(&[], true) && !wanted(&[], false));
        assert!(!wanted(&[("NO_COLOR", "1")], true));
        assert!(wanted(&[("NO_COLOR", "")], true));
        assert!(!wanted(&[("CLICOLOR", "0")], true) && !wanted(&[("TERM", "dumb")], true));
        assert!(wanted(&[("CLICOLOR_FORCE", "1")], false) && !wanted(&[("CLICOLOR_FORCE", "0")], false));
        assert!(!wanted(&[("NO_COLOR", "1"), ("CLICOLOR_FORCE", "1")], true));
        assert!(wanted(&[("RCUTILS_COLORIZED_OUTPUT", "1")], false));
        assert!(!wanted(&[("RCUTILS_COLORIZED_OUTPUT", "0")], true));
    }
}
