//! Contact laws: one file each, and the list of them.
//!
//! A law is its springs ([`ContactSprings`]). Dashpots, tangential history and the Coulomb limit are the same for all
//! ([`SpringDashpotSlider`]).

mod hertz_mindlin;
mod law;
mod linear;
mod spring_dashpot_slider;
mod springs;
mod tangential;

pub use hertz_mindlin::HertzMindlin;
pub use law::{ContactLaw, LawVisitor, UnknownLaw};
pub use linear::Linear;
pub use spring_dashpot_slider::{ContactForces, ContactKinematics, HistoryStep, SpringDashpotSlider};
pub use springs::ContactSprings;
pub use tangential::TangentialLaw;
