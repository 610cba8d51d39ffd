//! The commands, one module each.

pub(crate) mod analyze;
pub(crate) mod bag;
#[cfg(feature = "studio")]
pub(crate) mod calibrate;
#[cfg(feature = "studio")]
pub(crate) mod campaign;
pub(crate) mod completions;
pub(crate) mod invert;
pub(crate) mod launch;
pub(crate) mod man;
#[cfg(feature = "studio")]
pub(crate) mod new;
pub(crate) mod packings;
pub(crate) mod pick;
pub(crate) mod probe;
#[cfg(feature = "studio")]
pub(crate) mod report;
#[cfg(feature = "studio")]
pub(crate) mod reproduce;
pub(crate) mod run;
pub(crate) mod scene;
#[cfg(feature = "studio")]
pub(crate) mod view;
