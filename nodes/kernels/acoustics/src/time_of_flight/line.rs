//! Straight lines through arrivals.

/// t = a + s d, by weighted least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    pub(crate) slope: f64,
    /// Standard deviation of s from the scatter of the points about the line; infinite with two points.
    pub(crate) scatter: f64,
}

impl Line {
    /// Fitted to two or more points at different `places` with positive `weights`; else `None`.
    pub(crate) fn through(places: &[f64], times: &[f64], weights: &[f64]) -> Option<Self> {
        let total: f64 = weights.iter().sum();
        let mean = |of: &[f64]| of.iter().zip(weights).map(|(x, w)| x * w).sum::<f64>() / total;
        let (d, t) = (mean(places), mean(times));
        let moment = |of: &dyn Fn(usize) -> f64| (0..places.len()).map(|k| weights[k] * of(k)).sum::<f64>();
        let spread = moment(&|k| (places[k] - d).powi(2));
        if places.len() < 2 || spread.is_nan() || spread <= 0.0 {
            return None;
        }
        let slope = moment(&|k| (places[k] - d) * (times[k] - t)) / spread;
        let misfit = moment(&|k| (times[k] - t - slope * (places[k] - d)).powi(2));
        let freedom = places.len() as f64 - 2.0;
        let scatter = if freedom > 0.0 { (misfit / (freedom * spread)).sqrt() } else { f64::INFINITY };
        slope.is_finite().then_some(Self { slope, scatter })
    }
}
