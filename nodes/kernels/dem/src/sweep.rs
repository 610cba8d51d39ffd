//! Sweeping over the chunks of grains: forces, motion, or both at once, in the form compiled for the phase.
//!
//! A chunk's pass reads positions of its own grains and of later ones only (the first grain of a pair has the lower
//! number), and a grain's force is complete once its own chunk was passed. So on one thread a chunk can move as soon as
//! it was passed, while everything about it is still in the cache. On several threads all chunks are passed, then all
//! move. The bits are the same.

use crate::compute::Compute;
use crate::contacts::{Contacts, Part};
use crate::engine::{Features, Setting};
use crate::geometry::{Equal, View};
use crate::integrate::{self, Grains, Motion, Moved};
use crate::lanes::{CHUNK, Quad};
use crate::law::Law;
use crate::pass::{Chunk, Frictional, Frictionless};
use crate::simd::Simd;
use crate::state::State;
use crate::stress::{self, Seen};
use crate::sums::{PART, Put};
use grains::material::effective_radius;
use scene::Tangential;

/// What becomes of the tangential history.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Advance {
    /// Brought forward by one step.
    Step,
    /// Taken as it is (after a resume), with the same forces.
    Held,
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

/// Evaluates forces at the present positions; with `look` also the stress.
pub(crate) fn evaluate(
    state: &State,
    contacts: &mut Contacts,
    setting: &Setting,
    compute: &Compute,
    advance: Advance,
    look: bool,
) -> Seen {
    let pass = choose(setting, advance, !contacts.sizes.is_empty());
    let simd = compute.simd();
    let (images, parts) = contacts.parts_mut();
    let view = view(state, images.shifts(), setting);
    let mut seen = Seen::default();
    let work = |mut part: Part<'_>| {
        let mut seen = Seen::default();
        part.sums.begin();
        for c in 0..part.chunks() {
            seen.then(&pass(simd, view, part.chunk(c), look));
            part.sums.end(c, simd);
        }
        seen
    };
    compute.each(parts, work, |next| seen.then(&next));
    contacts.sums.join();
    if look {
        let chunks = contacts.sums.chunks().zip(state.position.chunks(CHUNK));
        let inner = |(acts, position): (Put<'_>, &[Quad])| stress::inner(acts, position, simd);
        let mut within = Seen::default();
        compute.each(chunks, inner, |next| within.then(&next));
        seen.then(&within);
    }
    seen
}

/// Moves all grains over one step, under the forces last evaluated.
pub(crate) fn advance(state: &mut State, contacts: &Contacts, setting: &Setting, compute: &Compute) -> Moved {
    let (motion, grains) = Motion::of(state, setting);
    let chunks = grains.chunks(CHUNK).zip(contacts.sums.chunks()).enumerate();
    let mut moved = Moved::default();
    let simd = compute.simd();
    let work = |(c, (grains, acts)): (usize, (Grains<'_>, Put<'_>))| {
        integrate::advance(&motion, acts, c * CHUNK, grains, simd)
    };
    compute.each(chunks, work, |next| moved.then(&next));
    moved
}

/// Evaluates forces at the present positions, and moves all grains over one step under them.
pub(crate) fn evaluate_and_advance(
    state: &mut State,
    contacts: &mut Contacts,
    setting: &Setting,
    compute: &Compute,
    look: bool,
) -> (Seen, Moved) {
    if compute.threads() > 1 {
        let seen = evaluate(state, contacts, setting, compute, Advance::Step, look);
        return (seen, advance(state, contacts, setting, compute));
    }
    let simd = compute.simd();
    let pass = choose(setting, Advance::Step, !contacts.sizes.is_empty());
    let (mut across, mut within, mut moved) = (Seen::default(), Seen::default(), Moved::default());
    for p in 0..state.grains().div_ceil(PART * CHUNK) {
        let (images, mut part, mut earlier) = contacts.part_mut(p);
        let mut seen = Seen::default();
        part.sums.begin();
        for c in 0..part.chunks() {
            seen.then(&pass(simd, view(state, images.shifts(), setting), part.chunk(c), look));
            let chunk = p * PART + c;
            let (motion, grains) = Motion::of(state, setting);
            let grains = grains.chunk(chunk, CHUNK);
            moved.then(&if look {
                part.sums.end(c, simd);
                let acts = part.sums.ended(c, &mut earlier);
                within.then(&stress::inner(acts, grains.positions(), simd));
                integrate::advance(&motion, acts, chunk * CHUNK, grains, simd)
            } else {
                let acts = part.sums.take(c, &mut earlier);
                integrate::advance(&motion, acts, chunk * CHUNK, grains, simd)
            });
        }
        across.then(&seen);
    }
    across.then(&within);
    (across, moved)
}

type Pass = fn(Simd, View<'_>, Chunk<'_>, bool) -> Seen;

/// The pass compiled for these features.
fn choose(setting: &Setting, advance: Advance, sizes: bool) -> Pass {
    if sizes { with::<true>(setting, advance) } else { with::<false>(setting, advance) }
}

fn with<const SIZES: bool>(setting: &Setting, advance: Advance) -> Pass {
    let rescaled = setting.tangential == Tangential::Rescaled;
    match (setting.features(), rescaled, advance) {
        (Features::Frictionless, ..) => frictionless::<SIZES>,
        (Features::Coulomb, true, Advance::Step) => frictional::<true, true, true, SIZES>,
        (Features::Coulomb, false, Advance::Step) => frictional::<true, true, false, SIZES>,
        (Features::Stuck, true, Advance::Step) => frictional::<true, false, true, SIZES>,
        (Features::Stuck, false, Advance::Step) => frictional::<true, false, false, SIZES>,
        (Features::Coulomb, _, Advance::Held) => frictional::<false, true, false, SIZES>,
        (Features::Stuck, _, Advance::Held) => frictional::<false, false, false, SIZES>,
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
