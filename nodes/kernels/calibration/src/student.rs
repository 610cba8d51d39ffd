//! Student's distribution, of a mean of few.

use grainlab_emt::HALF_WIDTH;

/// Half width of the central 95 % of Student's distribution over that of a normal one (Abramowitz & Stegun 26.7.5, to 2e-3
/// from five degrees of freedom on).
pub(crate) fn student(degrees_of_freedom: usize) -> f64 {
    let n = degrees_of_freedom.max(1) as f64;
    let (z2, z4, z6) = (HALF_WIDTH.powi(2), HALF_WIDTH.powi(4), HALF_WIDTH.powi(6));
    let first = (z2 + 1.0) / (4.0 * n);
    let second = (5.0 * z4 + 16.0 * z2 + 3.0) / (96.0 * n.powi(2));
    let third = (3.0 * z6 + 19.0 * z4 + 17.0 * z2 - 15.0) / (384.0 * n.powi(3));
    1.0 + first + second + third
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_s_distribution_is_wider_than_a_normal_one() {
        for (degrees, quantile) in [(5, 2.5706), (10, 2.2281), (15, 2.1314), (30, 2.0423)] {
            let found = 1.959_964 * student(degrees);
            assert!((found / quantile - 1.0).abs() < 2e-3, "{degrees}: {found}");
        }
    }
}
