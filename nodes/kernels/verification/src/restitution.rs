//! The damping of a Hertzian contact that gives a coefficient of restitution.
//!
//! The engine's dashpot is 2 ζ √(m* k_n), and it never attracts. In units of the elastic collision, x for the overlap,
//! x″ = −max(0, x^{3/2} + 2 ζ √(3/2) x^{1/4} x′), from x = 0, x′ = 1: restitution depends on ζ alone.

/// Coefficient of restitution of a Hertzian contact of damping `damping`, by this equation (Runge–Kutta, 4th order).
pub(crate) fn restitution(damping: f64) -> f64 {
    const STEP: f64 = 2e-4;
    let coefficient = 2.0 * damping * 1.5f64.sqrt();
    let force = |x: f64, v: f64| {
        let x = x.max(0.0);
        (x.powf(1.5) + coefficient * x.powf(0.25) * v).max(0.0)
    };
    let (mut x, mut v) = (0.0f64, 1.0f64);
    // The force is zero from then on: it would attract.
    while v > 0.0 || force(x, v) > 0.0 {
        let slope = |x: f64, v: f64| (v, -force(x, v));
        let (x1, v1) = slope(x, v);
        let (x2, v2) = slope(x + 0.5 * STEP * x1, v + 0.5 * STEP * v1);
        let (x3, v3) = slope(x + 0.5 * STEP * x2, v + 0.5 * STEP * v2);
        let (x4, v4) = slope(x + STEP * x3, v + STEP * v3);
        x += STEP / 6.0 * (x1 + 2.0 * x2 + 2.0 * x3 + x4);
        v += STEP / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    }
    -v
}

/// The damping that gives this coefficient of restitution, to 1e-9, by bisection. Of `e` in (0.05, 1].
pub(crate) fn damping_for(e: f64) -> f64 {
    let (mut low, mut high) = (0.0, 2.0);
    if e >= 1.0 {
        return 0.0;
    }
    for _ in 0..32 {
        let middle = 0.5 * (low + high);
        if restitution(middle) > e { low = middle } else { high = middle }
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
        assert!((restitution(0.0) - 1.0).abs() < 1e-6, "{}", restitution(0.0));
        for e in [0.1, 0.3, 0.5, 0.98] {
            assert!((restitution(damping_for(e)) - e).abs() < 1e-6);
        }
        // Without attraction a contact keeps more: the difference vanishes with the damping.
        let more = |e: f64| restitution(damping_with_attraction(e)) - e;
        assert!(more(0.5) > more(0.9) && more(0.9) > 0.0 && more(0.98) < 2e-3, "{} {}", more(0.5), more(0.98));
    }
}
