//! A pick of an arrival, and its speed.

use super::passage::Passage;
use grainlab_core::WaveMethod;

/// Share of the variance of a time that records of one path and mode have in common.
///
/// The share is 0.3 if the transducers do not ring, and 1 if they ring.
/// `records_of_one_path_have_less_in_common_than_is_stated_and_more_if_the_transducers_ring` tests that this constant is between.
pub(super) const COMMON_VARIANCE_SHARE: f64 = 0.5;

/// The travel time of long waves by one pick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// The feature that was picked.
    pub method: WaveMethod,
    /// Travel time without the delay of the system and without the bias, s.
    pub time: f64,
    /// Standard deviation of the time, s.
    pub time_stddev: f64,
    /// Bias that was taken off: the feature arrives this much later than long waves, s.
    pub bias: f64,
    /// Speed of long waves, m/s.
    pub speed: f64,
    /// Standard deviation of the speed, m/s, with the errors of distance and delay.
    pub speed_stddev: f64,
    /// Part of it that the records of one path and mode share, m/s: distance, delay, and half of the variance of the time but for what
    /// contradictory picks add.
    pub speed_common_stddev: f64,
    /// Part of the error of the time by which contradictory picks differ, s.
    pub(super) apart: f64,
    /// What the constants of `TAUGHT` multiply, s.
    pub(super) causes: [f64; 4],
}

impl Pick {
    /// Creates the pick of a feature after the time `read`, s, less its bias, s, without a speed.
    pub(super) fn new(method: WaveMethod, read: f64, [bias, time_stddev]: [f64; 2]) -> Self {
        let [speed, speed_stddev, speed_common_stddev, apart] = [0.0; 4];
        let (time, causes) = (read - bias, [0.0; 4]);
        Self { method, time, time_stddev, bias, speed, speed_stddev, speed_common_stddev, apart, causes }
    }

    pub(super) fn with_error(self, time_stddev: f64, passage: &Passage) -> Self {
        let speed = passage.distance / self.time;
        let error_of_speed = |time_stddev: f64| {
            let relative = time_stddev.hypot(passage.delay_stddev) / self.time;
            speed * relative.hypot(passage.distance_stddev / passage.distance)
        };
        let common = COMMON_VARIANCE_SHARE * (time_stddev.powi(2) - self.apart.powi(2));
        Self {
            time_stddev,
            speed,
            speed_stddev: error_of_speed(time_stddev),
            speed_common_stddev: error_of_speed(common.max(0.0).sqrt()),
            ..self
        }
    }

    /// Part of the standard deviation of the speed that is of this record alone, m/s.
    pub fn speed_own_stddev(&self) -> f64 {
        (self.speed_stddev.powi(2) - self.speed_common_stddev.powi(2)).max(0.0).sqrt()
    }
}
