//! A terminal of a given width, and what it shows.

use std::fs::File;
use std::io::Read;
use std::os::fd::FromRawFd;
use std::process::Stdio;
use std::thread::JoinHandle;

/// To the first column, and erase the line.
const ERASE: &str = "\r\x1b[2K";

/// The side of a pseudo-terminal that shows what programs write to it.
#[derive(Debug)]
pub struct Terminal {
    reader: JoinHandle<String>,
}

/// The lines that a terminal shows, and all those that were drawn on it.
#[derive(Debug)]
pub struct Shown {
    /// The lines at the end, from the top.
    pub lines: Vec<String>,
    /// Lines that were erased.
    pub erased: Vec<String>,
}

impl Terminal {
    /// A terminal with so many columns; the second value is the standard stream of a program on it.
    pub fn open(columns: u16) -> (Self, Stdio) {
        let size = libc::winsize { ws_row: 50, ws_col: columns, ws_xpixel: 0, ws_ypixel: 0 };
        let (mut master, mut slave) = (-1, -1);
        let none = std::ptr::null_mut();
        // SAFETY: the descriptors and the size outlive the call; name and settings are left out.
        let result = unsafe {
            libc::openpty(
                &raw mut master,
                &raw mut slave,
                none,
                std::ptr::null_mut(),
                &raw const size as *mut _,
            )
        };
        assert_eq!(result, 0, "no pseudo-terminal: {}", std::io::Error::last_os_error());
        // SAFETY: both descriptors are new, and no one else has them.
        let (mut master, slave) = unsafe { (File::from_raw_fd(master), File::from_raw_fd(slave)) };
        let reader = std::thread::spawn(move || {
            let (mut all, mut buffer) = (Vec::new(), [0; 4096]);
            // An error is the end: no program has the other side any more.
            while let Ok(count @ 1..) = master.read(&mut buffer) {
                all.extend_from_slice(&buffer[..count]);
            }
            String::from_utf8_lossy(&all).into_owned()
        });
        (Self { reader }, slave.into())
    }

    /// Text on it once every program on it has ended.
    pub fn shown(self) -> Shown {
        let text = self.reader.join().unwrap_or_else(|_| panic!("the terminal cannot be read"));
        let mut shown = Shown { lines: Vec::new(), erased: Vec::new() };
        for line in text.split("\r\n") {
            let mut drawn: Vec<&str> = line.split(ERASE).collect();
            shown.lines.extend(drawn.pop().map(str::to_owned));
            shown.erased.extend(drawn.into_iter().map(str::to_owned));
        }
        shown
    }
}
