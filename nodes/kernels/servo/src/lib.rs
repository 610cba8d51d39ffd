//! Control laws: the strain rate for a stress.
//!
//! [`control`] is a pure function of one [`ServoInput`]. It has no state, so that a restarted servo, or one that
//! receives an input twice, returns the same output. Stress is positive in compression and strain rate in extension, so
//! that too much compression gives extension (Eq. 1 of La Ragione & Magnanimo, PRE 85, 031304, has its printed sign
//! with these conventions only). The six components, in Voigt order xx, yy, zz, yz, xz, xy, are controlled
//! independently.

mod check;
mod control;
mod error;
mod input;
mod law;
mod request;
mod stability;

pub use check::check_stability;
pub use control::control;
pub use error::ServoError;
pub use input::{ServoInput, ServoOutput};
pub use request::ServoRequest;
pub use stability::critical_gain;
