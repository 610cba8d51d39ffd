//! Time of a network in memory: virtual, or that of this host.

use super::alarm::Alarm;
use crate::wall_clock;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Virtual time zero as wall-clock time, ns since 1970.
const EPOCH_NANOS: u64 = 1_700_000_000_000_000_000;

#[derive(Debug)]
pub(super) enum Time {
    /// Advances only when a test or a waiting bus advances it.
    Virtual {
        now: Duration,
        /// Offset by which the wall clock was set, ns.
        wall_offset: i64,
    },
    /// Clocks of this host; the alarm ends a wait.
    Real { start: Instant, alarm: Arc<Alarm> },
}

impl Time {
    /// Time since the start of the network.
    pub(super) fn now(&self) -> Duration {
        match self {
            Self::Virtual { now, .. } => *now,
            Self::Real { start, .. } => start.elapsed(),
        }
    }

    /// Time from which a sample is in transit; in real time it arrives at once.
    pub(super) fn sent(&self) -> Duration {
        match self {
            Self::Virtual { now, .. } => *now,
            Self::Real { .. } => Duration::ZERO,
        }
    }

    /// Samples due until then have arrived: in real time all, which saves a look at the clock for each.
    pub(super) fn horizon(&self) -> Duration {
        match self {
            Self::Virtual { now, .. } => *now,
            Self::Real { .. } => Duration::MAX,
        }
    }

    /// Advances virtual time; real time does so by itself.
    pub(super) fn advance_to(&mut self, time: Duration) {
        if let Self::Virtual { now, .. } = self {
            *now = time.max(*now);
        }
    }

    /// Wall-clock time, ns since 1970.
    pub(super) fn wall_nanos(&self) -> u64 {
        match self {
            Self::Virtual { now, wall_offset } => {
                (EPOCH_NANOS + now.as_nanos() as u64).saturating_add_signed(*wall_offset)
            }
            Self::Real { .. } => wall_clock::wall_nanos(),
        }
    }

    /// Stamp of an arrival at `due`, ns since 1970; in real time that of the sample.
    pub(super) fn wall_at(&self, due: Duration) -> Option<u64> {
        matches!(self, Self::Virtual { .. }).then_some(EPOCH_NANOS + due.as_nanos() as u64)
    }

    pub(super) fn alarm(&self) -> Option<&Arc<Alarm>> {
        match self {
            Self::Virtual { .. } => None,
            Self::Real { alarm, .. } => Some(alarm),
        }
    }
}
