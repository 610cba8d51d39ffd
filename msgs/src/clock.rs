//! Simulated time and wall-clock time as ROS stamps.

use crate::builtin_interfaces::Time;

/// Stamp of simulated time 0, s. It is not 0, which viewers take for an unset stamp, and it is constant, so that runs that
/// are repeated record the same messages.
pub const EPOCH_SECONDS: i32 = 1_000_000_000;

const NANOS: f64 = 1e9;

/// The stamp of a simulated time in seconds: 10⁹ s later, rounded to 1 ns. Times later
/// than 36 years or earlier than −99 years give the last or the first possible stamp; NaN gives that of time 0.
///
/// ```
/// let t = grainlab_msgs::stamp(0.25);
/// assert_eq!((t.sec, t.nanosec), (1_000_000_000, 250_000_000));
/// ```
pub fn stamp(simulated_seconds: f64) -> Time {
    // `as` saturates, and turns NaN into 0.
    let whole = simulated_seconds.floor();
    let nanos = ((simulated_seconds - whole) * NANOS).round() as i64;
    let total = (whole as i64).saturating_add(i64::from(EPOCH_SECONDS)).saturating_add(nanos / 1_000_000_000);
    match i32::try_from(total) {
        Ok(sec) => Time { sec, nanosec: (nanos % 1_000_000_000) as u32 },
        Err(_) if total < 0 => Time { sec: i32::MIN, nanosec: 0 },
        Err(_) => Time { sec: i32::MAX, nanosec: 999_999_999 },
    }
}

/// The simulated time of a stamp, s: the inverse of [`stamp`] to half a nanosecond.
pub fn simulated_seconds(stamp: &Time) -> f64 {
    (i64::from(stamp.sec) - i64::from(EPOCH_SECONDS)) as f64 + f64::from(stamp.nanosec) / NANOS
}

/// Wall-clock time, ns since 1970, as a ROS stamp; the last possible one after 2038.
pub fn wall_stamp(wall_nanos: u64) -> Time {
    let sec = i32::try_from(wall_nanos / 1_000_000_000).unwrap_or(i32::MAX);
    Time { sec, nanosec: (wall_nanos % 1_000_000_000) as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fraction_that_rounds_up_carries_into_the_seconds() {
        assert_eq!(stamp(1.999_999_999_9), Time { sec: EPOCH_SECONDS + 2, nanosec: 0 });
    }

    #[test]
    fn times_before_the_epoch_keep_nanoseconds_positive() {
        assert_eq!(stamp(-0.25), Time { sec: EPOCH_SECONDS - 1, nanosec: 750_000_000 });
    }

    #[test]
    fn times_without_a_stamp_saturate() {
        assert_eq!(stamp(f64::NAN), Time { sec: EPOCH_SECONDS, nanosec: 0 });
        assert_eq!(stamp(f64::INFINITY).sec, i32::MAX);
        assert_eq!(stamp(1e300).sec, i32::MAX);
        assert_eq!(stamp(f64::NEG_INFINITY).sec, i32::MIN);
        assert_eq!(stamp(-1e300).sec, i32::MIN);
    }

    #[test]
    fn a_stamp_gives_the_time_back_to_half_a_nanosecond() {
        for t in [0.0, 1.234_567_891_234e-3, 17.5, 3_600.000_000_001] {
            // 0.5 ns of rounding, and the spacing of f64 near an hour, 5e-13 s.
            assert!((simulated_seconds(&stamp(t)) - t).abs() <= 0.5e-9 + 1e-12, "{t}");
        }
    }
}
