//! Values far from those of runs alike.

use grainlab_page::median;

/// Standard deviations of a normal distribution to its median absolute deviation.
const TO_SIGMA: f64 = 1.4826;

/// Fewest values of which some can be outliers.
const FEWEST: usize = 6;

/// Least deviation that counts, relative to the median: what a servo leaves of a target is none.
const LEAST: f64 = 1e-3;

/// The distribution of a quantity over runs alike, by its median and its median absolute deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Outliers {
    median: f64,
    deviation: f64,
    /// Robust z-score beyond which a value is an outlier (Iglewicz and Hoaglin, 1993). Among normal values, one set in a hundred
    /// has an outlier; their 3.5 would mark one of six sets of six.
    limit: f64,
}

impl Outliers {
    /// Distribution of these values; `None` of fewer than six finite ones.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let finite: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
        if finite.len() < FEWEST {
            return None;
        }
        let middle = median(finite.clone());
        let deviations = finite.iter().map(|v| (v - middle).abs()).collect();
        let limit = 4.0 + 30.0 / finite.len() as f64;
        Some(Self { median: middle, deviation: median(deviations), limit })
    }

    /// The robust z-score of a value: its distance from the median over 1.4826 median absolute deviations. Infinite if all
    /// others are equal.
    pub(crate) fn score(&self, value: f64) -> f64 {
        let off = value - self.median;
        if off.abs() <= LEAST * self.median.abs() { 0.0 } else { off / (TO_SIGMA * self.deviation) }
    }

    pub(crate) fn has(&self, value: f64) -> bool {
        self.score(value).abs() > self.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_far_from_the_others_is_an_outlier_and_does_not_hide_itself() {
        let all = [5.0, 5.1, 4.9, 5.05, 4.95, 9.0];
        let o = Outliers::of(all).unwrap();
        assert_eq!(all.map(|v| o.has(v)), [false, false, false, false, false, true]);
    }

    #[test]
    fn equal_values_have_no_outliers_and_a_single_other_one_is_one() {
        let o = Outliers::of([2.0, 2.0, 2.0, 2.0, 2.0, 2.1]).unwrap();
        assert!(!o.has(2.0) && o.has(2.1));
    }

    #[test]
    fn of_a_few_values_none_is_an_outlier_and_of_six_only_a_far_one() {
        assert_eq!(Outliers::of([1.0, f64::NAN, 1.0, 1.0, 1.0, 50.0]), None);
        let seeds = [85.08, 111.75, 102.96, 107.69, 116.22, 111.35];
        assert!(!seeds.iter().any(|v| Outliers::of(seeds).unwrap().has(*v)));
    }
}
