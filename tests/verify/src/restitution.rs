//! The damping of a Hertzian contact that gives a coefficient of restitution.
//!
//! The engine's dashpot is 2 ζ √(m* k_n), and it never attracts. In units of the elastic collision, x for the overlap,
//! x″ = −max(0, x^{3/2} + 2 ζ √(3/2) x^{1/4} x′), from x = 0, x′ = 1: restitution depends on ζ alone.

/// A collision that is damped as the engine damps, integrated by itself (Runge–Kutta, 4th order).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Damped {
    /// Coefficient of restitution.
    pub(crate) restitution: f64,
    /// Impulse of the elastic part of the force, over m* v.
    pub(crate) elastic_impulse: f64,
}

/// The springs of the collision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Springs {
    /// x^{3/2}, with a dashpot that grows as x^{1/4}.
    Hertz,
    /// x, with a constant dashpot.
    Linear,
}

impl Damped {
    /// The collision at a damping, as a fraction of critical.
    pub(crate) fn new(springs: Springs, damping: f64) -> Self {
        const STEP: f64 = 2e-4;
        let elastic = |x: f64| match springs {
            Springs::Hertz => x.powf(1.5),
            Springs::Linear => x,
        };
        let dashpot = |x: f64| match springs {
            Springs::Hertz => 1.5f64.sqrt() * x.powf(0.25),
            Springs::Linear => 1.0,
        };
        let force = |x: f64, v: f64| {
            let x = x.max(0.0);
            (elastic(x) + 2.0 * damping * dashpot(x) * v).max(0.0)
        };
        let slope = |x: f64, v: f64| (v, -force(x, v));
        let (mut x, mut v, mut impulse) = (0.0f64, 1.0f64, 0.0f64);
        // The overlap lasts longer than the force, where the dashpot would attract.
        while v > 0.0 || x > 0.0 {
            let (x1, v1) = slope(x, v);
            let (x2, v2) = slope(x + 0.5 * STEP * x1, v + 0.5 * STEP * v1);
            let (x3, v3) = slope(x + 0.5 * STEP * x2, v + 0.5 * STEP * v2);
            let (x4, v4) = slope(x + STEP * x3, v + STEP * v3);
            let before = elastic(x.max(0.0));
            x += STEP / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4);
            v += STEP / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
            impulse += 0.5 * STEP * (before + elastic(x.max(0.0)));
        }
        Self { restitution: -v, elastic_impulse: impulse }
    }
}

/// The damping of a Hertzian contact that gives this coefficient of restitution, to 1e-9, by bisection. Of `e` in (0.05, 1].
pub(crate) fn damping_for(e: f64) -> f64 {
    let (mut low, mut high) = (0.0, 2.0);
    if e >= 1.0 {
        return 0.0;
    }
    for _ in 0..32 {
        let middle = 0.5 * (low + high);
        if Damped::new(Springs::Hertz, middle).restitution > e { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The damping of the law F = k δ^{3/2} + c v without a limit on attraction, whose restitution has a closed form:
/// ζ = √(5/6) |ln e|/√(π² + ln² e), for e in (0, 1]. (Tsuji, Tanaka & Ishida, Powder Technol. 71, 239 (1992); Antypov & Elliott,
/// EPL 94, 50004 (2011).)
pub(crate) fn damping_with_attraction(e: f64) -> f64 {
    let l = e.ln();
    (5.0f64 / 6.0).sqrt() * l.abs() / l.hypot(std::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damping_and_restitution_are_inverse_and_begin_at_the_elastic_collision() {
        for springs in [Springs::Hertz, Springs::Linear] {
            let elastic = Damped::new(springs, 0.0);
            assert!((elastic.restitution - 1.0).abs() < 1e-6, "{elastic:?}");
            assert!((elastic.elastic_impulse - 2.0).abs() < 1e-6, "{elastic:?}");
        }
        let restitution = |damping| Damped::new(Springs::Hertz, damping).restitution;
        for e in [0.1, 0.3, 0.5, 0.98] {
            assert!((restitution(damping_for(e)) - e).abs() < 1e-6);
        }
        // Without attraction a contact keeps more: the difference vanishes with the damping.
        let more = |e: f64| restitution(damping_with_attraction(e)) - e;
        assert!(
            more(0.5) > more(0.9) && more(0.9) > 0.0 && more(0.98) < 2e-3,
            "{} {}",
            more(0.5),
            more(0.98)
        );
    }

    /// Schwager & Pöschel, Granular Matter 9, 465 (2007), Eq. 21.
    #[test]
    fn linear_springs_have_the_closed_form_of_their_restitution() {
        for damping in [0.05f64, 0.2, 0.5] {
            let phase = std::f64::consts::PI - 2.0 * damping.asin();
            let closed = (-damping / (1.0 - damping * damping).sqrt() * phase).exp();
            let found = Damped::new(Springs::Linear, damping).restitution;
            assert!((found / closed - 1.0).abs() < 1e-6, "{found} {closed}");
        }
    }
}
