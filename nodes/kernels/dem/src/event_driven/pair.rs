//! When two grains meet and what it does to them.

/// A grain in flight, one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Grain {
    /// Centre at `time`, folded into the cell, m.
    pub(super) x: [f64; 3],
    /// When it was there.
    pub(super) time: f64,
    /// Velocity, m/s.
    pub(super) v: [f64; 3],
    /// Radius at time 0, m.
    pub(super) radius: f64,
}

impl Grain {
    /// Where it is at `time` if nothing happens to it.
    #[inline(always)]
    pub(super) fn at(&self, time: f64) -> [f64; 3] {
        let dt = time - self.time;
        [self.x[0] + self.v[0] * dt, self.x[1] + self.v[1] * dt, self.x[2] + self.v[2] * dt]
    }

    /// Mass over density and 4π/3.
    #[inline(always)]
    pub(super) fn mass(&self) -> f64 {
        self.radius * self.radius * self.radius
    }
}

#[inline(always)]
pub(super) fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The square of the distance of two centres less that of contact, a t² + 2b t + c.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Approach {
    a: f64,
    b: f64,
    c: f64,
}

impl Approach {
    /// Of two centres `d` apart, which move apart at `v`, and the distance of contact `sigma`, which grows at `growth`.
    #[inline(always)]
    pub(super) fn of(d: &[f64; 3], v: &[f64; 3], sigma: f64, growth: f64) -> Self {
        Self { a: dot(v, v) - growth * growth, b: dot(d, v) - sigma * growth, c: dot(d, d) - sigma * sigma }
    }

    /// Whether they may meet before `limit`, told without a square root and without a branch: half of all pairs close,
    /// and few of those meet soon, no telling which.
    #[inline(always)]
    pub(super) fn may_meet(&self, limit: f64) -> bool {
        let Self { a, b, c } = *self;
        // With a ≥ 0 they must close, and the root is no earlier than c/(−2b).
        let soon = (b < 0.0) & (c < (-2.0 * b * limit).max(0.0)) & (b * b >= a * c);
        soon | (a < 0.0)
    }

    /// Time until they meet, the first root, of a pair that [may](Self::may_meet); not a number where it never does. 0
    /// for one that overlaps (by rounding) and closes.
    #[inline(always)]
    pub(super) fn meeting(&self) -> f64 {
        let Self { a, b, c } = *self;
        let square = b * b - a * c;
        if b >= 0.0 {
            (b + square.max(0.0).sqrt()) / -a
        } else if c <= 0.0 {
            0.0
        } else {
            c / (square.sqrt() - b)
        }
    }
}

/// Reverses the rate at which two grains in contact close: an elastic collision of smooth spheres. `d` leads from `i` to
/// `j`. Returns impulse times distance; 0 for a pair that parts already.
#[inline]
pub(super) fn collide(i: &mut Grain, j: &mut Grain, d: &[f64; 3], sigma: f64, growth: f64) -> f64 {
    let v = [j.v[0] - i.v[0], j.v[1] - i.v[1], j.v[2] - i.v[2]];
    let closing = dot(d, &v) - sigma * growth;
    if closing >= 0.0 {
        return 0.0;
    }
    let square = dot(d, d);
    let (mi, mj) = (i.mass(), j.mass());
    let share = -2.0 * closing / (square * (mi + mj));
    for ((vi, vj), d) in i.v.iter_mut().zip(&mut j.v).zip(d) {
        *vi -= share * mj * d;
        *vj += share * mi * d;
    }
    share * mi * mj * square
}
