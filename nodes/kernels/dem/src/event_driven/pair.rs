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

/// Time until two centres `d` apart, which move apart at `v`, come to the distance `sigma`, which grows at `growth`; if
/// that is before `limit`. 0 for a pair that overlaps (by rounding) and closes.
///
/// The first root of a t² + 2b t + c, the square of the distance less that of contact.
#[inline(always)]
pub(super) fn meeting(d: &[f64; 3], v: &[f64; 3], sigma: f64, growth: f64, limit: f64) -> Option<f64> {
    let b = dot(d, v) - sigma * growth;
    let a = dot(v, v) - growth * growth;
    // They part, and faster than they grow: half of all pairs.
    if b >= 0.0 && a >= 0.0 {
        return None;
    }
    let c = dot(d, d) - sigma * sigma;
    let time = if b < 0.0 {
        if c <= 0.0 {
            return Some(0.0);
        }
        // With a ≥ 0 the root is no earlier than c/(−2b): most of the rest need no square root.
        if a >= 0.0 && c >= -2.0 * b * limit {
            return None;
        }
        let discriminant = b * b - a * c;
        if discriminant < 0.0 {
            return None;
        }
        c / (discriminant.sqrt() - b)
    } else {
        (b + (b * b - a * c).max(0.0).sqrt()) / -a
    };
    (time < limit).then_some(time)
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
