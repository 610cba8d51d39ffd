//! Sweeping over the chunks of grains: forces, motion, or both at once, in the form compiled for the phase.
//!
//! What acts on a grain is complete once its own chunk was passed, so it can move at once, while everything about it is
//! still in the cache. A chunk's pass reads its own grains and later ones only (the first grain of a pair has the lower
//! number), so a thread that has all grains moves them where they are. Where there are several, each has a home for its
//! own. The bits are the same.

use crate::compute::Compute;
use crate::contacts::Contacts;
use crate::engine::{Features, Setting};
use crate::geometry::{Equal, View};
use crate::homes::{Homes, Resident};
use crate::integrate::{self, Motion, Moved};
use crate::lanes::{CHUNK, Quad};
use crate::law::Law;
use crate::pass::{Chunk, Frictional, Frictionless};
use crate::share::Share;
use crate::simd::Simd;
use crate::state::State;
use crate::stress::{self, Seen};
use crate::sums::Act;
use grainlab_core::material::effective_radius;
use grainlab_scene::Tangential;

/// What a sweep does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Job {
    /// Evaluates forces at the present positions.
    Evaluate,
    /// The same, with the tangential history as it is instead of a step on (after a resume).
    Resume,
    /// Moves all grains over one step, under the forces last evaluated.
    Advance,
    /// Evaluates forces, and moves all grains over one step under them.
    EvaluateAndAdvance,
}

/// What the contacts are seen from.
pub(crate) fn view<'a>(state: &'a State, shift: &'a [Quad], setting: &Setting) -> View<'a> {
    let radius = state.largest_radius;
    let m_eff = state.inverse_mass.first().map_or(0.0, |inverse| 1.0 / (inverse + inverse));
    View {
        position: &state.position,
        twist: &state.twist,
        shift,
        rate: state.rate.into(),
        law: Law::new(&state.material, setting.friction, setting.damping),
        dt: state.time_step,
        equal: Equal { radius, r_eff: effective_radius(radius, radius), m_eff },
    }
}

/// What is swept over, and with what.
pub(crate) struct Sweep<'a> {
    pub(crate) state: &'a mut State,
    pub(crate) homes: &'a mut Homes,
    pub(crate) contacts: &'a mut Contacts,
    pub(crate) setting: &'a Setting,
    pub(crate) compute: &'a Compute,
}

impl Sweep<'_> {
    /// Does the job on all grains; with `look` stress is seen where forces are evaluated.
    pub(crate) fn run(self, job: Job, look: bool) -> (Seen, Moved) {
        let Self { state, homes, contacts, setting, compute } = self;
        let over = Over { job, pass: choose(setting, job, !state.equal_sized()), simd: compute.simd(), look };
        if let [share] = &mut contacts.shares[..] {
            homes.clear();
            let shift = contacts.images.shifts();
            return join([over.share(share, &mut InPlace { state, shift, setting })]);
        }
        homes.enter(state, contacts, compute);
        let (view, motion) = (view(state, contacts.images.shifts(), setting), Motion::still(state, setting));
        let work = |(mut resident, share): (Resident<'_>, &mut Share)| {
            resident.fetch();
            let mut place = AtHome { resident, view, motion };
            let parts = over.share(share, &mut place);
            if over.moves() {
                place.resident.post();
            }
            parts
        };
        let parts = compute.share(homes.residents().zip(&mut contacts.shares), work);
        if over.moves() {
            homes.moved();
        }
        join(parts)
    }
}

/// What a part saw and how it moved, part after part.
type Parts = Vec<(Seen, Moved)>;

/// All of it, in the order of parts.
fn join(shares: impl IntoIterator<Item = Parts>) -> (Seen, Moved) {
    let mut all = (Seen::default(), Moved::default());
    for (seen, moved) in shares.into_iter().flatten() {
        all.0.then(&seen);
        all.1.then(&moved);
    }
    all
}

/// Where the grains of a share are.
trait Place {
    /// What contacts are seen from.
    fn view(&self) -> View<'_>;

    /// Moves the grains of a chunk.
    fn advance(&mut self, chunk: usize, acts: impl Act, simd: Simd) -> Moved;
}

/// All in the state.
struct InPlace<'a> {
    state: &'a mut State,
    shift: &'a [Quad],
    setting: &'a Setting,
}

impl Place for InPlace<'_> {
    fn view(&self) -> View<'_> {
        view(self.state, self.shift, self.setting)
    }

    fn advance(&mut self, chunk: usize, acts: impl Act, simd: Simd) -> Moved {
        let (motion, grains) = Motion::of(self.state, self.setting);
        integrate::advance(&motion, acts, chunk * CHUNK, grains.chunk(chunk, CHUNK), simd)
    }
}

/// In a home of their own.
struct AtHome<'a> {
    resident: Resident<'a>,
    /// Of the state.
    view: View<'a>,
    motion: Motion<'a>,
}

impl Place for AtHome<'_> {
    fn view(&self) -> View<'_> {
        self.resident.view(self.view)
    }

    fn advance(&mut self, chunk: usize, acts: impl Act, simd: Simd) -> Moved {
        let grains = self.resident.grains().chunk(chunk, CHUNK);
        integrate::advance(&self.motion, acts, chunk * CHUNK, grains, simd)
    }
}

/// How to go over a share.
#[derive(Clone, Copy)]
struct Over {
    job: Job,
    pass: Pass,
    simd: Simd,
    look: bool,
}

impl Over {
    fn moves(&self) -> bool {
        matches!(self.job, Job::Advance | Job::EvaluateAndAdvance)
    }

    /// What each part of the share's own saw and how it moved.
    fn share(&self, share: &mut Share, place: &mut impl Place) -> Parts {
        if self.job == Job::Advance {
            return self.advance(share, place);
        }
        let own = share.own().parts();
        for p in 0..own.start {
            self.foreign(share, p, place);
        }
        own.map(|p| self.part(share, p, place)).collect()
    }

    fn advance(&self, share: &Share, place: &mut impl Place) -> Parts {
        let own = share.own();
        let mut parts = vec![(Seen::default(), Moved::default()); own.parts().len()];
        for (chunk, acts) in own.chunks().zip(share.acts()) {
            parts[own.part_of(chunk) - own.parts().start].1.then(&place.advance(chunk, acts, self.simd));
        }
        parts
    }

    /// A part of another share's, that acts on the own ones; what it sees is seen there.
    fn foreign(&self, share: &mut Share, p: usize, place: &impl Place) {
        let mut part = share.part_mut(p);
        part.sums.begin();
        for c in 0..part.chunks() {
            (self.pass)(self.simd, place.view(), part.chunk(c), false);
        }
        part.sums.drop_own();
    }

    /// One of the share's own.
    fn part(&self, share: &mut Share, p: usize, place: &mut impl Place) -> (Seen, Moved) {
        let first = share.own().chunks_of(p).start;
        let mut part = share.part_mut(p);
        let (mut across, mut within, mut moved) = (Seen::default(), Seen::default(), Moved::default());
        part.sums.begin();
        for c in 0..part.chunks() {
            across.then(&(self.pass)(self.simd, place.view(), part.chunk(c), self.look));
            let chunk = first + c;
            if self.moves() && !self.look {
                moved.then(&place.advance(chunk, part.sums.take(c), self.simd));
                continue;
            }
            part.sums.end(c, self.simd);
            let acts = part.sums.ended(c);
            if self.look {
                let all = place.view().position;
                let positions = &all[chunk * CHUNK..((chunk + 1) * CHUNK).min(all.len())];
                within.then(&stress::inner(acts, positions, self.simd));
            }
            if self.moves() {
                moved.then(&place.advance(chunk, acts, self.simd));
            }
        }
        across.then(&within);
        (across, moved)
    }
}

type Pass = fn(Simd, View<'_>, Chunk<'_>, bool) -> Seen;

/// The pass compiled for these features.
fn choose(setting: &Setting, job: Job, sizes: bool) -> Pass {
    let held = job == Job::Resume;
    if sizes { with::<true>(setting, held) } else { with::<false>(setting, held) }
}

fn with<const SIZES: bool>(setting: &Setting, held: bool) -> Pass {
    let rescaled = setting.tangential == Tangential::Rescaled;
    match (setting.features(), rescaled, held) {
        (Features::Frictionless, ..) => frictionless::<SIZES>,
        (Features::Coulomb, true, false) => frictional::<true, true, true, SIZES>,
        (Features::Coulomb, false, false) => frictional::<true, true, false, SIZES>,
        (Features::Stuck, true, false) => frictional::<true, false, true, SIZES>,
        (Features::Stuck, false, false) => frictional::<true, false, false, SIZES>,
        (Features::Coulomb, _, true) => frictional::<false, true, false, SIZES>,
        (Features::Stuck, _, true) => frictional::<false, false, false, SIZES>,
    }
}

fn frictionless<const SIZES: bool>(simd: Simd, view: View<'_>, chunk: Chunk<'_>, look: bool) -> Seen {
    simd.run(Frictionless::<SIZES> { view, chunk, look })
}

fn frictional<const A: bool, const S: bool, const R: bool, const SIZES: bool>(
    simd: Simd,
    view: View<'_>,
    chunk: Chunk<'_>,
    look: bool,
) -> Seen {
    simd.run(Frictional::<A, S, R, SIZES> { view, chunk, look })
}
