//! The known moduli of a transversely isotropic medium.

use grainlab_core::TransverseIsotropy;
use nalgebra::{RowSVector, SMatrix};
use std::fmt;

/// Number of [`Modulus`]es.
pub const MODULI: usize = 6;

/// A covariance of the moduli in the order of [`Modulus::ALL`], Pa²; zero where one is not known.
pub type ModuliCovariance = SMatrix<f64, MODULI, MODULI>;

/// A modulus of a medium that is isotropic about e3. The last five fix the medium; 9 Θ = 4 C11 − 4 G12 + 4 C13 + C33.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Modulus {
    /// Shear in the plane of isotropy, C66.
    G12,
    /// Shear along the axis, C44.
    G13,
    /// Voigt bulk modulus C_iijj/9.
    Theta,
    /// P modulus across the axis.
    C11,
    /// P modulus along the axis.
    C33,
    /// Off-diagonal modulus C13.
    C13,
}

impl Modulus {
    /// All of them, in the order of every array and matrix.
    pub const ALL: [Modulus; MODULI] =
        [Modulus::G12, Modulus::G13, Modulus::Theta, Modulus::C11, Modulus::C33, Modulus::C13];

    /// Symbol of the modulus.
    pub const fn name(self) -> &'static str {
        match self {
            Modulus::G12 => "G12",
            Modulus::G13 => "G13",
            Modulus::Theta => "Theta",
            Modulus::C11 => "C11",
            Modulus::C33 => "C33",
            Modulus::C13 => "C13",
        }
    }

    /// Weight in 4 C11 − 4 G12 + 4 C13 + C33 − 9 Θ = 0.
    const fn in_relation(self) -> f64 {
        match self {
            Modulus::G12 => -4.0,
            Modulus::G13 => 0.0,
            Modulus::Theta => -9.0,
            Modulus::C11 | Modulus::C13 => 4.0,
            Modulus::C33 => 1.0,
        }
    }
}

impl fmt::Display for Modulus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Moduli, Pa; `None`: not known, or not predicted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moduli([Option<f64>; MODULI]);

impl Moduli {
    /// Moduli that are all unknown.
    pub const NONE: Moduli = Moduli([None; MODULI]);

    /// The three moduli of the paper, Pa.
    pub const fn paper(g12: f64, g13: f64, theta: f64) -> Self {
        Self([Some(g12), Some(g13), Some(theta), None, None, None])
    }

    /// All six of a medium.
    pub fn of_medium(t: &TransverseIsotropy) -> Self {
        let theta = (4.0 * t.c11 - 4.0 * t.g12 + 4.0 * t.c13 + t.c33) / 9.0;
        Self([t.g12, t.g13, theta, t.c11, t.c33, t.c13].map(Some))
    }

    /// In the order of [`Modulus::ALL`].
    pub const fn values(&self) -> [Option<f64>; MODULI] {
        self.0
    }

    /// From the order of [`Modulus::ALL`].
    pub const fn of_values(values: [Option<f64>; MODULI]) -> Self {
        Self(values)
    }

    /// One of them, Pa.
    pub const fn get(&self, modulus: Modulus) -> Option<f64> {
        self.0[modulus as usize]
    }

    /// Moduli with this one, Pa, added.
    #[must_use]
    pub const fn with(mut self, modulus: Modulus, value: f64) -> Self {
        self.0[modulus as usize] = Some(value);
        self
    }

    /// Moduli without this one.
    #[must_use]
    pub const fn without(mut self, modulus: Modulus) -> Self {
        self.0[modulus as usize] = None;
        self
    }

    /// The known ones.
    pub fn known(&self) -> impl Iterator<Item = (Modulus, f64)> + '_ {
        Modulus::ALL.into_iter().filter_map(|m| Some((m, self.get(m)?)))
    }

    /// 4 C11 − 4 G12 + 4 C13 + C33 − 9 Θ over 9 Θ, which is 0 in a medium; `None` unless all five are known.
    pub fn imbalance(&self) -> Option<f64> {
        let related = Modulus::ALL.into_iter().filter(|m| m.in_relation() != 0.0);
        let sum = related.map(|m| Some(m.in_relation() * self.get(m)?)).sum::<Option<f64>>()?;
        Some(sum / (9.0 * self.get(Modulus::Theta)?))
    }

    /// Standard deviation of [`Moduli::imbalance`] by the errors of the moduli; `None` unless all five are known.
    pub(crate) fn imbalance_stddev(&self, covariance: &ModuliCovariance) -> Option<f64> {
        let row: RowSVector<f64, MODULI> = RowSVector::from_fn(|_, j| Modulus::ALL[j].in_relation());
        let variance = (row * covariance * row.transpose())[0].max(0.0);
        Some(variance.sqrt() / (9.0 * self.get(Modulus::Theta)?))
    }

    /// Moduli with the one that follows from the others, and its covariance with them.
    #[must_use]
    pub(crate) fn completed(
        mut self,
        mut covariance: Option<ModuliCovariance>,
    ) -> (Self, Option<ModuliCovariance>) {
        let mut missing =
            Modulus::ALL.into_iter().filter(|m| m.in_relation() != 0.0 && self.get(*m).is_none());
        let (Some(target), None) = (missing.next(), missing.next()) else { return (self, covariance) };
        let at = target as usize;
        let row: RowSVector<f64, MODULI> = RowSVector::from_fn(|_, j| {
            if j == at { 0.0 } else { -Modulus::ALL[j].in_relation() / target.in_relation() }
        });
        self.0[at] = Some((0..MODULI).map(|j| row[j] * self.0[j].unwrap_or(0.0)).sum());
        if let Some(c) = &mut covariance {
            let with_others = row * *c;
            c.set_row(at, &with_others);
            c.set_column(at, &with_others.transpose());
            c[(at, at)] = (with_others * row.transpose())[0];
        }
        (self, covariance)
    }

    /// True if no medium has these moduli, by more than so many standard deviations of their errors: some strain would cost no
    /// energy. Considers the known ones of C11, C33, C13 and G12.
    pub fn unstable(&self, covariance: Option<&ModuliCovariance>, sigmas: f64) -> bool {
        let [c11, c33, c13, g12] =
            [Modulus::C11, Modulus::C33, Modulus::C13, Modulus::G12].map(|m| self.get(m));
        let beyond = |margin: f64, slopes: [f64; MODULI]| {
            let row = RowSVector::from(slopes);
            let variance = covariance.map_or(0.0, |c| (row * c * row.transpose())[0].max(0.0));
            margin <= -sigmas * variance.sqrt()
        };
        let plane = c11.zip(g12).is_some_and(|(c11, g12)| beyond(c11 - g12, [-1.0, 0.0, 0.0, 1.0, 0.0, 0.0]));
        let axial = c11.zip(g12).zip(c33.zip(c13)).is_some_and(|((c11, g12), (c33, c13))| {
            // Strain E along the axis while the stress across it does no work: C33 (C11 + C12)/2 > C13².
            beyond(c33 * (c11 - g12) - c13 * c13, [-c33, 0.0, 0.0, c33, c11 - g12, -2.0 * c13])
        });
        plane || axial
    }
}
