//! One exchange and its time limits.

use grainlab_msgs::msg::{StrainRate, Stress};
use std::time::Duration;

/// Number of exchanges before the measurement: discovery, first allocations.
pub(super) const WARM_UP: u64 = 200;

/// A request without an answer after this time is repeated. Some hundred exchanges long: only a loss takes this long.
pub(super) const REPEAT: Duration = Duration::from_millis(20);

/// The answering side ends if no request arrives for this long.
pub(super) const IDLE: Duration = Duration::from_secs(5);

/// The requesting side ends if no answer arrives for this long.
pub(super) const GIVE_UP: Duration = Duration::from_secs(30);

pub(super) fn question(sequence: u64) -> Stress {
    let mut stress = Stress { sequence, ..Stress::default() };
    stress.header.frame_id = "cell".into();
    stress
}

pub(super) fn answer(question: &Stress) -> StrainRate {
    StrainRate { header: question.header.clone(), sequence: question.sequence, ..StrainRate::default() }
}
