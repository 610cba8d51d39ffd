//! Keys on stdin.

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::getpgrp;
use rustix::termios::{LocalModes, OptionalActions, Termios, tcgetattr, tcgetpgrp, tcsetattr};
use std::collections::VecDeque;
use std::io::{IsTerminal, stdin};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Key {
    /// Pauses or continues.
    Pause,
    /// Sends the next message.
    Step,
    Faster,
    Slower,
    End,
}

/// Keys from stdin. A terminal passes each key at once and does not print it, until this is dropped.
pub(super) struct Keys {
    /// Settings of the terminal to restore.
    before: Option<Termios>,
    read: VecDeque<u8>,
    is_over: bool,
    /// The line of stdin has no key so far.
    is_empty_line: bool,
}

impl Keys {
    /// If stdin is a terminal, or `always`.
    pub(super) fn open(always: bool) -> Option<Self> {
        // A terminal stops a process in its background that changes its settings.
        let in_front = || tcgetpgrp(stdin()).is_ok_and(|group| group == getpgrp());
        let before = (stdin().is_terminal() && in_front()).then(raw).flatten();
        (always || before.is_some()).then(|| Self {
            before,
            read: VecDeque::new(),
            is_over: false,
            is_empty_line: true,
        })
    }

    /// True if the last key ended the playback, or stdin ended.
    pub(super) fn is_over(&self) -> bool {
        self.is_over
    }

    /// The next key, if there is one by now. The end of stdin is [`Key::End`].
    pub(super) fn next(&mut self) -> Option<Key> {
        loop {
            if self.read.is_empty() && !self.fill() {
                return None;
            }
            let lines = self.before.is_none().then_some(&mut self.is_empty_line);
            let key = key(&mut self.read, lines);
            if self.is_over && self.read.is_empty() && key.is_none() || key == Some(Key::End) {
                self.is_over = true;
                return Some(Key::End);
            }
            if key.is_some() {
                return key;
            }
        }
    }

    /// Reads what is there; false if there is nothing yet.
    fn fill(&mut self) -> bool {
        if self.is_over {
            return true;
        }
        let stdin = stdin();
        let now = Timespec { tv_sec: 0, tv_nsec: 0 };
        if !poll(&mut [PollFd::new(&stdin, PollFlags::IN)], Some(&now)).is_ok_and(|ready| ready > 0) {
            return false;
        }
        let mut bytes = [0u8; 64];
        match rustix::io::read(&stdin, &mut bytes) {
            Ok(count @ 1..) => self.read.extend(&bytes[..count]),
            _ => self.is_over = true,
        }
        true
    }
}

/// Takes one key from the bytes. Of lines, which are not from a terminal, an empty one is a step, too.
fn key(bytes: &mut VecDeque<u8>, is_empty_line: Option<&mut bool>) -> Option<Key> {
    let byte = bytes.pop_front()?;
    if let Some(is_empty) = is_empty_line
        && std::mem::replace(is_empty, byte == b'\n')
        && byte == b'\n'
    {
        return Some(Key::Step);
    }
    match byte {
        b' ' => Some(Key::Pause),
        b's' => Some(Key::Step),
        b'q' => Some(Key::End),
        // An arrow is escape, a bracket and a letter.
        0x1b if bytes.front() == Some(&b'[') => {
            bytes.pop_front();
            match bytes.pop_front()? {
                b'A' => Some(Key::Faster),
                b'B' => Some(Key::Slower),
                b'C' => Some(Key::Step),
                _ => None,
            }
        }
        _ => None,
    }
}

/// Lets the terminal pass keys at once; returns its settings before.
fn raw() -> Option<Termios> {
    let before = tcgetattr(stdin()).ok()?;
    let mut settings = before.clone();
    settings.local_modes &= !(LocalModes::ICANON | LocalModes::ECHO);
    tcsetattr(stdin(), OptionalActions::Now, &settings).is_ok().then_some(before)
}

impl Drop for Keys {
    fn drop(&mut self) {
        if let Some(before) = &self.before {
            let _ = tcsetattr(stdin(), OptionalActions::Now, before);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_letters_and_lines_are_keys_and_other_bytes_are_not() {
        let mut bytes: VecDeque<u8> = b" s\x1b[A\x1b[B\x1b[C\x1b[Dx\n\nq".iter().copied().collect();
        let (mut found, mut is_empty) = (Vec::new(), true);
        while !bytes.is_empty() {
            found.extend(key(&mut bytes, Some(&mut is_empty)));
        }
        let expected = [Key::Pause, Key::Step, Key::Faster, Key::Slower, Key::Step, Key::Step, Key::End];
        assert_eq!(found, expected);
        assert_eq!(key(&mut VecDeque::from([b'\n']), None), None, "Enter is no key of a terminal");
    }
}
