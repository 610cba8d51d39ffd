//! When two grains collide, and their velocities after it.

/// An overlap below this fraction of the contact distance is rounding.
pub(super) const OVERLAP_TOLERANCE: f64 = 1e-9;

/// A grain in flight, one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Grain {
    /// Centre at `time`, folded into the cell, m.
    pub(super) x: [f64; 3],
    pub(super) time: f64,
    /// Velocity of the centre, m/s.
    pub(super) v: [f64; 3],
    /// Radius at time 0, m.
    pub(super) radius: f64,
}

impl Grain {
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

/// The squared distance of two centres less the squared contact distance, a t² + 2b t + c.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PairMotion {
    a: f64,
    b: f64,
    c: f64,
}

impl PairMotion {
    /// For centres with relative position `d` and relative velocity `v`, and the contact distance `sigma`, which grows at
    /// `growth`.
    #[inline(always)]
    pub(super) fn new(d: &[f64; 3], v: &[f64; 3], sigma: f64, growth: f64) -> Self {
        Self { a: dot(v, v) - growth * growth, b: dot(d, v) - sigma * growth, c: dot(d, d) - sigma * sigma }
    }

    /// True if they may collide before `limit`, without a square root or a branch: half of all pairs come closer, few of those
    /// collide soon, and which is unpredictable.
    #[inline(always)]
    pub(super) fn may_collide(&self, limit: f64) -> bool {
        let Self { a, b, c } = *self;
        // With a ≥ 0 they must come closer, and the root is no earlier than c/(−2b).
        let soon = (b < 0.0) & (c < (-2.0 * b * limit).max(0.0)) & (b * b >= a * c);
        soon | (a < 0.0)
    }

    /// Time until contact (the first root) of a pair that [may collide](Self::may_collide); NaN if it does not. Zero for a pair
    /// that overlaps (by rounding) and comes closer.
    #[inline(always)]
    pub(super) fn time_to_contact(&self) -> f64 {
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

/// An elastic collision of smooth spheres: reverses the normal relative velocity. `d` points from `i` to `j`. Returns impulse
/// times distance; 0 for a pair that already separates.
#[inline]
pub(super) fn collide(i: &mut Grain, j: &mut Grain, d: &[f64; 3], sigma: f64, growth: f64) -> f64 {
    let v = [j.v[0] - i.v[0], j.v[1] - i.v[1], j.v[2] - i.v[2]];
    let separation_rate = dot(d, &v) - sigma * growth;
    if separation_rate >= 0.0 {
        return 0.0;
    }
    let square = dot(d, d);
    let (mi, mj) = (i.mass(), j.mass());
    let impulse = -2.0 * separation_rate / (square * (mi + mj));
    for ((vi, vj), d) in i.v.iter_mut().zip(&mut j.v).zip(d) {
        *vi -= impulse * mj * d;
        *vj += impulse * mi * d;
    }
    impulse * mi * mj * square
}
