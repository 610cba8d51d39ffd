//! Travel time of one wave between a source and a receiver, from what an oscilloscope recorded of both.
//!
//! Three features are picked in both records ([`crate::time_of_flight::ArrivalPick`]): the onset, the peak of the envelope, and the delay of largest
//! correlation. None of them arrives with the speed of long waves: dispersion, losses and the near field of the source shift each by an
//! amount of its own. So every pick is repeated in records that are computed for a path of known speed (`forward`), with the same source
//! signal, loss and noise: the mean difference is its bias, which is taken off, and the scatter its error. Dispersion and near field,
//! which a pair of records does not determine, are drawn from what packings and point sources have.
//!
//! Real records have trains of waves, of transducers that ring and of echoes, and a source of one mode also sends the other. Of P the first
//! wave that stands out of the noise is picked, by its first part, which is as long as the source. Of S the first strong wave that is not
//! P is picked (`distinct`, `chosen`). The others are faded out (`separated`). A shape unlike the computed arrivals, a sign that fits no
//! better than the other, and a signal just before a shear wave make the error larger. The onset is least affected by them.
//!
//! - `passage`: a record and its path; `cleaned`: checks, offset; `filter`: electronics; `band`: duration and frequency of the source
//! - `ambient`: the noise, its spectrum, and noise of the same kind for computed records
//! - `distinct`: the waves in a receiver; `chosen`: the one of the mode
//! - `separated`: the arrival without crosstalk; `forward`: computed records; `copies`: picks less their bias in computed copies;
//!   `pick`: a pick and its speed; `travel_time`: picks with their errors

#[cfg(test)]
#[path = "../tests/claims/computed_records.rs"]
mod computed_records;
#[cfg(test)]
mod taught;

mod ambient;
mod band;
mod chosen;
mod cleaned;
mod copies;
mod distinct;
mod filter;
mod forward;
mod passage;
mod pick;
mod separated;
mod travel_time;

pub use passage::{Passage, Record};
pub use pick::Pick;
pub use travel_time::{Picks, picks};
