//! Observation of the present contacts: stress, tangent stiffness, force balance; and the running energy balance.

pub(crate) mod contact_sums;
mod contact_works;
pub(crate) mod energy_meter;
pub(crate) mod observables;
mod pair_motion;
mod path_works;
mod rattlers;
