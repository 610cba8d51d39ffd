//! The Pareto front of time against error.

/// Whether each point (seconds, error) is on the front: no other point is at least as fast and at least as
/// accurate and better in one of the two. Points that are not finite are not on the front and exclude no
/// other; equal points share a place.
pub(crate) fn front(points: &[(f64, f64)]) -> Vec<bool> {
    let finite = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let beats = |a: &(f64, f64), b: &(f64, f64)| finite(a) && a.0 <= b.0 && a.1 <= b.1 && a != b;
    points.iter().map(|p| finite(p) && !points.iter().any(|other| beats(other, p))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_off_the_front_once_another_is_faster_and_more_accurate() {
        let points = [(1.0, 4.0), (2.0, 2.0), (3.0, 3.0), (4.0, 1.0), (5.0, 1.0)];
        assert_eq!(front(&points), [true, true, false, true, false]);
    }

    #[test]
    fn equal_points_share_their_place() {
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0), (1.0, 2.0)]), [true, true, false]);
    }

    #[test]
    fn a_setting_without_a_result_is_not_on_the_front_and_excludes_no_other() {
        assert_eq!(front(&[(f64::NAN, 0.0), (1.0, f64::NAN), (2.0, 2.0)]), [false, false, true]);
        assert!(front(&[]).is_empty());
    }

    #[test]
    fn the_fastest_and_the_most_accurate_are_always_on_it() {
        let points: Vec<(f64, f64)> =
            (1..50).map(|i| (f64::from(i), f64::from((i * 29) % 47) + 0.5 / f64::from(i))).collect();
        let on = front(&points);
        let best = |key: fn(&(f64, f64)) -> f64| {
            (0..points.len()).min_by(|a, b| key(&points[*a]).total_cmp(&key(&points[*b]))).unwrap()
        };
        assert!(on[best(|p| p.0)] && on[best(|p| p.1)]);
        // Along the front, more time always means a smaller error.
        let mut along: Vec<_> = points.iter().zip(&on).filter(|(_, on)| **on).map(|(p, _)| *p).collect();
        along.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!(along.len() > 2 && along.windows(2).all(|w| w[0].1 > w[1].1));
    }
}
