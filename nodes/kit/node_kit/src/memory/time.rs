//! Time of a network in memory: virtual, or that of this host.

use super::alarm::Alarm;
use crate::dds;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Virtual time zero as wall-clock time, ns since 1970.
const EPOCH_NANOS: u64 = 1_700_000_000_000_000_000;

/// Virtual time, which advances only when a test or a waiting bus advances it, or real time.
#[derive(Debug, Default)]
pub(super) struct Time {
    /// Virtual time. Zero in real time, where samples arrive at once, so that the clock is not read for each.
    pub(super) transit: Duration,
    /// Offset by which the virtual wall clock was set, ns.
    pub(super) wall_offset: i64,
    /// Begin of real time, and what ends a wait in it.
    pub(super) real: Option<(Instant, Arc<Alarm>)>,
}

impl Time {
    pub(super) fn real(alarm: Alarm) -> Self {
        Self { real: Some((Instant::now(), Arc::new(alarm))), ..Self::default() }
    }

    /// Time since the start of the network.
    pub(super) fn now(&self) -> Duration {
        self.real.as_ref().map_or(self.transit, |(start, _)| start.elapsed())
    }

    /// Advances virtual time; real time does so by itself.
    pub(super) fn advance_to(&mut self, time: Duration) {
        if self.real.is_none() {
            self.transit = time.max(self.transit);
        }
    }

    /// Wall-clock time, ns since 1970.
    pub(super) fn wall_nanos(&self) -> u64 {
        match &self.real {
            None => (EPOCH_NANOS + self.transit.as_nanos() as u64).saturating_add_signed(self.wall_offset),
            Some(_) => dds::wall_nanos(),
        }
    }

    /// Stamp of an arrival at virtual time `due`, ns since 1970; in real time it is that of the sample.
    pub(super) fn wall_at(&self, due: Duration) -> Option<u64> {
        self.real.is_none().then_some(EPOCH_NANOS + due.as_nanos() as u64)
    }

    pub(super) fn alarm(&self) -> Option<&Arc<Alarm>> {
        self.real.as_ref().map(|(_, alarm)| alarm)
    }
}
