//! Records of one wave, and the path between source and receiver.

use std::ops::Range;

/// Records of a source and a receiver at the same times.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Sampling rate, Hz.
    pub sample_rate: f64,
    /// Samples in which neither source nor receiver has a signal, which give offset and noise: those before the source starts.
    pub quiet: Range<usize>,
    /// Signal that drives the source, in any unit.
    pub source: Vec<f64>,
    /// Signal of the receiver, in any unit.
    pub receiver: Vec<f64>,
}

/// The path of a wave, and what the electronics add to its travel time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Distance between source and receiver, tip to tip, m.
    pub distance: f64,
    /// Standard deviation of the distance, m.
    pub distance_stddev: f64,
    /// Travel time of the system without a sample, s: source and receiver face to face.
    pub delay: f64,
    /// Standard deviation of the delay, s.
    pub delay_stddev: f64,
    /// Cut-off frequency (−3 dB) of the low-pass filter of the receiver, Hz; `None` without such a filter.
    pub lowpass: Option<f64>,
    /// Cut-off frequency (−3 dB) of the high-pass filter of the receiver, Hz; `None` without such a filter.
    pub highpass: Option<f64>,
    /// Number of poles of each (Butterworth), from 1 to 8.
    pub filter_order: u32,
    /// True if the receiver shows a wave with the opposite sign; `None`: not known.
    pub reversed: Option<bool>,
    /// Mean diameter of the grains, m, for dispersion.
    pub diameter: f64,
    /// True for motion along the path (P), false for motion across (S); `None`: not known.
    pub longitudinal: Option<bool>,
}
