//! Tail probabilities of χ² and F, by cube-root approximations to the normal distribution.

/// The 0.999 quantile of the standard normal distribution.
pub(super) const CERTAIN: f64 = 3.09;

/// Whether χ² with so many degrees of freedom (at least 1) exceeds this value by chance less than once in a thousand
/// times.
pub(super) fn is_beyond_chance(chi_square: f64, degrees_of_freedom: usize) -> bool {
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
