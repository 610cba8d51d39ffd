//! The standard normal distribution, and the tails of χ² and of the ratio F of mean squares.

use std::f64::consts::FRAC_1_SQRT_2;

pub(crate) const LN_SQRT_TAU: f64 = 0.918_938_533_204_672_7;

/// Half width, in standard deviations, of the central 95 % of a normal distribution.
pub const HALF_WIDTH: f64 = 1.959_963_984_540_054;

pub(crate) fn ln_density(x: f64, mean: f64, stddev: f64) -> f64 {
    -0.5 * ((x - mean) / stddev).powi(2) - stddev.ln() - LN_SQRT_TAU
}

/// Probability below x.
pub(crate) fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

/// The x below which the probability is `p`; infinite for 0 and 1. Abramowitz & Stegun 26.2.23, to 4.5e-4, and two steps of Halley's
/// method: accurate to rounding.
pub(crate) fn quantile(p: f64) -> f64 {
    if p <= 0.0 || p >= 1.0 {
        return if p <= 0.0 { f64::NEG_INFINITY } else { f64::INFINITY };
    }
    let tail = p.min(1.0 - p);
    let t = (-2.0 * tail.ln()).sqrt();
    let start = (2.515_517 + t * (0.802_853 + t * 0.010_328))
        / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308)))
        - t;
    let x = (0..2).fold(start, |x, _| {
        let off = (below(x) - tail) * (0.5 * x * x + LN_SQRT_TAU).exp();
        x - off / (1.0 + 0.5 * x * off)
    });
    if p < 0.5 { x } else { -x }
}

/// Probability that χ² with so many degrees of freedom, 1 or more, exceeds this value.
pub(crate) fn chi_square_above(chi_square: f64, degrees_of_freedom: usize) -> f64 {
    let half = 0.5 * chi_square.max(0.0);
    // Each two degrees of freedom add a term.
    let (mut probability, mut term, first) = if degrees_of_freedom.is_multiple_of(2) {
        (0.0, (-half).exp(), 1.0)
    } else {
        (libm::erfc(half.sqrt()), 2.0 * (half / std::f64::consts::PI).sqrt() * (-half).exp(), 1.5)
    };
    for i in 0..degrees_of_freedom / 2 {
        probability += term;
        term *= half / (first + i as f64);
    }
    probability.min(1.0)
}

/// The 0.999 quantile of the standard normal distribution.
const CERTAIN: f64 = 3.09;

/// True if χ² with so many degrees of freedom (at least 1) exceeds this value by chance less than once in a thousand
/// times.
pub(crate) fn is_beyond_chance(chi_square: f64, degrees_of_freedom: usize) -> bool {
    score(chi_square / degrees_of_freedom.max(1) as f64, degrees_of_freedom, None) >= CERTAIN
}

/// The quantile of the standard normal distribution with the same tail probability as this ratio of mean squares.
///
/// The ratio is that of a χ² with `above` degrees of freedom, per degree of freedom, to another with `below`, or to its
/// expectation if `None`: Wilson and Hilferty (1931), and Paulson (1942) for the ratio. With `below` less than three it
/// never exceeds 2.7.
pub(crate) fn score(ratio: f64, above: usize, below: Option<usize>) -> f64 {
    let spread = |freedom: usize| 2.0 / (9.0 * freedom.max(1) as f64);
    let (above, below) = (spread(above), below.map_or(0.0, spread));
    let root = ratio.max(0.0).cbrt();
    ((1.0 - below) * root - (1.0 - above)) / (above + below * root * root).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_probabilities_are_those_of_tables() {
        for (x, p) in [(1.959_963_984_540_054, 0.975), (-3.090_232_306_167_813, 1e-3), (0.0, 0.5)] {
            assert!((quantile(p) - x).abs() < 1e-14 && (below(x) - p).abs() < 1e-15, "{p}");
        }
        for p in [1e-300, 1e-20, 0.02, 0.3, 0.98, 1.0 - 1e-12] {
            assert!((below(quantile(p)) / p - 1.0).abs() < 1e-10, "{p}");
        }
    }

    #[test]
    fn chi_square_is_exceeded_as_tables_say() {
        for (chi_square, freedom, p) in [
            (3.841_458_821, 1, 0.05),
            (5.991_464_547, 2, 0.05),
            (16.266_236_196, 3, 1e-3),
            (30.143_527_206, 19, 0.05),
        ] {
            assert!((chi_square_above(chi_square, freedom) / p - 1.0).abs() < 1e-8, "{freedom}");
        }
        assert_eq!([1, 2, 7].map(|n| chi_square_above(0.0, n)), [1.0; 3]);
    }

    /// Tables of the one-in-a-thousand quantiles.
    #[test]
    fn quantiles_are_those_of_tables_and_a_ratio_to_few_is_rather_less_certain() {
        for (chi_square, freedom) in [(10.828, 1), (13.816, 2), (20.515, 5), (29.588, 10), (62.487, 32)] {
            let score = score(chi_square / freedom as f64, freedom, None);
            assert!((score - CERTAIN).abs() < 0.06, "{chi_square} {freedom} {score}");
        }
        for (ratio, above, below) in [(29.752, 5, 5), (10.481, 5, 10), (5.534, 5, 30), (7.768, 2, 40)] {
            let score = score(ratio, above, Some(below));
            assert!(score < CERTAIN + 0.06 && score > CERTAIN - 0.2, "{ratio} {above} {below} {score}");
        }
    }

    #[test]
    fn a_ratio_to_two_degrees_of_freedom_is_never_certain() {
        assert!(score(1e12, 5, Some(2)) < CERTAIN && score(1e12, 5, Some(1)) < 2.0);
        assert!(score(0.0, 5, Some(20)) < 0.0);
    }
}
