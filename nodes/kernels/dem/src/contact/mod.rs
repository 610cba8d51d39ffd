//! The contact law.

pub(crate) mod hertz_mindlin;
