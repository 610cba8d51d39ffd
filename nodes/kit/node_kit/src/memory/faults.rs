//! Faults of samples in transit.

use std::time::Duration;

/// Faults of one topic. A reliable subscription sees only their delays; a best-effort one sees them all.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Share of samples lost, 0 to 1.
    pub drop: f64,
    /// Share of samples that arrive twice, 0 to 1.
    pub duplicate: f64,
    /// Longest delay; each sample's delay is uniform between zero and this, so that samples overtake each other.
    pub delay: Duration,
}

/// The SplitMix64 generator: eight bytes of state, the same numbers on every machine.
#[derive(Clone, Debug)]
pub struct Dice(u64);

impl Dice {
    /// A generator with this seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A uniform number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A uniform integer in [0, `count`); 0 if `count` is 0.
    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// The delays of the copies of one sample; empty if it is lost. Draws the same number of random numbers whatever
    /// the outcome, so that one topic's faults do not shift another's.
    pub(super) fn arrivals(&mut self, faults: &Faults, reliable: bool) -> Vec<Duration> {
        let [lost, twice, first, second] = std::array::from_fn(|_| self.unit());
        if reliable {
            // A lost sample is repeated: it only arrives later.
            let rounds = if lost < faults.drop { 2.0 } else { first };
            return vec![faults.delay.mul_f64(rounds)];
        }
        if lost < faults.drop {
            return Vec::new();
        }
        let copies = if twice < faults.duplicate { 2 } else { 1 };
        [first, second][..copies].iter().map(|share| faults.delay.mul_f64(*share)).collect()
    }
}
