//! Numbers in lanes: one source text for the contact law, compiled for one, four or eight contacts at a time.
//!
//! Every operation is one correctly rounded IEEE 754 operation, the fused multiply-add one of them, or one on integers,
//! and none is a processor's own estimate, so the same contact gives the same bits in every width and on every
//! processor. `f64` is the one-lane form.

use std::marker::PhantomData;
use std::ops::{Add, Div, Mul, Sub};

/// Contacts in a block.
pub(crate) const BLOCK: usize = 8;

/// Grains in a chunk: the unit of work of a thread, and of every sum over contacts.
pub(crate) const CHUNK: usize = 256;

/// The bits of a float, read as an integer, are its logarithm, roughly: this less half of them is that of the inverse
/// root.
pub(crate) const ABOUT_INVERSE_ROOT: u64 = 0x5fe6_eb50_c7b5_37a9;

/// A row of a table of vectors: x, y, z and a spare.
pub(crate) type Quad = [f64; 4];

/// Two vectors, each with a spare: force and torque, or velocity and spin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Octad(pub(crate) [f64; 8]);

/// Numbers of rows of a table, a block of them; those from `lane` on were found to be below a bound.
#[derive(Clone, Copy)]
pub struct Rows<'a, L> {
    number: &'a [u32; BLOCK],
    below: usize,
    lane: usize,
    lanes: PhantomData<L>,
}

impl<'a, L: Lanes> Rows<'a, L> {
    /// For lanes `lane..lane + WIDTH`.
    ///
    /// # Panics
    /// Where one of their numbers is not below the bound.
    #[inline(always)]
    pub(crate) fn new(number: &'a [u32; BLOCK], lane: usize, below: usize) -> Self {
        assert!(L::are_below(number, lane, below), "a row that the table does not have");
        let number = L::anew(number);
        Self { number, below, lane, lanes: PhantomData }
    }

    /// The number in lane `k` of `WIDTH`.
    #[inline(always)]
    pub(crate) fn number(&self, k: usize) -> usize {
        self.number[self.lane + k] as usize
    }

    /// What all are below.
    #[inline(always)]
    pub(crate) fn below(&self) -> usize {
        self.below
    }
}

/// Some lanes of 64-bit floats.
pub trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Lanes in one value; divides 8.
    const WIDTH: usize;
    /// One truth value a lane.
    type Mask: Copy;
    /// A row of a table: four numbers whatever the lanes.
    type Row: Row;

    /// The same number in every lane.
    fn splat(value: f64) -> Self;
    /// Lanes `lane..lane + WIDTH` of a block.
    fn load(from: &[f64; BLOCK], lane: usize) -> Self;
    /// Writes lanes `lane..lane + WIDTH` of a block.
    fn store(self, to: &mut [f64; BLOCK], lane: usize);
    /// `self` × `by` + `plus`, rounded once.
    fn mul_add(self, by: Self, plus: Self) -> Self;
    /// `self` × `by` − `minus`, rounded once.
    fn mul_sub(self, by: Self, minus: Self) -> Self;
    /// `from` − `self` × `by`, rounded once.
    fn mul_sub_from(self, by: Self, from: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// 1/√x for positive x, to one part in 28: a start for Newton's method. Large and finite where x is zero.
    fn about_inverse_root(self) -> Self;
    /// The larger of two; the second where they do not compare.
    fn max(self, other: Self) -> Self;
    /// Where `self` exceeds `other`.
    fn gt(self, other: Self) -> Self::Mask;
    /// Whether it holds in any lane.
    fn any(mask: Self::Mask) -> bool;
    /// `a` where the mask holds, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Whether lanes `lane..lane + WIDTH` of a block are below a bound.
    fn are_below(number: &[u32; BLOCK], lane: usize, bound: usize) -> bool;
    /// The same numbers, to be read one by one: taking them out of a wide register would cost more.
    #[inline(always)]
    fn anew(number: &[u32; BLOCK]) -> &[u32; BLOCK] {
        number
    }
    /// Rows of a table, the first three components.
    ///
    /// # Panics
    /// This and the next four: where a table has fewer rows than their numbers may reach.
    fn rows(table: &[Quad], at: Rows<'_, Self>) -> V3<Self>;
    /// Rows `a` less rows `b`.
    fn difference(table: &[Quad], a: Rows<'_, Self>, b: Rows<'_, Self>) -> V3<Self>;
    /// Velocities of `a` less those of `b`, and the sum of their spins.
    fn relative(table: &[Octad], a: Rows<'_, Self>, b: Rows<'_, Self>) -> [V3<Self>; 2];
    /// Spins.
    fn spins(table: &[Octad], at: Rows<'_, Self>) -> V3<Self>;
    /// Asks for rows of a table to be brought near, where the processor can be asked.
    fn prefetch<T>(table: &[T], rows: &[u32; BLOCK]);
    /// Adds what pairs do to their grains, pair after pair: force and moment to row `to` of the sums, the opposite force
    /// and the same moment to row `from` modulo the grains of a chunk. Of the eight components three are the force and, where `TURN`, three from the
    /// fifth on the moment. Where `LEVERS`, the fourth is the lever of the moment on `to` and the eighth that on `from`.
    fn scatter<const TURN: bool, const LEVERS: bool>(
        components: [Self; 8],
        from: Rows<'_, Self>,
        to: Rows<'_, Self>,
        sums: &mut [Octad],
    );
    /// Adds eight components to `sum`, lane after lane.
    #[inline(always)]
    fn fold(components: [Self; 8], sum: &mut [f64; 8]) {
        let mut parts = [[0.0; BLOCK]; 8];
        for (part, component) in parts.iter_mut().zip(components) {
            component.store(part, 0);
        }
        for (sum, part) in sum.iter_mut().zip(parts) {
            part[..Self::WIDTH].iter().for_each(|p| *sum += p);
        }
    }
}

/// Four numbers of one grain.
pub trait Row: Copy {
    /// The same number four times.
    fn splat(value: f64) -> Self;
    /// Numbers `at..at + 4`.
    fn load<const N: usize>(from: &[f64; N], at: usize) -> Self;
    /// Writes numbers `at..at + 4`.
    fn store<const N: usize>(self, to: &mut [f64; N], at: usize);
    /// Sum.
    fn add(self, other: Self) -> Self;
    /// Product, number by number.
    fn mul(self, other: Self) -> Self;
    /// `self` × `by` + `plus`, rounded once.
    fn mul_add(self, by: Self, plus: Self) -> Self;
    /// The larger of two; the second where they do not compare.
    fn max(self, other: Self) -> Self;
}

impl Row for Quad {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        [value; 4]
    }
    #[inline(always)]
    fn load<const N: usize>(from: &[f64; N], at: usize) -> Self {
        [from[at], from[at + 1], from[at + 2], from[at + 3]]
    }
    #[inline(always)]
    fn store<const N: usize>(self, to: &mut [f64; N], at: usize) {
        to[at..at + 4].copy_from_slice(&self);
    }
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        [self[0] + o[0], self[1] + o[1], self[2] + o[2], self[3] + o[3]]
    }
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        [self[0] * o[0], self[1] * o[1], self[2] * o[2], self[3] * o[3]]
    }
    #[inline(always)]
    fn mul_add(self, by: Self, plus: Self) -> Self {
        let mut result = plus;
        for k in 0..4 {
            result[k] = f64::mul_add(self[k], by[k], plus[k]);
        }
        result
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        let mut most = o;
        for k in 0..4 {
            most[k] = Lanes::max(self[k], o[k]);
        }
        most
    }
}

impl Lanes for f64 {
    const WIDTH: usize = 1;
    type Mask = bool;
    type Row = Quad;

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
    fn mul_add(self, by: Self, plus: Self) -> Self {
        f64::mul_add(self, by, plus)
    }
    #[inline(always)]
    fn mul_sub(self, by: Self, minus: Self) -> Self {
        f64::mul_add(self, by, -minus)
    }
    #[inline(always)]
    fn mul_sub_from(self, by: Self, from: Self) -> Self {
        f64::mul_add(-self, by, from)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn about_inverse_root(self) -> Self {
        f64::from_bits(ABOUT_INVERSE_ROOT - (self.to_bits() >> 1))
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
    fn are_below(number: &[u32; BLOCK], lane: usize, bound: usize) -> bool {
        (number[lane] as usize) < bound
    }
    #[inline(always)]
    fn rows(table: &[Quad], at: Rows<'_, Self>) -> V3<Self> {
        let [x, y, z, _] = table[at.number(0)];
        V3 { x, y, z }
    }
    #[inline(always)]
    fn difference(table: &[Quad], a: Rows<'_, Self>, b: Rows<'_, Self>) -> V3<Self> {
        Self::rows(table, a) - Self::rows(table, b)
    }
    #[inline(always)]
    fn relative(table: &[Octad], a: Rows<'_, Self>, b: Rows<'_, Self>) -> [V3<Self>; 2] {
        let (p, q) = (&table[a.number(0)].0, &table[b.number(0)].0);
        let velocity = V3 { x: p[0] - q[0], y: p[1] - q[1], z: p[2] - q[2] };
        [velocity, V3 { x: p[4] + q[4], y: p[5] + q[5], z: p[6] + q[6] }]
    }
    #[inline(always)]
    fn spins(table: &[Octad], at: Rows<'_, Self>) -> V3<Self> {
        let row = &table[at.number(0)].0;
        V3 { x: row[4], y: row[5], z: row[6] }
    }
    #[inline(always)]
    fn prefetch<T>(_: &[T], _: &[u32; BLOCK]) {}
    #[inline(always)]
    fn scatter<const TURN: bool, const LEVERS: bool>(
        c: [Self; 8],
        from: Rows<'_, Self>,
        to: Rows<'_, Self>,
        sums: &mut [Octad],
    ) {
        let second = &mut sums[to.number(0)].0;
        for k in 0..3 {
            second[k] += c[k];
            if TURN {
                second[4 + k] += if LEVERS { c[4 + k] * c[3] } else { c[4 + k] };
            }
        }
        let first = &mut sums[from.number(0) % CHUNK].0;
        for k in 0..3 {
            first[k] -= c[k];
            if TURN {
                first[4 + k] += if LEVERS { c[4 + k] * c[7] } else { c[4 + k] };
            }
        }
    }
}

/// 1/√x for positive x, to about 1e-15; large and finite for zero. Without root and division, which a processor has only
/// one unit for, and which other parts of the contact law keep busy.
#[inline(always)]
pub(crate) fn inverse_root<L: Lanes>(x: L) -> L {
    let (one, half, three) = (L::splat(1.0), L::splat(0.5), L::splat(0.375));
    // 1/√(1 − e) = 1 + e/2 + 3e²/8 + 5e³/16 + …
    let y = x.about_inverse_root();
    let e = (x * y).mul_sub_from(y, one);
    let y = e.mul_add(L::splat(0.3125), three).mul_add(e, half).mul_add(e * y, y);
    let e = (x * y).mul_sub_from(y, one);
    e.mul_add(three, half).mul_add(e * y, y)
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

    /// The same vector in every lane.
    #[inline(always)]
    pub(crate) fn row(v: &[f64; 3]) -> Self {
        Self::new(L::splat(v[0]), L::splat(v[1]), L::splat(v[2]))
    }

    /// The same number in every component and lane.
    #[inline(always)]
    pub(crate) fn splat(value: f64) -> Self {
        Self::new(L::splat(value), L::splat(value), L::splat(value))
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
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    /// Vector product.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            self.z.mul_sub_from(o.y, self.y * o.z),
            self.x.mul_sub_from(o.z, self.z * o.x),
            self.y.mul_sub_from(o.x, self.x * o.y),
        )
    }

    /// `self` − `a` × `b`.
    #[inline(always)]
    pub(crate) fn minus_cross(self, a: Self, b: Self) -> Self {
        Self::new(
            a.z.mul_add(b.y, a.y.mul_sub_from(b.z, self.x)),
            a.x.mul_add(b.z, a.z.mul_sub_from(b.x, self.y)),
            a.y.mul_add(b.x, a.x.mul_sub_from(b.y, self.z)),
        )
    }

    /// `self` × `by` − `less`.
    #[inline(always)]
    pub(crate) fn scale_less(self, by: L, less: Self) -> Self {
        Self::new(self.x.mul_sub(by, less.x), self.y.mul_sub(by, less.y), self.z.mul_sub(by, less.z))
    }

    /// `self` + `v` × `by`.
    #[inline(always)]
    pub(crate) fn plus(self, v: Self, by: L) -> Self {
        Self::new(v.x.mul_add(by, self.x), v.y.mul_add(by, self.y), v.z.mul_add(by, self.z))
    }

    /// `self` − `v` × `by`.
    #[inline(always)]
    pub(crate) fn minus(self, v: Self, by: L) -> Self {
        Self::new(v.x.mul_sub_from(by, self.x), v.y.mul_sub_from(by, self.y), v.z.mul_sub_from(by, self.z))
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
