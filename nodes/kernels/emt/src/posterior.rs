//! The posterior of the microstructure, by integration and by independent draws.
//!
//! The unknowns are two or three, and the posterior has one mode where the data say anything. Points from a mixture of two
//! normal distributions about it, quasi-random and weighted by posterior over proposal, give the evidence and every
//! expectation. Draws are made by rejection from the same mixture: independent of each other, and repeatable by their seed, so
//! that no chain has to converge. Where a weight exceeds the envelope, it is raised and all draws are made anew.
//!
//! - [`target`]: likelihood and prior; [`proposal`]: the mixture; [`halton`]: quasi-random points
//! - [`draws`]: draws; [`evidence`]: the marginal likelihood; [`check`]: the observation against its prediction

mod check;
mod draws;
mod evidence;
mod halton;
mod points;
mod proposal;
mod target;

pub use check::{Check, ModulusCheck};
pub use draws::{Draw, Draws};
pub use evidence::Evidence;
pub use points::{Posterior, PosteriorSettings};
