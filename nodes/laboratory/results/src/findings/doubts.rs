//! Reasons to doubt states: those of their estimates and packings, and those of their estimates beside the count.

use super::judged::{Judged, recommended};
use crate::acoustic::AcousticReport;
use crate::inference::Inference;
use crate::read_back::InvertedPacking;
use grainlab_console::{and, count};
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

/// Reasons to doubt, each with the numbers of the states that have it, in the order of the first ones. Texts that differ by
/// numbers alone are one reason.
#[derive(Default)]
pub(super) struct Doubts(Vec<(Vec<Word>, BTreeSet<usize>)>);

/// A word of a reason, or the least and greatest of its numbers with the marks around them.
#[derive(PartialEq)]
enum Word {
    Text(String),
    Numbers([String; 2], [f64; 2], [String; 2]),
}

impl Word {
    fn of(word: &str) -> Self {
        let number = word.trim_matches(['(', ')', ',', ';', ':', '[', ']', '.']);
        let marks = word.split_once(number).filter(|_| {
            number.starts_with(['-', '+', '.']) || number.starts_with(|c: char| c.is_ascii_digit())
        });
        match (number.parse::<f64>(), marks) {
            (Ok(value), Some((before, after))) => Self::Numbers(
                [number.to_owned(), number.to_owned()],
                [value; 2],
                [before.to_owned(), after.to_owned()],
            ),
            _ => Self::Text(word.to_owned()),
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Numbers(_, _, marks), Self::Numbers(_, _, others)) => marks == others,
            _ => self == other,
        }
    }

    fn take(&mut self, other: Self) {
        if let (Self::Numbers([low, high], [least, greatest], _), Self::Numbers([text, _], [value, _], _)) =
            (self, other)
        {
            if value < *least {
                (*low, *least) = (text, value);
            } else if value > *greatest {
                (*high, *greatest) = (text, value);
            }
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Numbers([low, high], _, [before, after]) if low == high => format!("{before}{low}{after}"),
            Self::Numbers([low, high], _, [before, after]) => format!("{before}{low} to {high}{after}"),
        }
    }
}

impl Doubts {
    fn add(&mut self, n: usize, text: &str) {
        if !self.count(n, text) {
            self.0.push((text.split(' ').map(Word::of).collect(), BTreeSet::from([n])));
        }
    }

    /// Counts a state for a reason, and is true, if another state has the reason.
    fn count(&mut self, n: usize, text: &str) -> bool {
        let words: Vec<Word> = text.split(' ').map(Word::of).collect();
        let is_known = |(known, _): &&mut (Vec<Word>, BTreeSet<usize>)| {
            known.len() == words.len() && known.iter().zip(&words).all(|(a, b)| a.is_like(b))
        };
        let Some((known, of)) = self.0.iter_mut().find(is_known) else { return false };
        known.iter_mut().zip(words).for_each(|(known, word)| known.take(word));
        of.insert(n);
        true
    }

    /// Counts a state for each further reason of its estimate that is the first reason of another state.
    pub(super) fn further(&mut self, n: usize, state: &InvertedPacking) {
        for best in recommended(state).iter().filter(|best| best.status != "ok") {
            let reasons = best.warnings.iter().skip(1).map(|why| doubted(best, why));
            reasons.for_each(|reason| _ = self.count(n, &reason));
        }
    }

    /// Takes the doubts about a state: of its inversion first, then of the packing and its wave speeds.
    pub(super) fn of(&mut self, n: usize, state: &InvertedPacking) {
        match (recommended(state), state.packing.report.elasticity.as_ref()) {
            (Some(best), _) if best.status != "ok" => {
                let alone = || format!("the estimate is {}", best.status);
                self.add(n, &best.warnings.first().map_or_else(alone, |why| doubted(best, why)));
            }
            (Some(_), _) => {}
            (None, Err(why)) => self.add(n, &format!("nothing was inferred: there is no stiffness: {why}")),
            (None, Ok(_)) => {
                let results: Vec<&Inference> = state.results.iter().collect();
                let why = Inference::why_unknown(&results);
                let why = why.unwrap_or_else(|| "no moduli were inverted".to_owned());
                self.add(n, &format!("nothing was inferred: {why}"));
            }
        }
        state.packing.warnings.iter().for_each(|w| self.add(n, w));
        state.acoustics().filter_map(AcousticReport::doubt).for_each(|w| self.add(n, &w));
    }

    pub(super) fn finish(self, all: usize, noun: &str) -> Vec<String> {
        let shown = if self.0.len() > MOST_DOUBTS { MOST_DOUBTS - 1 } else { self.0.len() };
        let more = self.0.len() - shown;
        let of = |(words, of): &(Vec<Word>, BTreeSet<usize>)| {
            let text = words.iter().map(Word::text).collect::<Vec<_>>().join(" ");
            match (all, of.len()) {
                (1, _) => sentence(&text),
                (all, some) if all == some => format!("In every {noun}: {text}."),
                (all, some) => format!("In {some} of {}: {text}.", count(all, noun)),
            }
        };
        let lines = self.0[..shown].iter().map(of);
        lines.chain((more > 0).then(|| format!("And {}.", count(more, "further warning")))).collect()
    }
}

fn doubted(estimate: &Inference, why: &str) -> String {
    format!("the estimate is {}: {why}", estimate.status)
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
