//! Travel time of one wave between a source and a receiver, from what an oscilloscope recorded of both.
//!
//! Three features are picked in both records ([`crate::time_of_flight::ArrivalPick`]): the onset, the peak of the envelope, and the delay of largest
//! correlation. None of them arrives with the speed of long waves: dispersion, losses and the near field of the source shift each by an
//! amount of its own. So every pick is repeated in records that are computed for a path of known speed (`forward`), with the same source
//! signal, loss and noise: the mean difference is its bias, which is taken off, and the scatter its error. Dispersion and near field,
//! which a pair of records does not determine, are drawn from what packings and point sources have.

mod cleaned;
mod filter;
mod forward;
mod passage;
mod travel_time;

pub use passage::{Passage, Record};
pub use travel_time::{Pick, Picks, picks};
