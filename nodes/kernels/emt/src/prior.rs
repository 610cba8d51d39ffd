//! Prior knowledge of the microstructure.
//!
//! - [`density`]: of one quantity; [`set`]: of all; [`file`]: in TOML
//! - [`quadrature`]: the moments of a normal density between limits

mod density;
mod error;
mod file;
mod quadrature;
mod set;

pub use density::Density;
pub use error::PriorError;
pub use set::Prior;
