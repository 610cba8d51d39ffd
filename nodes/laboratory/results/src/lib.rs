//! Results of a run as text, JSON and CSV: what `launch`, `analyze`, `probe`, `invert`, `campaign` and `reproduce` print.
//!
//! - [`quantities`]: values, columns and help from the tables of quantities; [`ORIGIN`], [`ACOUSTIC`]: two of the tables
//! - [`MeasuredPacking`], [`AcousticReport`], [`Probed`], [`Inference`]: one packing, its waves, and what a model infers
//! - [`Measurement`]: which of several measurements of a packing
//! - [`ProbeView`]: details of a strain probe
//! - [`Printed`], [`Printer`]: results one after the other; [`inference_text`]: results of models as text
//! - [`read_back`]: the results in a recording; [`continuity`]: the messages that it lacks
//! - [`posterior_draws`]: draws from a posterior as files
//! - [`findings`]: the same in sentences, with reasons to doubt
//! - [`Summary`]: a launched run; [`summary_text`]: all of it as text; [`brief`]: some 20 lines

mod acoustic;
mod acoustic_text;
pub mod brief;
pub mod continuity;
pub mod findings;
mod inference;
pub mod inference_text;
mod measured_packing;
mod measurements;
mod packing_text;
pub mod posterior_draws;
mod printer;
mod probe;
mod probed;
pub mod quantities;
pub mod read_back;
mod summary;
pub mod summary_text;

pub use acoustic::{ACOUSTIC, AcousticReport};
pub use inference::{Inference, Origin, by_origin};
pub use measured_packing::{MeasuredPacking, ORIGIN};
pub use measurements::Measurement;
pub use printer::{Printed, Printer};
pub use probe::ProbeView;
pub use probed::Probed;
pub use summary::{Launched, NodeEnd, Summary, TopicCount};
