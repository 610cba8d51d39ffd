//! Experiments as data: grains, material, numerics and a loading path, parsed from text.
//!
//! - `model`: the scene as a value
//! - `keys`: every key of the format, with unit, range and default; `reference`: the same as a page
//! - `compose`: bases and overrides; `pressure`: one for all phases; `assignment`: `KEY=VALUE`
//! - `parse`, `phases`, `servo`, `until`: a table to [`Scene`], with every fault reported at once
//! - `canonical`: the scene as text again
//! - `ends`: phases that cannot end; `notes`: what a reader should know ([`Scene::notes`])
//! - `path`: the loading path as a state machine; `phase_share`: how much of a phase is done, where its end is known
//!
//! A scene is data: the same text and seed always define the same run.

mod assignment;
mod built_in;
mod canonical;
mod compose;
mod contact;
mod ends;
mod fault;
mod grains;
mod key;
mod keys;
mod model;
mod nearest;
mod notes;
mod overlay;
mod parse;
mod path;
mod phase_share;
mod phases;
mod pressure;
mod reader;
mod record;
mod reference;
mod servo;
mod sizes;
mod start;
mod template;
mod until;

pub use assignment::assignment;
pub use built_in::{BUILT_IN, built_in};
pub use compose::{Draft, Library, Source};
pub use fault::{Fault, SceneError};
pub use key::{DefaultValue, Domain, Interval, Key};
pub use keys::{KEYS, MOST_GRAINS};
pub use model::{
    Condition, Conditions, GasMethod, Measure, Numerics, Phase, PhaseKind, Record, Scene, Start,
};
pub use parse::Resolved;
pub use path::{Observation, PathError, PathState, PhaseEnded};
pub use record::Travelled;
pub use reference::reference;
pub use sizes::{Sizes, Species};
pub use template::template;
