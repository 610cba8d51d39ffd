//! The stiffness of a packing, its bounds, and how it was found.

use crate::OVERLAP_LIMIT;
use crate::notes::Note;
use crate::stiffness::Stiffness;
use std::fmt;

/// Method by which a stiffness was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StiffnessMethod {
    /// Linear response of the frozen contact network: normal springs and, unless it is smooth, tangential ones; no rolling
    /// springs.
    FrozenNetwork,
    /// The frozen network with the prestress term.
    PrestressedNetwork,
    /// Small strains imposed on the packing with its whole contact law.
    StrainProbe,
}

impl StiffnessMethod {
    /// All of them.
    pub const ALL: [StiffnessMethod; 3] = [Self::FrozenNetwork, Self::PrestressedNetwork, Self::StrainProbe];

    /// As tables and files name it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::FrozenNetwork => "frozen_network",
            Self::PrestressedNetwork => "prestressed_network",
            Self::StrainProbe => "probe",
        }
    }
}

/// The elastic stiffness of a packing, in the frame of the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticStiffness {
    /// Method by which [`ElasticStiffness::tensor`] was found.
    pub method: StiffnessMethod,
    /// No contact has a tangential spring: that of smooth grains.
    pub smooth: bool,
    /// The stiffness: grains relax under the strain.
    pub tensor: Stiffness,
    /// Error of the solver in each entry, Pa, as a standard deviation: what the solve or the probe left open, estimated from
    /// above. How much packings of one kind differ is not in it.
    pub stddev: Stiffness,
    /// Relative residual of the solve, or of the probe's relaxation; the worst of the six columns.
    pub residual: f64,
    /// Iterations of the solve, or steps of the probe.
    pub iterations: u32,
    /// Stiffnesses of the contact network in closed form, whatever the method.
    pub bounds: StiffnessBounds,
}

/// Closed-form bounds of the stiffness by the contact network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StiffnessBounds {
    /// Affine (Voigt) stiffness: every grain moves with the mean deformation.
    pub affine: Stiffness,
    /// Affine stiffness where all grains also rotate alike: between relaxed and affine.
    pub uniform_rotation: Stiffness,
    /// Lower bound of the bulk modulus under isotropic stress, Pa; `None` without forces.
    pub bulk_reuss: Option<f64>,
}

/// The stiffness of a packing, or why it has none.
pub type Elasticity = Result<Box<ElasticStiffness>, NoStiffness>;

/// Why a packing has no stiffness. [`NoStiffness::is_fault`] tells what is wrong from what is loose: a gas has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoStiffness {
    /// No two grains touch.
    NoContacts {
        /// Number of grains.
        grains: usize,
    },
    /// Every grain was removed as a rattler.
    OnlyRattlers {
        /// Number of grains.
        grains: usize,
        /// Contacts that a grain needs in order to carry force.
        needed: u32,
    },
    /// Contacts exist but resist no deformation of the cell.
    Floppy {
        /// Number of contacts.
        contacts: usize,
    },
    /// Grains overlap by more than [`OVERLAP_LIMIT`](crate::OVERLAP_LIMIT): no contact law holds.
    TooDeep,
    /// The stiffness could not be computed, or the result was withheld.
    Unsolved,
}

impl From<&NoStiffness> for Note {
    fn from(reason: &NoStiffness) -> Self {
        match *reason {
            NoStiffness::NoContacts { grains } => Note::no_contacts(grains as f64),
            NoStiffness::OnlyRattlers { grains, needed } => {
                Note::only_rattlers(grains as f64, f64::from(needed))
            }
            NoStiffness::Floppy { contacts } => Note::floppy(contacts as f64),
            NoStiffness::TooDeep => Note::too_deep(OVERLAP_LIMIT),
            NoStiffness::Unsolved => Note::unsolved(),
        }
    }
}

impl std::error::Error for NoStiffness {}

impl fmt::Display for NoStiffness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Note::from(self).fmt(f)
    }
}

impl NoStiffness {
    /// Returns true if the packing or its measurement is at fault, rather than loose or open.
    pub fn is_fault(&self) -> bool {
        matches!(self, Self::TooDeep | Self::Unsolved)
    }
}
