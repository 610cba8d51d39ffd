//! Sweeping over the chunks of grains: forces, motion, or both at once, in the form compiled for the phase.
//!
//! A chunk's pass reads positions of its own grains and of later ones only (the first grain of a pair has the lower
//! number), and a grain's force is complete once its own chunk was passed. So on one thread a chunk can move as soon as
//! it was passed, while everything about it is still in the cache. On several threads all chunks are passed, then all
//! move. The bits are the same.

use crate::compute::Compute;
use crate::contacts::Contacts;
use crate::engine::{Features, Setting};
use crate::geometry::{Equal, View};
use crate::integrate::{self, Grains, Motion, Moved, Parts, Whole};
use crate::lanes::{CHUNK, Octad, Quad};
use crate::law::Law;
use crate::pass::{Chunk, Frictional, Frictionless};
use crate::simd::Simd;
use crate::state::State;
use crate::stress::{self, Seen};
use crate::sums::Sums;
use grains::material::effective_radius;
use scene::Tangential;
use std::ops::Range;

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
    let mut seen = Seen::default();
    for c in 0..state.grains().div_ceil(CHUNK) {
        let Some((images, chunk)) = contacts.chunk_mut(c) else { break };
        let crossed = pass(simd, view(state, images.shifts(), setting), chunk, look);
        let range = range(state, c);
        let Sums::Serial(sums) = &mut contacts.sums else { break };
        let total = sums.settle(range.clone(), simd);
        if look {
            seen.then(&crossed);
            seen.then(&stress::inner(total, &state.position[range], simd));
        }
    }
    if contacts.sums.shared() {
        let (images, chunks) = contacts.chunks_mut();
        let view = view(state, images.shifts(), setting);
        let mut crossed = Vec::new();
        compute.each(chunks, |chunk| pass(simd, view, chunk, look), |next| crossed.push(next));
        if look {
            let chunks = 0..crossed.len();
            let inner = |c: usize| {
                let (range, mut room) = (range(state, c), [Octad::default(); CHUNK]);
                let total = contacts.sums.total(c, range.clone(), &mut room, simd);
                stress::inner(total, &state.position[range], simd)
            };
            let mut crossed = crossed.iter();
            compute.each(chunks, inner, |next| {
                crossed.next().into_iter().for_each(|c| seen.then(c));
                seen.then(&next);
            });
        }
    }
    seen
}

/// Grains of a chunk.
fn range(state: &State, c: usize) -> Range<usize> {
    c * CHUNK..((c + 1) * CHUNK).min(state.grains())
}

/// Moves all grains over one step, under the forces last evaluated.
pub(crate) fn advance(state: &mut State, contacts: &Contacts, setting: &Setting, compute: &Compute) -> Moved {
    let (motion, grains) = Motion::of(state, setting);
    let chunks = grains.chunks(CHUNK).enumerate();
    let mut moved = Moved::default();
    let simd = compute.simd();
    let work = |(c, chunk): (usize, Grains<'_>)| {
        let (first, mut room) = (c * CHUNK, [Octad::default(); CHUNK]);
        let total = contacts.sums.total(c, first..first + chunk.count(), &mut room, simd);
        integrate::advance(&motion, Whole(total), first, chunk, simd)
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
    if contacts.sums.shared() {
        let seen = evaluate(state, contacts, setting, compute, Advance::Step, look);
        return (seen, advance(state, contacts, setting, compute));
    }
    let simd = compute.simd();
    let pass = choose(setting, Advance::Step, !contacts.sizes.is_empty());
    let (mut seen, mut moved) = (Seen::default(), Moved::default());
    for c in 0..state.grains().div_ceil(CHUNK) {
        let Some((images, chunk)) = contacts.chunk_mut(c) else { break };
        let crossed = pass(simd, view(state, images.shifts(), setting), chunk, look);
        let range = range(state, c);
        let Sums::Serial(sums) = &mut contacts.sums else { break };
        let first = range.start;
        moved.then(&if look {
            let total = sums.settle(range.clone(), simd);
            seen.then(&crossed);
            seen.then(&stress::inner(total, &state.position[range], simd));
            let (motion, grains) = Motion::of(state, setting);
            integrate::advance(&motion, Whole(total), first, grains.chunk(c, CHUNK), simd)
        } else {
            let (own, early) = sums.parts(range);
            let (motion, grains) = Motion::of(state, setting);
            integrate::advance(&motion, Parts(own, early), first, grains.chunk(c, CHUNK), simd)
        });
    }
    (seen, moved)
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
