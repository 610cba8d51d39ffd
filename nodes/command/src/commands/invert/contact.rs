//! Contact laws that an inversion of speeds assumes.

use grainlab_emt::{ContactKind, SeriesPrior};

/// The contact law that is assumed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Contact {
    /// Not known: rough, blunt, linear or smooth, with an unknown level and k_t/k_n.
    Free,
    /// Smooth spheres of the given material.
    Hertz,
    /// A stiffness that does not depend on the force.
    Linear,
    /// Rough spheres (Otsubo et al. 2017).
    Rough,
}

impl Contact {
    pub(super) fn of(self, prior: &SeriesPrior) -> SeriesPrior {
        match self {
            Self::Free => prior.clone(),
            Self::Hertz => prior.of_law(ContactKind::Hertz),
            Self::Linear => prior.of_law(ContactKind::Linear),
            Self::Rough => prior.of_law(ContactKind::Rough),
        }
    }

    /// Text in the first line of an answer.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Free => {
                "free (laboratory): the contact law, k_t/k_n and the level of the moduli are inferred"
            }
            Self::Hertz => "hertz (ideal): smooth spheres of the given material",
            Self::Linear => "linear: a stiffness that does not depend on the force",
            Self::Rough => {
                "rough: rough spheres; roughness and k_t/k_n are inferred where they are not given"
            }
        }
    }
}
