//! What the present contacts show: stress, tangent stiffness, force balance; and the running energy balance.

mod contact_sums;
pub(crate) mod energy;
pub(crate) mod observables;
mod rattlers;
