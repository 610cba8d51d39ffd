//! Recorded signals of waves.

use grainlab_core::{Vec3, WaveMethod};

/// Traces of one wave: particle velocity at several receivers.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Unit direction of propagation.
    pub direction: Vec3,
    /// Unit polarization, sent and received.
    pub polarization: Vec3,
    /// Method of evaluation.
    pub method: WaveMethod,
    /// Dominant frequency, Hz.
    pub frequency: f64,
    /// Sampling rate, Hz.
    pub sample_rate: f64,
    /// Time of the first sample after the trigger, s.
    pub start: f64,
    /// Receivers, all with the same number of samples.
    pub channels: Vec<Channel>,
}

/// Signal of one receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Distance from the source along the ray, m.
    pub distance: f64,
    /// Particle velocity along the polarization, m/s.
    pub samples: Vec<f64>,
}
