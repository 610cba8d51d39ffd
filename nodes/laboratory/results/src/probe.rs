//! Details of an explicit probe, for the results of `grainlab analyze`.

use serde::Serialize;

/// One probe: all six columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeView {
    /// Amplitude of the strain.
    pub amplitude: f64,
    /// Largest |C_ab - C_ba| over the largest entry of C.
    pub asymmetry: f64,
    /// Total number of solver steps.
    pub steps: u32,
    /// Contacts that opened, formed, or were at the Coulomb limit under either strain, over all columns.
    pub opened: u32,
    /// Contacts that formed; see `opened`.
    pub closed: u32,
    /// Contacts at the Coulomb limit; see `opened`.
    pub sliding: u32,
    /// Largest difference between the forward and the backward column, relative to the largest entry.
    pub forward_backward: Option<f64>,
    /// Largest standard error over the largest entry of C.
    pub error: f64,
}
