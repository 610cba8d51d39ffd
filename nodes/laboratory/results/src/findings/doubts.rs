//! Reasons to doubt states: those of their estimates and packings, and those of their estimates beside the count.

use super::judged::{Judged, recommended};
use crate::acoustic::AcousticReport;
use crate::inference::Inference;
use crate::read_back::InvertedPacking;
use grainlab_console::{and, count};
use grainlab_core::notes::{Note, Status};
use grainlab_core::results::InferredQuantity;
use std::collections::BTreeSet;

/// Warnings that are written out; the others are counted.
const MOST_DOUBTS: usize = 4;

/// States from which errors of one sign are said: the chance of that many is below 1 %.
const ONE_SIDED: usize = 8;

/// Share of counted values that lie in their intervals if the errors are as stated.
const COVERED: f64 = 0.95;

/// Probability below which so few values in their intervals are not chance.
const CHANCE: f64 = 0.025;

/// Estimates that disagree with the count, of one state or of several; `noun` names a state.
pub(super) fn beside_the_count(states: &[&InvertedPacking], noun: &str) -> Vec<String> {
    let judged = |s: &&InvertedPacking| Some(Judged::of(recommended(s)?, &s.packing.report));
    let judged: Vec<Judged> = states.iter().filter_map(judged).flatten().collect();
    let inside: Vec<bool> = judged.iter().filter_map(Judged::is_inside).collect();
    let within = inside.iter().filter(|is_inside| **is_inside).count();
    let mut found = Vec::new();
    if states.len() == 1 {
        let outside = judged.iter().filter(|j| j.is_inside() == Some(false));
        let outside: Vec<&str> = outside.map(|j| j.quantity.symbol()).collect();
        found.extend(match outside.as_slice() {
            [] => None,
            [one] => Some(format!("The counted {one} is outside of its 95 % interval.")),
            all => Some(format!("The counted {} are outside of their 95 % intervals.", and(all))),
        });
    } else if !inside.is_empty() && at_most(within, inside.len()) < CHANCE {
        found.push(format!("Only {within} of {} counted values lie in their 95 % intervals.", inside.len()));
    }
    for (side, sign) in [("low", -1.0), ("high", 1.0)] {
        let is_aside = |q: &InferredQuantity| {
            let of: Vec<&Judged> = judged.iter().filter(|j| j.quantity == *q).collect();
            of.len() >= ONE_SIDED && of.iter().all(|j| sign * (j.inferred - j.counted) > 0.0)
        };
        let of: Vec<&str> =
            InferredQuantity::countable().filter(is_aside).map(InferredQuantity::symbol).collect();
        let are = if of.len() == 1 { "is" } else { "are" };
        found.extend(
            (!of.is_empty()).then(|| format!("{} {are} inferred too {side} in every {noun}.", and(&of))),
        );
    }
    found
}

/// Probability of at most so many of all values in their intervals, by the binomial distribution.
fn at_most(inside: usize, all: usize) -> f64 {
    let mut ln = all as f64 * COVERED.ln();
    let mut fewer_misses = 0.0;
    for misses in 0..all - inside {
        fewer_misses += ln.exp();
        ln += ((all - misses) as f64 / (misses + 1) as f64 * (1.0 - COVERED) / COVERED).ln();
    }
    1.0 - fewer_misses
}

/// Reasons to doubt, in the order in which the states first have them. Notes that differ by numbers alone are one reason.
#[derive(Default)]
pub(super) struct Doubts(Vec<Doubt>);

struct Doubt {
    /// Words before and after the sentence of the notes.
    frame: [String; 2],
    notes: Vec<Note>,
    /// Numbers of the states that have the reason.
    states: BTreeSet<usize>,
}

impl Doubts {
    fn add(&mut self, state: usize, lead: &str, note: Note) {
        self.add_framed(state, [lead.to_owned(), String::new()], note);
    }

    fn add_framed(&mut self, state: usize, frame: [String; 2], note: Note) {
        if !self.count(state, &frame, &note) {
            self.0.push(Doubt { frame, notes: vec![note], states: BTreeSet::from([state]) });
        }
    }

    /// Counts a state for a reason, and returns true, if another state has the reason.
    fn count(&mut self, state: usize, frame: &[String; 2], note: &Note) -> bool {
        let known = |doubt: &&mut Doubt| doubt.frame == *frame && doubt.notes[0].is_like(note);
        let Some(doubt) = self.0.iter_mut().find(known) else { return false };
        doubt.notes.push(note.clone());
        doubt.states.insert(state);
        true
    }

    /// Counts a state for each further reason of its estimate that is the first reason of another state.
    pub(super) fn count_further(&mut self, n: usize, state: &InvertedPacking) {
        for best in recommended(state).iter().filter(|best| best.status != Status::Ok) {
            let further = best.notes.iter().skip(1);
            further.for_each(|note| _ = self.count(n, &[doubted(best), String::new()], note));
        }
    }

    /// Takes the doubts about a state: of its inversion first, then of the packing and its wave speeds.
    pub(super) fn take(&mut self, n: usize, state: &InvertedPacking) {
        let nothing = "nothing was inferred: ";
        match (recommended(state), state.packing.report.elasticity.as_ref()) {
            (Some(best), _) if best.status != Status::Ok => {
                let first = best.notes.first().cloned();
                self.add(n, &doubted(best), first.unwrap_or_else(|| Note::remark("no reason was sent")));
            }
            (Some(_), _) => {}
            (None, Err(why)) => self.add(n, &format!("{nothing}there is no stiffness: "), why.into()),
            (None, Ok(_)) => {
                let results: Vec<&Inference> = state.results.iter().collect();
                let preferred = Inference::preferred(&results);
                let reason = preferred.and_then(|best| Some((best.model.as_str(), best.notes.first()?)));
                match reason {
                    Some((model, why)) => self.add(n, &format!("{nothing}model {model}: "), why.clone()),
                    None => self.add(n, nothing, Note::remark("no moduli were inverted")),
                }
            }
        }
        state.packing.notes.iter().for_each(|note| self.add(n, "", note.clone()));
        for (note, more) in state.acoustics().filter_map(AcousticReport::doubt) {
            self.add_framed(n, ["wave speeds: ".to_owned(), more], note);
        }
    }

    pub(super) fn finish(self, all: usize, noun: &str) -> Vec<String> {
        let shown = if self.0.len() > MOST_DOUBTS { MOST_DOUBTS - 1 } else { self.0.len() };
        let more = self.0.len() - shown;
        let line = |Doubt { frame: [before, after], notes, states }: &Doubt| {
            let text = format!("{before}{}{after}", Note::text_of(notes));
            match (all, states.len()) {
                (1, _) => sentence(&text),
                (all, some) if all == some => format!("In every {noun}: {text}."),
                (all, some) => format!("In {some} of {}: {text}.", count(all, noun)),
            }
        };
        let lines = self.0[..shown].iter().map(line);
        lines.chain((more > 0).then(|| format!("And {}.", count(more, "further warning")))).collect()
    }
}

fn doubted(estimate: &Inference) -> String {
    format!("the estimate is {}: ", estimate.status)
}

/// A text with a capital letter and a full stop.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str().trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn so_few_values_in_their_intervals_are_less_likely_the_fewer_they_are() {
        assert!((at_most(1, 2) - (1.0 - 0.95f64.powi(2))).abs() < 1e-12);
        assert_eq!(at_most(20, 20), 1.0);
        assert!(at_most(17, 20) > CHANCE && at_most(16, 20) < CHANCE);
    }
}
