//! Quasi-random points of Halton.

/// Bases of the coordinates.
const PRIMES: [u64; 6] = [2, 3, 5, 7, 11, 13];

/// Point `index` of Halton's sequence, each coordinate shifted by a number in [0, 1).
pub(super) fn point(index: u64, shift: &[f64; PRIMES.len()]) -> [f64; PRIMES.len()] {
    std::array::from_fn(|i| {
        let (mut rest, mut scale, mut value) = (index + 1, 1.0, 0.0);
        while rest > 0 {
            scale /= PRIMES[i] as f64;
            value += scale * (rest % PRIMES[i]) as f64;
            rest /= PRIMES[i];
        }
        (value + shift[i]).fract()
    })
}
