//! Which of the distinct waves of a record is P, or S.

use super::distinct::Wave;
use std::ops::Range;

/// Least envelope of a strong wave; the largest wave has 1.
pub(super) const STRONG: f64 = 0.4;

/// Ratio of the speeds of P and S in dry packings: √2 for a Poisson's ratio of 0, and 2.1 for one of 0.35.
const P_OVER_S: Range<f64> = std::f64::consts::SQRT_2..2.1;

/// Least ratio of the envelopes of S and of a P that is strong.
const AS_STRONG: f64 = 0.7;

/// Error of the time of a crest, periods.
const CREST: f64 = 0.25;

#[derive(Clone, Copy, Debug)]
pub(super) struct Chosen {
    pub(super) wave: Wave,
    /// True if a later wave is larger.
    pub(super) is_followed: bool,
    /// Time from the wave to the other candidate, samples.
    pub(super) other: Option<f64>,
}

/// Chooses P, which is the first wave, or S among `waves`, which `periods` has the travel times of, in periods.
///
/// S is the first strong wave that is not P. A strong wave may be P if another, at least as strong, follows it when S may, unless it has
/// a P itself: nothing precedes P. The later one is then chosen, and the first is the other candidate. A larger wave that follows earlier
/// than S follows P is an echo, or came by a longer path. A wave that noise may be is the other candidate.
pub(super) fn chosen(waves: &[Wave], is_p: bool, periods: impl Fn(&Wave) -> f64) -> Option<Chosen> {
    let largest = (0..waves.len()).max_by(|a, b| waves[*a].height.total_cmp(&waves[*b].height))?;
    let clear = (0..waves.len()).find(|k| waves[*k].is_clear)?;
    let with = |k: usize, other: Option<usize>| {
        let apart = |j: usize| waves[j].crest as f64 - waves[k].crest as f64;
        Some(Chosen { wave: waves[k], is_followed: largest > k, other: other.map(apart) })
    };
    if is_p {
        return with(clear, (0..clear).max_by(|a, b| waves[*a].height.total_cmp(&waves[*b].height)));
    }
    let is_strong = |k: &usize| waves[*k].height >= STRONG * waves[largest].height;
    let first = (0..=largest).find(is_strong)?;
    // The later over the earlier time, with an error of either sign.
    let ratio = |early: usize, late: usize| {
        let [early, late] = [early, late].map(|k| periods(&waves[k]));
        [(late - CREST) / (early + CREST), (late + CREST) / (early - CREST)]
    };
    let may_be_s = |early: usize, late: usize| ratio(early, late)[1] >= P_OVER_S.start;
    let follows = |share: f64| {
        let is_large = |k: &usize| waves[*k].height > share * waves[first].height && may_be_s(first, *k);
        (first + 1..=largest).filter(is_strong).find(is_large)
    };
    let Some(second) = follows(AS_STRONG).filter(|k| ratio(first, *k)[0] <= P_OVER_S.end).or(follows(1.0))
    else {
        return with(first, Some(largest).filter(|_| !waves[first].is_clear));
    };
    let is_its_p = |k: usize| waves[k].is_clear && may_be_s(k, first) && ratio(k, first)[0] <= P_OVER_S.end;
    if (0..first).any(is_its_p) { with(first, None) } else { with(second, Some(first)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of the chosen wave of waves with these times (periods) and heights, and the other candidate.
    fn chosen_of(waves: &[(usize, f64)], is_p: bool) -> (usize, Option<usize>) {
        let wave = |(time, height): &(usize, f64)| {
            let (begins, crest) = (100 * time, 100 * time + 50);
            Wave { begins, crest, rise: 0.0, height: height.abs(), is_clear: *height > 0.0, ends: crest + 50 }
        };
        let all: Vec<Wave> = waves.iter().map(wave).collect();
        let found = chosen(&all, is_p, |wave| wave.begins as f64 / 100.0).unwrap();
        let place = |crest: usize| all.iter().position(|wave| wave.crest == crest).unwrap();
        let other = found.other.map(|other| place((found.wave.crest as f64 + other) as usize));
        (place(found.wave.crest), other)
    }

    #[test]
    fn p_is_the_first_clear_wave_and_one_that_may_be_noise_is_the_other_candidate() {
        assert_eq!(chosen_of(&[(8, 1.0), (13, 300.0)], true), (0, None));
        assert_eq!(chosen_of(&[(8, -1.0), (13, 300.0)], true), (1, Some(0)));
    }

    #[test]
    fn s_is_the_first_strong_wave_that_is_not_p() {
        // Weak P, S, and a larger wave that comes too soon to be S of the first strong one.
        assert_eq!(chosen_of(&[(8, 0.01), (13, 1.0), (16, 2.0)], false), (1, None));
        assert_eq!(chosen_of(&[(13, 1.0), (16, 2.0)], false), (0, None));
        // It does not come too soon, but the first strong one has a P of its own.
        assert_eq!(chosen_of(&[(8, 0.01), (13, 1.0), (20, 2.0)], false), (1, None));
        // The first may be P, and another strong wave S.
        assert_eq!(chosen_of(&[(13, 1.0), (20, 2.0)], false), (1, Some(0)));
        assert_eq!(chosen_of(&[(8, 1.0), (13, 1.0), (16, 2.0)], false), (1, Some(0)));
        assert_eq!(chosen_of(&[(8, 0.3), (13, 1.0), (16, 0.6)], false), (1, None));
        // P of a wet sample.
        assert_eq!(chosen_of(&[(4, 1.0), (20, 2.0)], false), (1, Some(0)));
        // What may be noise decides nothing.
        assert_eq!(chosen_of(&[(13, -1.0), (16, 2.0)], false), (0, Some(1)));
    }
}
