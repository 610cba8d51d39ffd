//! Contact laws.

pub(crate) mod tangential;
