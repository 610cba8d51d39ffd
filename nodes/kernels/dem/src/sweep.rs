//! Sweeping over the chunks of grains: forces, motion, or both at once, in the form compiled for the phase.
//!
//! A chunk's pass reads positions of its own grains and of later ones only (the first grain of a pair has the lower
//! number), and a grain's force is complete once its own chunk was passed. So on one thread a chunk can move as soon as
//! it was passed, while everything about it is still in the cache. On several threads all chunks are passed, then all
//! move. The bits are the same.

use crate::compute::Compute;
use crate::contacts::{CHUNK, Contacts};
use crate::engine::{Features, Setting};
use crate::integrate::{self, Motion, Moved};
use crate::lanes::Quad;
use crate::law::Law;
use crate::pass::{Chunk, Frictional, Frictionless, Seen, View};
use crate::simd::Simd;
use crate::state::State;
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
        velocity: &state.velocity,
        spin: &state.spin,
        shift,
        rate: state.rate,
        law: Law::new(&state.material, setting.friction, setting.damping),
        dt: state.time_step,
        equal: (radius, effective_radius(radius, radius), m_eff),
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
    let pass = choose(setting, advance, !contacts.sizes.is_empty(), look);
    let (images, chunks) = contacts.chunks_mut();
    let view = view(state, images.shifts(), setting);
    let mut seen = Seen::default();
    compute.each(chunks, |chunk| pass(compute.simd(), view, chunk), |next| seen.then(&next));
    seen
}

/// Moves all grains over one step, under the forces last evaluated.
pub(crate) fn advance(state: &mut State, contacts: &Contacts, setting: &Setting, compute: &Compute) -> Moved {
    let (motion, grains) = Motion::of(state, setting);
    let chunks = grains.chunks(CHUNK).enumerate();
    let mut moved = Moved::default();
    let work = |(c, chunk)| integrate::advance(&motion, contacts, c * CHUNK, chunk, compute.simd());
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
    let pass = choose(setting, Advance::Step, !contacts.sizes.is_empty(), look);
    let (mut seen, mut moved) = (Seen::default(), Moved::default());
    for c in 0..state.grains().div_ceil(CHUNK) {
        let (images, chunk) = contacts.chunk_mut(c);
        let view = view(state, images.shifts(), setting);
        seen.then(&pass(compute.simd(), view, chunk));
        let (motion, grains) = Motion::of(state, setting);
        let grains = grains.chunk(c, CHUNK);
        moved.then(&integrate::advance(&motion, contacts, c * CHUNK, grains, compute.simd()));
    }
    (seen, moved)
}

type Pass = fn(Simd, View<'_>, Chunk<'_>) -> Seen;

/// The pass compiled for these features.
fn choose(setting: &Setting, advance: Advance, sizes: bool, look: bool) -> Pass {
    match (sizes, look) {
        (false, false) => with::<false, false>(setting, advance),
        (false, true) => with::<false, true>(setting, advance),
        (true, false) => with::<true, false>(setting, advance),
        (true, true) => with::<true, true>(setting, advance),
    }
}

fn with<const SIZES: bool, const LOOK: bool>(setting: &Setting, advance: Advance) -> Pass {
    let rescaled = setting.tangential == Tangential::Rescaled;
    match (setting.features(), rescaled, advance) {
        (Features::Frictionless, ..) => frictionless::<SIZES, LOOK>,
        (Features::Coulomb, true, Advance::Step) => frictional::<true, true, true, SIZES, LOOK>,
        (Features::Coulomb, false, Advance::Step) => frictional::<true, true, false, SIZES, LOOK>,
        (Features::Stuck, true, Advance::Step) => frictional::<true, false, true, SIZES, LOOK>,
        (Features::Stuck, false, Advance::Step) => frictional::<true, false, false, SIZES, LOOK>,
        (Features::Coulomb, _, Advance::Held) => frictional::<false, true, false, SIZES, LOOK>,
        (Features::Stuck, _, Advance::Held) => frictional::<false, false, false, SIZES, LOOK>,
    }
}

fn frictionless<const SIZES: bool, const LOOK: bool>(simd: Simd, view: View<'_>, chunk: Chunk<'_>) -> Seen {
    simd.run(Frictionless::<SIZES, LOOK> { view, chunk })
}

fn frictional<const A: bool, const S: bool, const R: bool, const SIZES: bool, const LOOK: bool>(
    simd: Simd,
    view: View<'_>,
    chunk: Chunk<'_>,
) -> Seen {
    simd.run(Frictional::<A, S, R, SIZES, LOOK> { view, chunk })
}
