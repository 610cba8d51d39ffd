//! Numbers in lanes: one source text for the contact law, compiled for one, four or eight contacts at a time.
//!
//! Every operation is one correctly rounded IEEE 754 operation (no fused multiply-add, no reciprocal estimate), so the
//! same contact gives the same bits in every width and on every processor. `f64` is the one-lane form.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Contacts in a block.
pub(crate) const BLOCK: usize = 8;

/// A row of a table of vectors: x, y, z and a spare.
pub(crate) type Quad = [f64; 4];

/// Force and torque of a contact or on a grain: two vectors, each with a spare.
pub(crate) type Wrench = [f64; 8];

/// Some lanes of 64-bit floats.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// Lanes in one value; divides 8.
    const WIDTH: usize;
    /// One truth value a lane.
    type Mask: Copy;
    /// Rows of a table, one a lane.
    type Index: Copy;

    /// The same number in every lane.
    fn splat(value: f64) -> Self;
    /// Lanes `lane..lane + WIDTH` of a block.
    fn load(from: &[f64; BLOCK], lane: usize) -> Self;
    /// Writes lanes `lane..lane + WIDTH` of a block.
    fn store(self, to: &mut [f64; BLOCK], lane: usize);
    /// Square root.
    fn sqrt(self) -> Self;
    /// The larger of two; the second where they do not compare.
    fn max(self, other: Self) -> Self;
    /// Where `self` exceeds `other`.
    fn gt(self, other: Self) -> Self::Mask;
    /// Whether it holds in any lane.
    fn any(mask: Self::Mask) -> bool;
    /// `a` where the mask holds, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Lanes `lane..lane + WIDTH` of a block of row numbers, kept below `rows`.
    fn index(from: &[u32; BLOCK], lane: usize, rows: usize) -> Self::Index;
    /// Component `K` of the rows at `index`.
    ///
    /// # Panics
    /// Where `table` has fewer rows than the index was made for.
    fn gather<const K: usize>(table: &[Quad], index: Self::Index) -> Self;
    /// Asks for the rows of lanes `lane..lane + WIDTH` to be brought near, where the processor can be asked.
    fn prefetch(table: &[Quad], rows: &[u32; BLOCK], lane: usize);
    /// Writes four components a lane to rows `lane..lane + WIDTH`, from column `at` (0 or 4) on.
    fn store_rows(components: [Self; 4], to: &mut [Wrench; BLOCK], lane: usize, at: usize);
    /// Adds eight components to `sum`, lane after lane.
    fn fold(components: [Self; 8], sum: &mut [f64; 8]);
}

impl Lanes for f64 {
    const WIDTH: usize = 1;
    type Mask = bool;
    type Index = usize;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn load(from: &[f64; BLOCK], lane: usize) -> Self {
        from[lane]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64; BLOCK], lane: usize) {
        to[lane] = self;
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
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
    #[inline(always)]
    fn index(from: &[u32; BLOCK], lane: usize, rows: usize) -> usize {
        (from[lane] as usize).min(rows - 1)
    }
    #[inline(always)]
    fn gather<const K: usize>(table: &[Quad], index: usize) -> Self {
        table[index][K]
    }
    #[inline(always)]
    fn prefetch(_: &[Quad], _: &[u32; BLOCK], _: usize) {}
    #[inline(always)]
    fn store_rows(components: [Self; 4], to: &mut [Wrench; BLOCK], lane: usize, at: usize) {
        to[lane][at..at + 4].copy_from_slice(&components);
    }
    #[inline(always)]
    fn fold(components: [Self; 8], sum: &mut [f64; 8]) {
        for (s, c) in sum.iter_mut().zip(components) {
            *s += c;
        }
    }
}

/// A vector in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct V3<L> {
    /// First component.
    pub x: L,
    /// Second component.
    pub y: L,
    /// Third component.
    pub z: L,
}

impl<L: Lanes> V3<L> {
    /// From components.
    #[inline(always)]
    pub fn new(x: L, y: L, z: L) -> Self {
        Self { x, y, z }
    }

    /// The rows of a table.
    #[inline(always)]
    pub(crate) fn gather(table: &[Quad], index: L::Index) -> Self {
        Self::new(L::gather::<0>(table, index), L::gather::<1>(table, index), L::gather::<2>(table, index))
    }

    /// Lanes `lane..lane + WIDTH` of a block of vectors.
    #[inline(always)]
    pub(crate) fn load(from: &[[f64; BLOCK]; 3], lane: usize) -> Self {
        Self::new(L::load(&from[0], lane), L::load(&from[1], lane), L::load(&from[2], lane))
    }

    /// Writes lanes `lane..lane + WIDTH` of a block of vectors.
    #[inline(always)]
    pub(crate) fn store(self, to: &mut [[f64; BLOCK]; 3], lane: usize) {
        self.x.store(&mut to[0], lane);
        self.y.store(&mut to[1], lane);
        self.z.store(&mut to[2], lane);
    }

    /// Times a number.
    #[inline(always)]
    pub fn scale(self, by: L) -> Self {
        Self::new(self.x * by, self.y * by, self.z * by)
    }

    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> L {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Vector product.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(self.y * o.z - self.z * o.y, self.z * o.x - self.x * o.z, self.x * o.y - self.y * o.x)
    }

    /// `a` where the mask holds, else `b`.
    #[inline(always)]
    pub(crate) fn select(mask: L::Mask, a: Self, b: Self) -> Self {
        Self::new(L::select(mask, a.x, b.x), L::select(mask, a.y, b.y), L::select(mask, a.z, b.z))
    }
}

impl<L: Lanes> Add for V3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<L: Lanes> Sub for V3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}
