//! Amplitudes of three waves that are computed together.

use std::ops::{Add, AddAssign, Mul, Sub};

/// Number of waves computed together.
pub(crate) const WAVES: usize = 3;

const LANES: usize = WAVES + 1;

/// One number per wave, and a zero to fill a vector register.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub(crate) struct Row(pub(crate) [f64; LANES]);

impl Row {
    pub(crate) const ZERO: Row = Row([0.0; LANES]);

    #[inline(always)]
    pub(crate) fn of(waves: [f64; WAVES]) -> Self {
        Self([waves[0], waves[1], waves[2], 0.0])
    }

    #[inline(always)]
    pub(crate) fn waves(self) -> [f64; WAVES] {
        [self.0[0], self.0[1], self.0[2]]
    }
}

macro_rules! by_wave {
    ($trait:ident, $function:ident, $operator:tt) => {
        impl $trait for Row {
            type Output = Row;
            #[inline(always)]
            fn $function(self, other: Row) -> Row {
                let (a, b) = (self.0, other.0);
                Row([a[0] $operator b[0], a[1] $operator b[1], a[2] $operator b[2], a[3] $operator b[3]])
            }
        }
    };
}
by_wave!(Add, add, +);
by_wave!(Sub, sub, -);
by_wave!(Mul, mul, *);

impl Mul<Row> for f64 {
    type Output = Row;
    #[inline(always)]
    fn mul(self, row: Row) -> Row {
        Row([self; LANES]) * row
    }
}

impl AddAssign for Row {
    #[inline(always)]
    fn add_assign(&mut self, other: Row) {
        *self = *self + other;
    }
}

/// Amplitudes of one grain for all waves, rows w_x, w_y, w_z, φ_x, φ_y, φ_z, or the conjugate forces: real and
/// imaginary parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Amplitude {
    pub(crate) re: [Row; 6],
    pub(crate) im: [Row; 6],
}

impl Amplitude {
    pub(crate) const STILL: Amplitude = Amplitude { re: [Row::ZERO; 6], im: [Row::ZERO; 6] };

    #[inline(always)]
    pub(crate) fn add(&mut self, share: Row, x: &Amplitude) {
        for k in 0..6 {
            self.re[k] += share * x.re[k];
            self.im[k] += share * x.im[k];
        }
    }
}

/// One block of waves: an amplitude per grain.
pub(crate) type Block = Vec<Amplitude>;

/// Real parts of x* y, for each wave.
#[inline(always)]
pub(crate) fn products(x: &[Amplitude], y: &[Amplitude]) -> [f64; WAVES] {
    let mut sum = Row::ZERO;
    for (x, y) in x.iter().zip(y) {
        for k in 0..6 {
            sum += x.re[k] * y.re[k] + x.im[k] * y.im[k];
        }
    }
    sum.waves()
}
