//! What the present contacts show: stress, tangent stiffness, force balance.

mod contact_sums;
pub(crate) mod observables;
mod rattlers;
