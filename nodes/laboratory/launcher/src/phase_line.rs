//! The lines of a phase on a terminal: while it runs, and when it is over. None is wider than the terminal.

use grainlab_console::duration;

/// Columns that stay free: for the `^C` of an interrupt, and because a full line begins another one.
const MARGIN: usize = 3;

const BAR: usize = 20;

/// Columns of a bar that is left out because it would be shorter.
const LEAST_BAR: usize = 6;

const PERCENT: usize = 6;

/// Columns of a name in a table of names.
const NAME: usize = 18;

/// Number and name of a phase of a path.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct PhaseName {
    /// Number of the phase, from 1.
    pub(crate) number: u32,
    pub(crate) of: usize,
    pub(crate) name: String,
}

impl PhaseName {
    fn place(&self) -> String {
        let digits = self.of.to_string().len();
        format!("{:digits$} of {}", self.number, self.of)
    }
}

/// Knowledge of the rest of a phase.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Rest {
    Unknown,
    /// Share that is done, and the time left, s, once the pace is known.
    Share(f64, Option<f64>),
    /// The end conditions that do not hold: the phase ends by the answer of the packing, at no known time.
    Unmet(String),
}

/// A phase under way, after `seconds` of the run.
pub(crate) fn live(seconds: f64, phase: &PhaseName, rest: &Rest, width: usize, colour: bool) -> String {
    let room = width.saturating_sub(MARGIN);
    // A name of the usual length yields to the percentage.
    let reserved = if matches!(rest, Rest::Share(..)) { PERCENT } else { 0 };
    let head = format!("{} {}  {}", time(seconds), phase.place(), phase.name);
    let head = fit(&head, room.saturating_sub(reserved));
    let free = room - columns(&head);
    match rest {
        Rest::Unknown => head,
        Rest::Share(share, left) => {
            let percent = format!(" {:3.0} %", (100.0 * share).floor());
            let left = left.map_or_else(String::new, |s| {
                let time = if s < 0.5 { "<1 s".to_owned() } else { duration(s) };
                format!("  {time} left")
            });
            let bar = free.saturating_sub(2 + columns(&percent) + columns(&left)).min(BAR);
            let bar =
                if bar < LEAST_BAR { String::new() } else { format!("  {}", bar_of(*share, bar, colour)) };
            let tail = [percent.clone() + &left, percent].into_iter().find(|t| columns(t) <= free);
            head + &bar + tail.as_deref().unwrap_or_default()
        }
        Rest::Unmet(conditions) => head + &fit(&format!("  not yet: {conditions}"), free),
    }
}

/// A phase that is over, `took` seconds and so many steps after it was first seen.
pub(crate) fn done(seconds: f64, phase: &PhaseName, (steps, took): (u64, f64), width: usize) -> String {
    let (time, place, name) = (time(seconds), phase.place(), fit(&phase.name, NAME));
    let line = format!("{time} {place}  {name:NAME$}{steps:>10} steps{:>12}", format!("  {took:.2} s"));
    fit(line.trim_end(), width.saturating_sub(MARGIN))
}

/// Something other than a phase that is waited for.
pub(crate) fn activity(seconds: f64, what: &str, width: usize) -> String {
    fit(&format!("{} {what}", time(seconds)), width.saturating_sub(MARGIN))
}

/// The time since the start.
pub(crate) fn time(seconds: f64) -> String {
    format!("[{seconds:7.2} s]")
}

/// A bar of which the share that is done is full; a part of a column does not count.
fn bar_of(share: f64, width: usize, colour: bool) -> String {
    let full = ((share * width as f64).floor() as usize).min(width);
    let (on, off) = if colour { ("\x1b[36m", "\x1b[0m") } else { ("", "") };
    format!("{on}{}{off}{}", "█".repeat(full), "░".repeat(width - full))
}

/// First columns of a text, with a mark if there are more.
fn fit(text: &str, room: usize) -> String {
    if columns(text) <= room {
        return text.to_owned();
    }
    let kept: String = text.chars().take(room.saturating_sub(1)).collect();
    if room == 0 { kept } else { kept + "…" }
}

/// Columns of a text without colours: names of scenes are ASCII, and the marks are one column wide.
fn columns(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn phase(name: &str) -> PhaseName {
        PhaseName { number: 6, of: 10, name: name.to_owned() }
    }

    const UNMET: &str = "stress is off target by 1.2345e-2, above 1e-3, unbalanced is 3.1234e-3, above 1e-3";

    #[test]
    fn no_line_is_wider_than_the_terminal() {
        let rests = [
            Rest::Unknown,
            Rest::Share(0.456, None),
            Rest::Share(0.456, Some(3700.0)),
            Rest::Unmet(UNMET.to_owned()),
        ];
        for width in 1..140 {
            for name in ["a", "isotropic-to-phi", "a-very-long-name-of-a-phase-in-a-scene-of-a-user#12"] {
                for rest in &rests {
                    let line = live(12_345.678, &phase(name), rest, width, false);
                    assert!(columns(&line) <= width.saturating_sub(MARGIN), "{width}: {line}");
                }
                let line = done(12_345.678, &phase(name), (123_456_789, 4321.0), width);
                assert!(columns(&line) <= width.saturating_sub(MARGIN), "{width}: {line}");
            }
        }
    }

    #[test]
    fn lines_read_as_they_are_meant_to() {
        let rest = Rest::Share(0.456, Some(3.2));
        let line = |rest: &Rest, width| live(3.75, &phase("extension"), rest, width, false);
        assert_eq!(line(&rest, 80), "[   3.75 s]  6 of 10  extension  █████████░░░░░░░░░░░  45 %  3 s left");
        assert_eq!(line(&rest, 40), "[   3.75 s]  6 of 10  extension  45 %");
        let unmet = Rest::Unmet(UNMET.to_owned());
        assert_eq!(line(&unmet, 130).split("  ").last(), Some(&*format!("not yet: {UNMET}")));
        assert!(line(&unmet, 100).ends_with("above 1e-3, unbalan…"), "{}", line(&unmet, 100));
        let done = |width| done(3.75, &phase("load"), (7, 0.4), width);
        assert_eq!(done(90), "[   3.75 s]  6 of 10  load                       7 steps      0.40 s");
        assert_eq!(done(60), "[   3.75 s]  6 of 10  load                       7 steps…");
    }

    #[test]
    fn a_bar_is_full_only_at_the_end() {
        let full = |share| bar_of(share, 20, false).matches('█').count();
        assert_eq!([0.0, 0.049, 0.05, 0.5, 0.999, 1.0].map(full), [0, 0, 1, 10, 19, 20]);
        let line = live(1.0, &phase("a"), &Rest::Share(0.9999, None), 80, false);
        assert!(line.contains(" 99 %"), "{line}");
    }
}
