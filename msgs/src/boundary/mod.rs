//! Conversion between messages and types of the kernels. A decoded message is not yet valid: everything
//! received is checked here, once. An invalid message is refused with an error that names field, value and
//! requirement. Published messages pass the same checks, so that no node publishes a message that another one
//! refuses.

mod check;
mod contact_statistics;
mod earlier_path;
mod elastic_stiffness;
mod error;
mod estimate;
mod fabric;
mod microstructure;
mod moduli;
mod note;
mod packing;
mod packing_report;
mod run_state;
mod strain_rate;
mod stress;
mod stress_decomposition;
mod symmetry;
mod wave_speeds;
mod waveform;

pub use check::vector_message;
pub use error::BoundaryError;
pub use estimate::estimate_message;
pub use moduli::ModuliReading;
pub use packing::{packing_header, packing_message};
pub use packing_report::packing_report_message;
pub use wave_speeds::{WaveSpeedsReading, wave_speeds_message};
