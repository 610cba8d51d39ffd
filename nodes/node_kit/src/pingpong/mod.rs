//! The lockstep's exchange and nothing else, over our bus and over bare ros2-client, so that one can be held against the
//! other in one run.
//!
//! Each function is one role of one process: the pinging side publishes a `Stress`, the answering side a `StrainRate` with
//! the same sequence. Writers are reliable, the partners read best effort and the pinging side repeats, as in the real
//! exchange. A listener stands for the recorder.

mod bare;
mod bus;

pub use bare::{bare_ping, bare_pong};
pub use bus::{bus_listen, bus_ping, bus_pong};

use grainlab_msgs::msg::{StrainRate, Stress};
use std::time::Duration;

/// Exchanges before the clock counts: discovery, first allocations.
const WARM_UP: u64 = 200;

/// A question not answered within this is asked again. Some hundred exchanges long: only a loss takes so long.
const REPEAT: Duration = Duration::from_millis(20);

/// An answering side that hears nothing for this long leaves.
const IDLE: Duration = Duration::from_secs(5);

/// A pinging side gives up on its partner after this.
const GIVE_UP: Duration = Duration::from_secs(30);

fn question(sequence: u64) -> Stress {
    let mut stress = Stress { sequence, ..Stress::default() };
    stress.header.frame_id = "cell".into();
    stress
}

fn answer(question: &Stress) -> StrainRate {
    StrainRate { header: question.header.clone(), sequence: question.sequence, ..StrainRate::default() }
}
