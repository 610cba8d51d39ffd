//! The commands, one module each.

pub(crate) mod analyze;
pub(crate) mod bag;
pub(crate) mod calibrate;
pub(crate) mod campaign;
pub(crate) mod completions;
pub(crate) mod invert;
pub(crate) mod launch;
pub(crate) mod man;
pub(crate) mod packings;
pub(crate) mod probe;
pub(crate) mod report;
pub(crate) mod reproduce;
pub(crate) mod run;
pub(crate) mod scene;
pub(crate) mod verify;
pub(crate) mod view;
