//! Means over seeds, and medians.

/// Mean of independent values, and its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// Mean of the values.
    pub value: f64,
    /// Standard error, s/√n; `None` for one value.
    pub error: Option<f64>,
    /// Number of values.
    pub count: usize,
}

impl Mean {
    /// Mean of these values; `None` without one.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().collect();
        let count = values.len();
        if count == 0 {
            return None;
        }
        let value = values.iter().sum::<f64>() / count as f64;
        let squares: f64 = values.iter().map(|v| (v - value).powi(2)).sum();
        let error = (count > 1).then(|| (squares / (count as f64 - 1.0) / count as f64).sqrt());
        Some(Self { value, error, count })
    }

    /// Half width of the 95 % interval: two standard errors with many values, more with few; `None` for one value.
    pub fn half_width(&self) -> Option<f64> {
        Some(student(self.count - 1) * self.error?)
    }

    /// Difference of two means in standard errors; `None` if the scatter of one is not known.
    pub fn standard_errors_from(&self, other: &Self) -> Option<f64> {
        let error = self.error?.hypot(other.error?);
        Some(if self.value == other.value { 0.0 } else { (self.value - other.value).abs() / error })
    }

    /// True if two means differ by more than their scatter explains in one of twenty cases (Welch); `None` if that is not known.
    pub fn differs_from(&self, other: &Self) -> Option<bool> {
        let apart = self.standard_errors_from(other)?;
        let [a, b] = [self.error?, other.error?];
        let parts = [(a, self.count), (b, other.count)].map(|(e, n)| e.powi(4) / (n as f64 - 1.0));
        let freedom = (a * a + b * b).powi(2) / (parts[0] + parts[1]);
        Some(apart > student((freedom as usize).max(1)))
    }
}

/// Median of these values; NaN without one.
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match (values.len() % 2, values.get(middle)) {
        (_, None) => f64::NAN,
        (0, Some(upper)) => 0.5 * (values[middle - 1] + upper),
        (_, Some(value)) => *value,
    }
}

/// 97.5 % quantile of Student's t with `freedom` degrees of freedom, 1 or more, never below 2. From five on,
/// by the expansion of Abramowitz and Stegun, 26.7.5, accurate to 0.2 %.
fn student(freedom: usize) -> f64 {
    const FEW: [f64; 4] = [12.706, 4.303, 3.182, 2.776];
    let v = freedom as f64;
    let quantile = 1.95996 + 2.3723 / v + 2.8225 / (v * v) + 2.5558 / (v * v * v);
    FEW.get(freedom.saturating_sub(1)).copied().unwrap_or(quantile).max(2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_mean_is_that_of_the_sample_over_the_root_of_its_size() {
        let mean = Mean::of([1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!((mean.value, mean.count), (2.5, 4));
        assert!((mean.error.unwrap() - (5.0f64 / 3.0 / 4.0).sqrt()).abs() < 1e-15);
        assert_eq!(Mean::of([7.0]).unwrap().error, None);
        assert_eq!(Mean::of([]), None);
    }

    #[test]
    fn the_median_of_an_even_count_lies_between_the_middle_two() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 3.0, 2.0]), 2.5);
        assert!(median(Vec::new()).is_nan());
    }

    #[test]
    fn the_quantile_is_student_s() {
        for (freedom, quantile) in [(1, 12.706), (4, 2.776), (5, 2.571), (7, 2.365), (15, 2.131), (30, 2.042)]
        {
            assert!((student(freedom) / quantile - 1.0).abs() < 2e-3, "{freedom}: {}", student(freedom));
        }
    }

    #[test]
    fn means_differ_if_their_scatter_does_not_explain_it() {
        let mean = |value: f64, error: f64| Mean { value, error: Some(error), count: 4 };
        let differ = |a: Mean, b: Mean| a.differs_from(&b);
        assert_eq!(differ(mean(0.0148, 0.0391), mean(0.0999, 0.0093)), Some(false));
        assert_eq!(differ(mean(5.0, 0.05), mean(5.5, 0.1)), Some(true));
        assert_eq!(differ(mean(5.0, 0.1), mean(5.0, 0.0)), Some(false));
        assert_eq!(differ(Mean { error: None, count: 1, ..mean(4.0, 0.0) }, mean(5.0, 0.1)), None);
    }
}
