//! Microstructure: the result of an inversion.

use super::contact_statistics::ContactStatistics;
use super::fabric::Fabric;
use nalgebra::SMatrix;
use std::fmt;

/// Names of the inputs of an inversion, in the order of their shares in an estimate.
pub const INFERENCE_INPUTS: [&str; 13] = [
    "G12",
    "G13",
    "Theta",
    "C11",
    "C33",
    "C13",
    "pressure",
    "gamma/Delta",
    "solid fraction",
    "q/p",
    "size spread",
    "grain shear modulus",
    "grain Poisson ratio",
];

/// A covariance of the quantities, in the order of [`InferredQuantity::ALL`]; rows and columns of undetermined
/// quantities are zero.
pub type MicrostructureCovariance = SMatrix<f64, { InferredQuantity::COUNT }, { InferredQuantity::COUNT }>;

/// Defines [`InferredQuantity`], [`Microstructure`] and what is said of each quantity. One row: variant, field (also the key in
/// messages, JSON and CSV), name in text, symbol, decimal places, meaning, value counted in a packing.
macro_rules! inferred_quantities {
    ($($(#[$doc:meta])* $variant:ident $field:ident $text:literal $symbol:literal $digits:literal $meaning:literal |$c:pat_param, $f:pat_param| $counted:expr;)+) => {
        /// One number of the microstructure, dimensionless.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum InferredQuantity {
            $($(#[$doc])* $variant,)+
        }

        impl InferredQuantity {
            /// All of them, in the order of every array and matrix.
            pub const ALL: [InferredQuantity; InferredQuantity::COUNT] = [$(InferredQuantity::$variant,)+];

            /// Number of quantities.
            pub const COUNT: usize = [$($digits,)+].len();

            /// Key in messages, tables and files.
            pub const fn name(self) -> &'static str {
                match self { $(InferredQuantity::$variant => stringify!($field),)+ }
            }

            /// Name in text, of ASCII.
            pub const fn text(self) -> &'static str {
                match self { $(InferredQuantity::$variant => $text,)+ }
            }

            /// Symbol of the field.
            pub const fn symbol(self) -> &'static str {
                match self { $(InferredQuantity::$variant => $symbol,)+ }
            }

            /// Meaning in a few words.
            pub const fn meaning(self) -> &'static str {
                match self { $(InferredQuantity::$variant => $meaning,)+ }
            }

            /// Decimal places that are printed.
            pub const fn digits(self) -> usize {
                match self { $(InferredQuantity::$variant => $digits,)+ }
            }

            /// Value counted in a packing; `None` where it is undefined or cannot be counted.
            pub fn counted(self, contacts: &ContactStatistics, fabric: &Fabric) -> Option<f64> {
                match self { $(InferredQuantity::$variant => { let ($c, $f) = (contacts, fabric); $counted })+ }
            }
        }

        /// Microstructure: what a model infers, or predicts from. `None` is undetermined, or not part of the model.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Microstructure {
            $($(#[$doc])* pub $field: Option<f64>,)+
        }

        impl Microstructure {
            /// In the order of [`InferredQuantity::ALL`].
            pub const fn values(&self) -> [Option<f64>; InferredQuantity::COUNT] {
                [$(self.$field,)+]
            }

            /// From the order of [`InferredQuantity::ALL`].
            pub const fn of_values([$($field,)+]: [Option<f64>; InferredQuantity::COUNT]) -> Self {
                Self { $($field,)+ }
            }
        }
    };
}

inferred_quantities! {
    /// Coordination number k: twice the contacts over all grains.
    K k "k" "k" 3 "coordination number" |c, _| Some(c.coordination);
    /// Coordination number k̂ of the equivalent isotropic packing, in the sense of the calibration.
    KHat k_hat "k_hat" "k̂" 3 "coordination number of the equivalent isotropic packing" |_, _| None;
    /// Coordination number z of the grains without rattlers.
    Z z "z" "z" 3 "coordination without rattlers" |c, _| Some(c.mechanical_coordination);
    /// Anisotropy ε of the number of contacts about the axis, Eq. 6.
    Eps eps "eps" "ε" 4 "contact anisotropy" |_, f| Some(f.contact_anisotropy);
    /// Anisotropy ε_k of the contacts about the axis, each weighted by its normal stiffness.
    EpsStiffness eps_stiffness "eps_k" "ε_k" 4 "anisotropy weighted by stiffness"
        |c, f| (c.contacts > 0).then(|| f.stiffness_anisotropy());
}

impl InferredQuantity {
    /// Those that can be counted in a packing.
    pub fn countable() -> impl Iterator<Item = Self> + Clone {
        Self::ALL.into_iter().filter(|q| *q != InferredQuantity::KHat)
    }

    /// True if errors are given relative to the value: for coordination numbers, and not for anisotropies.
    pub const fn is_coordination(self) -> bool {
        matches!(self, InferredQuantity::K | InferredQuantity::KHat | InferredQuantity::Z)
    }
}

impl fmt::Display for InferredQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Microstructure {
    /// The quantities of the paper's models.
    pub const fn paper(k: f64, k_hat: f64, eps: f64) -> Self {
        Self { k: Some(k), k_hat: Some(k_hat), z: None, eps: Some(eps), eps_stiffness: None }
    }

    /// This microstructure with another value of one quantity.
    #[must_use]
    pub const fn with(self, quantity: InferredQuantity, value: f64) -> Self {
        let mut values = self.values();
        values[quantity as usize] = Some(value);
        Self::of_values(values)
    }

    /// Value of one quantity.
    pub const fn get(&self, quantity: InferredQuantity) -> Option<f64> {
        self.values()[quantity as usize]
    }
}
