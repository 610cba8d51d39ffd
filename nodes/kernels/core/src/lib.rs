//! Grains, cells, contacts and the quantities measured on them: the vocabulary that every kernel shares.
//!
//! SI units and `f64` throughout. Stress is positive in compression; strain (logarithmic) and its rate are
//! positive in extension. Voigt order is xx, yy, zz, yz, xz, xy with engineering shear in stiffnesses.
//! `e3 = z` is the axis of a scene.
//!
//! - `tensor`: small vectors and tensors
//! - `cell`: the periodic cell; [`sorted_into_bins`]: grains by their place in it
//! - `material`: the grain's material
//! - [`contact`]: the contact laws; [`lanes`]: the arithmetic they are written in
//! - [`instruction_sets`]: work compiled for those of the processor
//! - `packing`: grains, cell and contact network at one instant; [`contact_search`]: contacts by position
//!   ([`Packing::consistent`] holds its contacts against its positions)
//! - `path`: the position of a packing on the loading path of its run
//! - [`Packing::overlaps`]: how deep its contacts are, and up to which overlap a contact law holds
//! - [`solid_like_share`]: whether grains have the surroundings of a crystal
//! - [`Packing::crossings`]: whether contacts cross the cell everywhere, as in a periodic packing
//! - [`non_rattlers`], [`min_contacts`]: grains that carry force
//! - [`stress`]: the one definition of stress
//! - `stiffness`: the 6×6 elastic stiffness and its transversely isotropic projection
//! - `symmetry`: which symmetry a stiffness has, and about which axes
//! - `control`: what a loading path asks of each strain component, and the law that answers
//! - `waves`: plane waves in a medium, measured speeds of them
//! - [`results`]: what is measured on a packing
//! - [`notes`]: limitations of results, and reasons, as codes and sentences
//! - [`quantity`]: tables of what is measured: key, symbol, unit, meaning, value

mod bins;
mod bond_order;
mod cell;
mod consistency;
pub mod contact;
pub mod contact_search;
mod control;
mod crossings;
pub mod instruction_sets;
pub mod lanes;
mod law_comparison;
mod material;
pub mod notes;
mod overlaps;
mod packing;
mod path;
mod power;
pub mod quantity;
mod rattlers;
pub mod results;
mod stiffness;
pub mod stress;
mod symmetry;
mod tensor;
mod waves;

pub use bins::sorted_into_bins;
pub use bond_order::solid_like_share;
pub use cell::Cell;
pub use control::{ComponentControl, ServoLaw};
pub use crossings::Crossings;
pub use law_comparison::{LawComparison, OTHER_LAW};
pub use material::{Material, effective_radius};
pub use overlaps::{OVERLAP_LIMIT, Overlaps};
pub use packing::{Contact, Packing, PackingError};
pub use path::{EngineProgram, PathPosition, StrainOrigin};
pub use rattlers::{backbone, min_contacts, non_rattlers};
pub use stiffness::{Stiffness, TransverseIsotropy};
pub use symmetry::{Symmetry, SymmetryClass, symmetry};
pub use tensor::{Mat3, SymTensor, Vec3};
pub use waves::{MeasuredWave, PlaneWaves, WaveMethod, WaveSpeed};
