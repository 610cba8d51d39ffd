//! Moduli from wave speeds.
//!
//! The particle motion p and speed v of a plane wave along the unit vector n solve Γ p = ρ v² p, with
//! Γ_ik = C_ijkl n_j n_l ([`grainlab_core::PlaneWaves`]).
//! In a medium that is isotropic about an axis, with θ between n and the axis, one mode moves across the plane of n and
//! axis, ρ v² = C66 sin²θ + C44 cos²θ, and two in that plane: ρ v² are the eigenvalues of
//!
//! ```text
//! | C11 sin²θ + C44 cos²θ    (C13 + C44) sin θ cos θ  |
//! | (C13 + C44) sin θ cos θ  C44 sin²θ + C33 cos²θ    |
//! ```
//!
//! P and S speeds along and across the axis thus give C33, C11, C44 and C66. C13, and with it the bulk modulus, needs a
//! speed in an oblique direction. Those depend on (C13 + C44)²; C13 + C44 > 0 is assumed, which holds in every packing.
//!
//! Moduli that the speeds do not determine are undetermined in the result. Overdetermined ones are a weighted
//! least-squares fit, and the result states how well the speeds agree. Several media may have the same
//! speeds, for example without P speeds along and across the axis; moduli in which they differ are
//! undetermined, too. A packing is not exactly isotropic about any axis: if the speeds scatter more than
//! their errors, but not more than those of a packing, they do not conflict, and the scatter is taken as
//! their error. The axis is given, or found by [`find_axis`] from speeds in enough directions. The density is
//! that of the mass that moves with the wave, without rattlers.

mod agreement;
mod axis;
mod axis_error;
mod departure;
mod determined;
mod error;
mod fit;
mod hemisphere;
mod prior_scatter;
mod profile;
mod ray;
mod search;
mod speed_fit;
mod weights;

pub use agreement::SpeedConflict;
pub use axis::{AxisEstimate, find_axis};
pub use axis_error::AxisError;
pub use error::ChristoffelError;
pub use speed_fit::{SpeedFit, moduli_from_speeds, moduli_of_sample};
