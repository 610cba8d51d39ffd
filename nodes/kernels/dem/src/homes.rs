//! Where grains are while several threads move them.
//!
//! Each share of the contacts has a home: a place for every grain, of which it keeps up to date those of its own grains,
//! which it moves, and those of other shares that its pairs reach to. Where the latter are their owners post after each
//! move. So each thread reads and writes what is near to it, and waits for the others once a step.

use crate::compute::Compute;
use crate::contacts::Contacts;
use crate::geometry::View;
use crate::integrate::Grains;
use crate::lanes::{Octad, Quad};
use crate::share::Share;
use crate::state::State;
use std::ops::Range;

/// Homes of all shares. They take 96 bytes a grain and share.
#[derive(Debug, Default)]
pub(crate) struct Homes {
    homes: Vec<Home>,
    /// Grains that other shares reach to, in ascending order.
    border: Vec<u32>,
    /// Where they were last posted to be, and room for where they go.
    posted: Vec<Place>,
    next: Vec<Place>,
    /// Whether the homes have the present state; and if so, whether they alone have it.
    entered: bool,
    alone: bool,
}

/// Position and twist of a grain.
type Place = (Quad, Octad);

/// Home of one share.
#[derive(Clone, Debug, Default)]
struct Home {
    position: Vec<Quad>,
    twist: Vec<Octad>,
    own: Range<usize>,
    /// Grains of other shares that its pairs reach to, and which of the posted ones they are.
    abroad: Vec<(u32, u32)>,
}

impl Clone for Homes {
    /// What the state has as well is not worth a copy.
    fn clone(&self) -> Self {
        if !self.alone {
            return Self::default();
        }
        let Self { homes, border, posted, next, entered, alone } = self;
        let (homes, border) = (homes.clone(), border.clone());
        Self { homes, border, posted: posted.clone(), next: next.clone(), entered: *entered, alone: *alone }
    }
}

/// One home, for a thread.
pub(crate) struct Resident<'a> {
    home: &'a mut Home,
    /// The border grains that are its own, and where to post them.
    border: &'a [u32],
    posts: &'a mut [Place],
    posted: &'a [Place],
}

impl Homes {
    /// The state is no longer what it was, or the shares are not: homes are to be entered anew.
    pub(crate) fn leave(&mut self) {
        (self.entered, self.alone) = (false, false);
    }

    /// Nobody lives here any more.
    pub(crate) fn clear(&mut self) {
        debug_assert!(!self.alone, "a state is lost");
        if !self.homes.is_empty() {
            *self = Self::default();
        }
    }

    /// Brings the state to the shares' homes, if it is not there.
    pub(crate) fn enter(&mut self, state: &State, contacts: &Contacts, compute: &Compute) {
        if self.entered {
            return;
        }
        let shares = &contacts.shares;
        let mut border: Vec<u32> = shares.iter().flat_map(Share::abroad).copied().collect();
        border.sort_unstable();
        border.dedup();
        let place = |g: &u32| (state.position[*g as usize], state.twist[*g as usize]);
        self.posted = border.iter().map(place).collect();
        self.next = self.posted.clone();
        self.homes.resize_with(shares.len(), Home::default);
        compute.share(self.homes.iter_mut().zip(shares), |(home, share)| home.enter(state, share, &border));
        self.border = border;
        (self.entered, self.alone) = (true, false);
    }

    /// Homes for the threads, one for each share.
    pub(crate) fn residents(&mut self) -> impl Iterator<Item = Resident<'_>> {
        let (mut border, mut posts, posted) = (&self.border[..], &mut self.next[..], &self.posted[..]);
        self.homes.iter_mut().map(move |home| {
            let own = border.partition_point(|g| (*g as usize) < home.own.end);
            let (here, beyond) = border.split_at(own);
            let (mine, others) = std::mem::take(&mut posts).split_at_mut(own);
            (border, posts) = (beyond, others);
            Resident { home, border: here, posts: mine, posted }
        })
    }

    /// All residents moved and posted.
    pub(crate) fn moved(&mut self) {
        std::mem::swap(&mut self.posted, &mut self.next);
        self.alone = true;
    }

    /// Multiplies all velocities.
    pub(crate) fn scale(&mut self, factor: f64) {
        let scale = |t: &mut Octad| t.0[..4].iter_mut().for_each(|v| *v *= factor);
        self.homes.iter_mut().for_each(|home| home.twist[home.own.clone()].iter_mut().for_each(scale));
        self.posted.iter_mut().for_each(|(_, twist)| scale(twist));
    }

    /// Whether only the homes have the present state.
    pub(crate) fn have_it_alone(&self) -> bool {
        self.alone
    }

    /// Brings what the homes alone have back to the state.
    pub(crate) fn settle(&mut self, state: &mut State, compute: &Compute) {
        if std::mem::take(&mut self.alone) {
            self.tell(state, compute);
        }
    }

    /// Makes a state that of the homes.
    pub(crate) fn tell(&self, state: &mut State, compute: &Compute) {
        let mut all = Grains::of(&mut state.position, &mut state.twist);
        let homes = self.homes.iter().map(|home| (all.take(home.own.len()), home));
        compute.share(homes, |(mut grains, home)| {
            grains.copy(&home.position[home.own.clone()], &home.twist[home.own.clone()]);
        });
    }
}

impl Home {
    fn enter(&mut self, state: &State, share: &Share, border: &[u32]) {
        self.position.resize(state.grains(), Quad::default());
        self.twist.resize(state.grains(), Octad::default());
        self.own = share.own().grains();
        self.position[self.own.clone()].copy_from_slice(&state.position[self.own.clone()]);
        self.twist[self.own.clone()].copy_from_slice(&state.twist[self.own.clone()]);
        let mut abroad = share.abroad().to_vec();
        abroad.sort_unstable();
        abroad.dedup();
        let slot = |grain: &u32| border.partition_point(|g| g < grain) as u32;
        self.abroad = abroad.into_iter().map(|grain| (grain, slot(&grain))).collect();
    }
}

impl Resident<'_> {
    /// Fetches the grains of other shares from where they were posted.
    pub(crate) fn fetch(&mut self) {
        for &(grain, slot) in &self.home.abroad {
            let place = &self.posted[slot as usize];
            self.home.position[grain as usize] = place.0;
            self.home.twist[grain as usize] = place.1;
        }
    }

    /// Posts its own grains that others reach to.
    pub(crate) fn post(&mut self) {
        for (grain, post) in self.border.iter().zip(self.posts.iter_mut()) {
            *post = (self.home.position[*grain as usize], self.home.twist[*grain as usize]);
        }
    }

    /// What contacts are seen from, where all else is as in `view`.
    pub(crate) fn view<'v>(&'v self, view: View<'v>) -> View<'v> {
        View { position: &self.home.position, twist: &self.home.twist, ..view }
    }

    /// All grains at home.
    pub(crate) fn grains(&mut self) -> Grains<'_> {
        Grains::of(&mut self.home.position, &mut self.home.twist)
    }
}
