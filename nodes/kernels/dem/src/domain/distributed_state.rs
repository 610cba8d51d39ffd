//! Copies of the state, one per subdomain, while several threads move grains.
//!
//! Each copy has a row for every grain. It keeps two kinds up to date: the grains of its subdomain, which its thread moves,
//! and its ghosts, the grains of other subdomains that its pairs reach to. Owners send the state of ghosts through the halo
//! after each step. So each thread reads and writes memory near to it, and waits for the others once per step.

use super::decomposition::Subdomain;
use super::state::{GrainsMut, State};
use crate::simd::simd_f64::{F64x4, F64x8};
use grainlab_engine::Compute;
use std::ops::Range;

/// The copies of all subdomains. They take 96 bytes per grain and subdomain.
#[derive(Clone, Debug, Default)]
pub(crate) struct DistributedState {
    copies: Vec<SubdomainState>,
    /// The halo: grains that other subdomains reach to, in ascending order.
    halo: Vec<u32>,
    /// State of the halo as last sent, and the buffer for the next exchange.
    sent: Vec<HaloRow>,
    sending: Vec<HaloRow>,
    /// True if the copies hold the present state.
    pub(crate) is_current: bool,
    /// True if only the copies hold it.
    pub(crate) is_authoritative: bool,
}

/// Position and twist of a grain.
type HaloRow = (F64x4, F64x8);

#[derive(Clone, Debug, Default)]
struct SubdomainState {
    position: Vec<F64x4>,
    twist: Vec<F64x8>,
    owned: Range<usize>,
    /// Grains of other subdomains that its pairs reach to, each with its row in the halo.
    ghosts: Vec<(u32, u32)>,
}

pub(crate) struct SubdomainView<'a> {
    copy: &'a mut SubdomainState,
    /// The halo grains of the subdomain, and where to send them.
    halo: &'a [u32],
    sending: &'a mut [HaloRow],
    sent: &'a [HaloRow],
}

impl DistributedState {
    /// Marks the copies as out of date: the state or the subdomains have changed.
    pub(crate) fn invalidate(&mut self) {
        (self.is_current, self.is_authoritative) = (false, false);
    }

    pub(crate) fn clear(&mut self) {
        debug_assert!(!self.is_authoritative, "a state is lost");
        if !self.copies.is_empty() {
            *self = Self::default();
        }
    }

    /// Copies the state to the subdomains. Each subdomain comes with its ghosts, which may repeat.
    pub(crate) fn scatter(&mut self, state: &State, subdomains: &[(&Subdomain, &[u32])], compute: &Compute) {
        let mut halo: Vec<u32> = subdomains.iter().flat_map(|(_, ghosts)| *ghosts).copied().collect();
        halo.sort_unstable();
        halo.dedup();
        let halo_row = |g: &u32| (state.position[*g as usize], state.twist[*g as usize]);
        self.sent = halo.iter().map(halo_row).collect();
        self.sending = self.sent.clone();
        self.copies.resize_with(subdomains.len(), SubdomainState::default);
        compute.map_subdomains(self.copies.iter_mut().zip(subdomains), |(copy, (subdomain, ghosts))| {
            copy.fill(state, subdomain, ghosts, &halo);
        });
        self.halo = halo;
        (self.is_current, self.is_authoritative) = (true, false);
    }

    pub(crate) fn views(&mut self) -> impl Iterator<Item = SubdomainView<'_>> {
        let (mut halo, mut sending, sent) = (&self.halo[..], &mut self.sending[..], &self.sent[..]);
        self.copies.iter_mut().map(move |copy| {
            let count = halo.partition_point(|g| (*g as usize) < copy.owned.end);
            let (owned, beyond) = halo.split_at(count);
            let (rows, rest) = std::mem::take(&mut sending).split_at_mut(count);
            (halo, sending) = (beyond, rest);
            SubdomainView { copy, halo: owned, sending: rows, sent }
        })
    }

    /// All subdomains have moved their grains and sent their halo.
    pub(crate) fn exchange(&mut self) {
        std::mem::swap(&mut self.sent, &mut self.sending);
        self.is_authoritative = true;
    }

    pub(crate) fn scale_velocities(&mut self, factor: f64) {
        let scale = |t: &mut F64x8| t.0[..4].iter_mut().for_each(|v| *v *= factor);
        self.copies.iter_mut().for_each(|copy| copy.twist[copy.owned.clone()].iter_mut().for_each(scale));
        self.sent.iter_mut().for_each(|(_, twist)| scale(twist));
    }

    /// Copies back to the state what only the copies hold.
    pub(crate) fn gather(&mut self, state: &mut State, compute: &Compute) {
        if std::mem::take(&mut self.is_authoritative) {
            self.copy_to(state, compute);
        }
    }

    /// Overwrites a state with the one that the copies hold.
    pub(crate) fn copy_to(&self, state: &mut State, compute: &Compute) {
        let mut all = GrainsMut { position: &mut state.position, twist: &mut state.twist };
        let copies = self.copies.iter().map(|copy| (all.split_off_front(copy.owned.len()), copy));
        compute.map_subdomains(copies, |(mut grains, copy)| {
            grains.copy_from(&copy.position[copy.owned.clone()], &copy.twist[copy.owned.clone()]);
        });
    }
}

impl SubdomainState {
    fn fill(&mut self, state: &State, subdomain: &Subdomain, ghosts: &[u32], halo: &[u32]) {
        self.position.resize(state.len(), F64x4::default());
        self.twist.resize(state.len(), F64x8::default());
        self.owned = subdomain.grains();
        self.position[self.owned.clone()].copy_from_slice(&state.position[self.owned.clone()]);
        self.twist[self.owned.clone()].copy_from_slice(&state.twist[self.owned.clone()]);
        let mut ghosts = ghosts.to_vec();
        ghosts.sort_unstable();
        ghosts.dedup();
        let halo_row = |grain: &u32| halo.partition_point(|g| g < grain) as u32;
        self.ghosts = ghosts.into_iter().map(|grain| (grain, halo_row(&grain))).collect();
    }
}

impl SubdomainView<'_> {
    pub(crate) fn receive_halo(&mut self) {
        for &(grain, row) in &self.copy.ghosts {
            let (position, twist) = &self.sent[row as usize];
            self.copy.position[grain as usize] = *position;
            self.copy.twist[grain as usize] = *twist;
        }
    }

    /// Writes to the halo those of its grains that other subdomains reach to.
    pub(crate) fn send_halo(&mut self) {
        for (grain, row) in self.halo.iter().zip(self.sending.iter_mut()) {
            *row = (self.copy.position[*grain as usize], self.copy.twist[*grain as usize]);
        }
    }

    /// All grains; only those of the subdomain and its ghosts are up to date.
    pub(crate) fn grains_mut(&mut self) -> GrainsMut<'_> {
        GrainsMut { position: &mut self.copy.position, twist: &mut self.copy.twist }
    }
}
