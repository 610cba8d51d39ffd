//! One exchange, and the times that bound it.

use grainlab_msgs::msg::{StrainRate, Stress};
use std::time::Duration;

/// Exchanges before the clock counts: discovery, first allocations.
pub(super) const WARM_UP: u64 = 200;

/// A question not answered within this is asked again. Some hundred exchanges long: only a loss takes so long.
pub(super) const REPEAT: Duration = Duration::from_millis(20);

/// An answering side that hears nothing for this long leaves.
pub(super) const IDLE: Duration = Duration::from_secs(5);

/// A pinging side gives up on its partner after this.
pub(super) const GIVE_UP: Duration = Duration::from_secs(30);

pub(super) fn question(sequence: u64) -> Stress {
    let mut stress = Stress { sequence, ..Stress::default() };
    stress.header.frame_id = "cell".into();
    stress
}

pub(super) fn answer(question: &Stress) -> StrainRate {
    StrainRate { header: question.header.clone(), sequence: question.sequence, ..StrainRate::default() }
}
