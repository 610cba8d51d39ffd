//! Nearly valid inputs.

/// Makes inputs from seeds; the same number gives the same input.
pub struct Mutator {
    state: u64,
}

/// Numbers that are often invalid as lengths, counts and indices.
const NUMBERS: [u64; 14] = [
    0,
    1,
    0x7f,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0xffff_ffff,
    0x1_0000_0000,
    1 << 40,
    0x7fff_ffff_ffff_ffff,
    u64::MAX,
    u64::MAX - 8,
    u64::MAX / 3,
];

/// Special numbers as text.
const WORDS: [&str; 18] = [
    "0",
    "-1",
    "1",
    "1e30",
    "-1e30",
    "1e308",
    "1e-308",
    "NaN",
    "inf",
    "-inf",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "99999999999999999999",
    "0.0",
    "1e9",
    "",
    "\u{feff}",
];

impl Mutator {
    /// The generator of input `number`.
    pub fn new(number: u64) -> Self {
        Self { state: number.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1 }
    }

    fn next(&mut self) -> u64 {
        // xorshift64*: any generator suffices.
        self.state ^= self.state >> 12;
        self.state ^= self.state << 25;
        self.state ^= self.state >> 27;
        self.state.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// A number below `end`; 0 for none.
    fn below(&mut self, end: usize) -> usize {
        if end == 0 { 0 } else { (self.next() >> 16) as usize % end }
    }

    /// One of `seeds` with one to eight changes.
    pub fn mutate(&mut self, seeds: &[Vec<u8>], words: &[&str]) -> Vec<u8> {
        let mut bytes = match seeds.len() {
            0 => Vec::new(),
            count => seeds[self.below(count)].clone(),
        };
        for _ in 0..1 + self.below(8) {
            self.change(&mut bytes, seeds, words);
        }
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>, seeds: &[Vec<u8>], words: &[&str]) {
        let at = self.below(bytes.len() + 1);
        let near = (at + self.below(64)).min(bytes.len());
        match self.below(12) {
            0 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
            1 if at < bytes.len() => bytes[at] = self.next() as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..near)),
            4 => {
                let copy = bytes[at..near].to_vec();
                bytes.splice(at..at, copy);
            }
            5 => {
                let number = NUMBERS[self.below(NUMBERS.len())].to_le_bytes();
                let width = [1, 2, 4, 8][self.below(4)].min(bytes.len() - at);
                bytes[at..at + width].copy_from_slice(&number[..width]);
            }
            6 | 7 => self.replace_word(bytes, at, words),
            8 => self.splice(bytes, at, seeds),
            9 => self.repeat_line(bytes, at),
            10 => drop(bytes.drain(line(bytes, at))),
            _ => {
                let word = self.word(words);
                bytes.splice(at..at, word);
            }
        }
    }

    fn word(&mut self, words: &[&str]) -> Vec<u8> {
        let n = self.below(WORDS.len() + words.len());
        WORDS.get(n).or_else(|| words.get(n - WORDS.len())).map_or_else(Vec::new, |w| w.as_bytes().to_vec())
    }

    /// Replaces a field of text.
    fn replace_word(&mut self, bytes: &mut Vec<u8>, at: usize, words: &[&str]) {
        let part = |b: &u8| b.is_ascii_alphanumeric() || b"+-._".contains(b);
        let start = bytes[..at].iter().rposition(|b| !part(b)).map_or(0, |p| p + 1);
        let end = bytes[at..].iter().position(|b| !part(b)).map_or(bytes.len(), |p| at + p);
        let word = self.word(words);
        bytes.splice(start..end, word);
    }

    /// Inserts a piece of another seed.
    fn splice(&mut self, bytes: &mut Vec<u8>, at: usize, seeds: &[Vec<u8>]) {
        if seeds.is_empty() {
            return;
        }
        let other = &seeds[self.below(seeds.len())];
        let from = self.below(other.len() + 1);
        let to = (from + self.below(256)).min(other.len());
        bytes.splice(at..at, other[from..to].iter().copied());
    }

    fn repeat_line(&mut self, bytes: &mut Vec<u8>, at: usize) {
        let line = line(bytes, at);
        let copy = bytes[line.clone()].repeat(1 + self.below(3));
        bytes.splice(line.end..line.end, copy);
    }
}

/// The line of text around a byte, with its line end.
fn line(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let start = bytes[..at].iter().rposition(|b| *b == b'\n').map_or(0, |p| p + 1);
    let end = bytes[at..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |p| at + p + 1);
    // A piece, if the bytes are not text.
    start.max(end.saturating_sub(512))..end
}
