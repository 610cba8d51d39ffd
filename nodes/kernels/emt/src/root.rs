//! The root of a function of one variable inside a bracket.

/// Bisection alone needs 53 steps; with interpolation, no tested function needed twice as many.
const STEPS: usize = 200;

/// The root of a continuous `f` in [`low`, `high`] to the rounding of the larger end, by Chandrupatla's method: inverse
/// quadratic interpolation where three points allow it, bisection elsewhere (Adv. Eng. Software 28, 145 (1997)).
///
/// `None` unless `f` changes sign between the ends or is zero at one of them. The root is unique if `f` is monotone.
pub(crate) fn bracketed(f: impl Fn(f64) -> f64, [low, high]: [f64; 2]) -> Option<f64> {
    // The root lies between a, the latest point, and b; c is the one before.
    let (mut a, mut b) = (high, low);
    let (mut at_a, mut at_b) = (f(a), f(b));
    // False for NaN.
    if !(at_a.min(at_b) <= 0.0 && at_a.max(at_b) >= 0.0) {
        return None;
    }
    let mut share: f64 = 0.5;
    let tolerance = f64::EPSILON * low.abs().max(high.abs());
    for _ in 0..STEPS {
        let (best, at_best) = if at_a.abs() < at_b.abs() { (a, at_a) } else { (b, at_b) };
        let width = (b - a).abs();
        if at_best == 0.0 || width <= tolerance {
            return Some(best);
        }
        let shortest = 0.5 * tolerance / width;
        let x = a + share.clamp(shortest, 1.0 - shortest) * (b - a);
        let at_x = f(x);
        if at_x.is_nan() {
            return None;
        }
        let (c, at_c);
        if (at_x > 0.0) == (at_a > 0.0) {
            (c, at_c) = (a, at_a);
        } else {
            (c, at_c) = (b, at_b);
            (b, at_b) = (a, at_a);
        }
        (a, at_a) = (x, at_x);
        // Interpolate where the inverse parabola through the three points is single-valued inside the bracket.
        let xi = (a - b) / (c - b);
        let phi = (at_a - at_b) / (at_c - at_b);
        share = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            at_a / (at_b - at_a) * at_c / (at_b - at_c)
                + (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
        } else {
            0.5
        };
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// A root of each kind: straight, steep, flat, of high order, at an end, far from zero.
    #[test]
    fn every_bracketed_root_is_found_to_the_last_digits_in_few_steps() {
        type Case = (fn(f64) -> f64, [f64; 2], f64, usize);
        let cases: [Case; 8] = [
            (|x| x - 0.3, [-0.5, 1.0], 0.3, 15),
            (|x| x.exp() - 2.0, [-4.0, 4.0 / 3.0], std::f64::consts::LN_2, 15),
            (|x| (50.0 * (x - 0.1)).atan(), [-0.5, 1.0], 0.1, 15),
            (|x| 1.0 / (x - 0.3) - 6.0, [0.301, 2.0], 0.3 + 1.0 / 6.0, 15),
            (|x| x * x * x - x - 5.0, [0.0, 3.0], 1.904_160_859_134_921, 15),
            (|x| x.powi(9), [-1.0, 1.1], 0.0, 70),
            (|x| 1.0 - x, [-0.5, 1.0], 1.0, 15),
            (|x| x - 1.0e9, [0.0, 1.0e12], 1.0e9, 15),
        ];
        for (i, (f, bracket, root, most)) in cases.into_iter().enumerate() {
            let calls = Cell::new(0);
            let counted = |x| {
                calls.set(calls.get() + 1);
                f(x)
            };
            let found = bracketed(counted, bracket).unwrap();
            let close = (found - root).abs() <= 2.0 * f64::EPSILON * bracket[1];
            assert!(close && calls.get() <= most, "case {i}: {found} after {}", calls.get());
        }
    }

    #[test]
    fn no_change_of_sign_is_no_root() {
        assert_eq!(bracketed(|x| x * x + 1e-12, [-1.0, 1.0]), None);
        assert_eq!(bracketed(|x| x - 2.0, [-1.0, 1.0]), None);
        assert_eq!(bracketed(|_| f64::NAN, [-1.0, 1.0]), None);
        assert_eq!(bracketed(|x| if x == 0.25 { f64::NAN } else { x }, [-0.5, 1.0]), None);
    }
}
