//! Arithmetic in lanes: one source text for a contact law, compiled for one, four or eight contacts at a time.
//!
//! Every operation is one correctly rounded IEEE 754 operation (the fused multiply-add included) or one operation on
//! integers. No operation is a processor's own estimate. So a contact has the same bits in every width and on every
//! processor. `f64` is the form with one lane.

use std::ops::{Add, Div, Mul, Sub};

/// A float's bits, read as an integer, are roughly its logarithm: this constant less half of them is roughly the
/// logarithm of the inverse root.
pub const RSQRT_MAGIC: u64 = 0x5fe6_eb50_c7b5_37a9;

/// Bits of the fraction of a float.
pub const FRACTION: u64 = (1 << 52) - 1;

/// 2^52: the lowest bits of a float of this size are a whole number.
pub const WHOLE: f64 = 4_503_599_627_370_496.0;

/// Arithmetic on 64-bit floats, one in each lane.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// One truth value per lane.
    type Mask: Copy;

    /// One number in every lane.
    fn splat(value: f64) -> Self;
    /// `self` × `factor` + `addend`, rounded once.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// `self` × `factor` − `subtrahend`, rounded once.
    fn mul_sub(self, factor: Self, subtrahend: Self) -> Self;
    /// `addend` − `self` × `factor`, rounded once.
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self;
    /// Square root of each lane.
    fn sqrt(self) -> Self;
    /// 1/√x for positive x, to one part in 28: a start for Newton's method. Large and finite where x is zero.
    fn rsqrt_estimate(self) -> Self;
    /// Exponent e and fraction m from 1 to 2 of a positive number m 2^e. Zero has the exponent −1023.
    fn split(self) -> (Self, Self);
    /// 2^n for a whole n from −1022 to 1023.
    fn power_of_two(self) -> Self;
    /// The larger of two; the second where they do not compare.
    fn max(self, other: Self) -> Self;
    /// Mask of the lanes in which `self` exceeds `other`.
    fn gt(self, other: Self) -> Self::Mask;
    /// True if the mask holds in any lane.
    fn any(mask: Self::Mask) -> bool;
    /// `a` where the mask holds, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
}

impl Lanes for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        f64::mul_add(self, factor, addend)
    }
    #[inline(always)]
    fn mul_sub(self, factor: Self, subtrahend: Self) -> Self {
        f64::mul_add(self, factor, -subtrahend)
    }
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        f64::mul_add(-self, factor, addend)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn rsqrt_estimate(self) -> Self {
        f64::from_bits(RSQRT_MAGIC - (self.to_bits() >> 1))
    }
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let bits = self.to_bits();
        ((bits >> 52) as f64 - 1023.0, f64::from_bits(bits & FRACTION | 1f64.to_bits()))
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        f64::from_bits((self + (WHOLE + 1023.0)).to_bits() << 52)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn gt(self, other: Self) -> bool {
        self > other
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
}

/// 1/√x for positive x, to about 1e-15; large and finite for zero. It uses neither root nor division: a processor has one
/// unit for both, which the rest of the contact law keeps busy.
#[inline(always)]
pub fn rsqrt<L: Lanes>(x: L) -> L {
    let (one, half, three) = (L::splat(1.0), L::splat(0.5), L::splat(0.375));
    // 1/√(1 − e) = 1 + e/2 + 3e²/8 + 5e³/16 + …
    let y = x.rsqrt_estimate();
    let e = (x * y).neg_mul_add(y, one);
    let y = e.mul_add(L::splat(0.3125), three).mul_add(e, half).mul_add(e * y, y);
    let e = (x * y).neg_mul_add(y, one);
    e.mul_add(three, half).mul_add(e * y, y)
}

/// A vector in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaneVec3<L> {
    /// First component of the vector.
    pub x: L,
    /// Second component of the vector.
    pub y: L,
    /// Third component of the vector.
    pub z: L,
}

impl<L: Lanes> LaneVec3<L> {
    /// Vector of three components.
    #[inline(always)]
    pub fn new(x: L, y: L, z: L) -> Self {
        Self { x, y, z }
    }

    /// One vector in every lane.
    #[inline(always)]
    pub fn splat_vector(v: &[f64; 3]) -> Self {
        Self::new(L::splat(v[0]), L::splat(v[1]), L::splat(v[2]))
    }

    /// One number in every component and lane.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self::new(L::splat(value), L::splat(value), L::splat(value))
    }

    /// Times a number.
    #[inline(always)]
    pub fn scale(self, factor: L) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }

    /// Scalar product in each lane.
    #[inline(always)]
    pub fn dot(self, other: Self) -> L {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    /// Vector product in each lane.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            self.z.neg_mul_add(o.y, self.y * o.z),
            self.x.neg_mul_add(o.z, self.z * o.x),
            self.y.neg_mul_add(o.x, self.x * o.y),
        )
    }

    /// `self` − `a` × `b` (vector product).
    #[inline(always)]
    pub fn sub_cross(self, a: Self, b: Self) -> Self {
        Self::new(
            a.z.mul_add(b.y, a.y.neg_mul_add(b.z, self.x)),
            a.x.mul_add(b.z, a.z.neg_mul_add(b.x, self.y)),
            a.y.mul_add(b.x, a.x.neg_mul_add(b.y, self.z)),
        )
    }

    /// `self` × `factor` − `v`.
    #[inline(always)]
    pub fn scale_sub(self, factor: L, v: Self) -> Self {
        Self::new(self.x.mul_sub(factor, v.x), self.y.mul_sub(factor, v.y), self.z.mul_sub(factor, v.z))
    }

    /// `self` + `v` × `factor`.
    #[inline(always)]
    pub fn add_scaled(self, v: Self, factor: L) -> Self {
        Self::new(v.x.mul_add(factor, self.x), v.y.mul_add(factor, self.y), v.z.mul_add(factor, self.z))
    }

    /// `self` − `v` × `factor`.
    #[inline(always)]
    pub fn sub_scaled(self, v: Self, factor: L) -> Self {
        Self::new(
            v.x.neg_mul_add(factor, self.x),
            v.y.neg_mul_add(factor, self.y),
            v.z.neg_mul_add(factor, self.z),
        )
    }

    /// `a` where the mask holds, else `b`.
    #[inline(always)]
    pub fn select(mask: L::Mask, a: Self, b: Self) -> Self {
        Self::new(L::select(mask, a.x, b.x), L::select(mask, a.y, b.y), L::select(mask, a.z, b.z))
    }
}

impl<L: Lanes> Add for LaneVec3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<L: Lanes> Sub for LaneVec3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}
