//! One pass over the chunks of grains: forces, motion, or both at once, compiled for the features of the phase.
//!
//! The force on a grain is complete once its own chunk was evaluated. So the grain can move at once, while its data is still
//! in the cache. The pairs of a chunk read its own grains and later ones only (the first grain of a pair has the lower
//! number). So with one subdomain grains move in the state itself; with several, each subdomain has a copy. The bits are the
//! same.

use super::integrate::{self, Motion, SpeedStats};
use crate::domain::accumulator::ChunkForces;
use crate::domain::distributed_state::{DistributedState, SubdomainView};
use crate::domain::state::{GrainsMut, State};
use crate::force::geometry::ForceInput;
use crate::force::kernel::{Frictional, Frictionless, forces, forces_once};
use crate::force::virial::{self, Virial};
use crate::pairs::contacts::Contacts;
use crate::pairs::subdomain_pairs::SubdomainPairs;
use crate::pairs::types::PairChunk;
use crate::simd::instruction_set::Simd;
use crate::simd::simd_f64::CHUNK_SIZE;
use grainlab_core::contact::{ContactSprings, LawVisitor};
use grainlab_engine::{Compute, EngineSettings, Features};
use std::mem::take;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PassKind {
    Forces,
    /// Evaluates forces with the tangential history as it is instead of one step further (after a resume).
    ForcesAsSaved,
    /// Moves all grains over one step, under the forces last evaluated.
    Motion,
    ForcesAndMotion,
}

pub(crate) struct Pass<'a> {
    pub(crate) state: &'a mut State,
    pub(crate) copies: &'a mut DistributedState,
    pub(crate) contacts: &'a mut Contacts,
    pub(crate) settings: &'a EngineSettings,
    pub(crate) compute: &'a Compute,
    pub(crate) simd: Simd,
    pub(crate) kind: PassKind,
    /// True if the virial is summed, where forces are evaluated.
    pub(crate) with_virial: bool,
}

impl Pass<'_> {
    pub(crate) fn run(self) -> (Virial, SpeedStats) {
        let (law, material) = (self.state.law, self.state.material);
        law.visit(&material, self)
    }
}

impl LawVisitor for Pass<'_> {
    type Output = (Virial, SpeedStats);

    fn visit<S: ContactSprings>(self, springs: S) -> Self::Output {
        let Self { state, copies, contacts, settings, compute, simd, kind, with_virial } = self;
        let kernel = if state.is_monodisperse() { kernel_for::<S, false> } else { kernel_for::<S, true> };
        let kernel = kernel(settings, kind == PassKind::ForcesAsSaved);
        let over = SubdomainPass { kind, kernel, simd, with_virial };
        let offset = contacts.images.offsets();
        if let [pairs] = &mut contacts.subdomains[..] {
            copies.clear();
            // Taken out of the state, so that grains move while the rest of it is read.
            let (mut position, mut twist) = (take(&mut state.position), take(&mut state.twist));
            let (input, motion) =
                (ForceInput::new(state, offset, settings, springs), Motion::of(state, settings));
            let all = GrainsMut { position: &mut position, twist: &mut twist };
            let results = join([over.run(pairs, &mut Grains { all, input, motion })]);
            (state.position, state.twist) = (position, twist);
            return results;
        }
        if !copies.is_current {
            let subdomains: Vec<_> =
                contacts.subdomains.iter().map(|p| (&p.subdomain, &p.ghosts[..])).collect();
            copies.scatter(state, &subdomains, compute);
        }
        let (input, motion) =
            (ForceInput::new(state, offset, settings, springs), Motion::of(state, settings));
        let work = |(mut view, pairs): (SubdomainView<'_>, &mut SubdomainPairs)| {
            view.receive_halo();
            let parts = over.run(pairs, &mut Grains { all: view.grains_mut(), input, motion });
            if over.moves() {
                view.send_halo();
            }
            parts
        };
        let parts = compute.map_subdomains(copies.views().zip(&mut contacts.subdomains), work);
        if over.moves() {
            copies.exchange();
        }
        join(parts)
    }
}

/// Virial and speeds of each part, part after part.
type PartResults = Vec<(Virial, SpeedStats)>;

/// The sums over all parts, in the order of parts.
fn join(subdomains: impl IntoIterator<Item = PartResults>) -> (Virial, SpeedStats) {
    let mut total = (Virial::default(), SpeedStats::default());
    for (virial, stats) in subdomains.into_iter().flatten() {
        total.0.add(&virial);
        total.1.add(&stats);
    }
    total
}

/// The grains of a subdomain, in the state or in a copy of it.
struct Grains<'a, S> {
    all: GrainsMut<'a>,
    /// Without the grains.
    input: ForceInput<'a, S>,
    motion: Motion<'a>,
}

impl<S: ContactSprings> Grains<'_, S> {
    fn force_input(&self) -> ForceInput<'_, S> {
        ForceInput { position: self.all.position, twist: self.all.twist, ..self.input }
    }

    fn advance(&mut self, chunk: usize, forces: impl ChunkForces, simd: Simd) -> SpeedStats {
        integrate::advance(&self.motion, forces, chunk * CHUNK_SIZE, self.all.chunk(chunk), simd)
    }
}

struct SubdomainPass<S> {
    kind: PassKind,
    kernel: ForceKernel<S>,
    simd: Simd,
    with_virial: bool,
}

impl<S: ContactSprings> SubdomainPass<S> {
    fn moves(&self) -> bool {
        matches!(self.kind, PassKind::Motion | PassKind::ForcesAndMotion)
    }

    fn run(&self, pairs: &mut SubdomainPairs, grains: &mut Grains<'_, S>) -> PartResults {
        if self.kind == PassKind::Motion {
            return self.motion(pairs, grains);
        }
        let owned = pairs.subdomain.parts();
        for part in 0..owned.start {
            self.earlier_part(pairs, part, grains);
        }
        owned.map(|part| self.owned_part(pairs, part, grains)).collect()
    }

    fn motion(&self, pairs: &SubdomainPairs, grains: &mut Grains<'_, S>) -> PartResults {
        let subdomain = &pairs.subdomain;
        let mut parts = vec![(Virial::default(), SpeedStats::default()); subdomain.parts().len()];
        for (chunk, forces) in subdomain.chunks().zip(pairs.stored_forces()) {
            let part = subdomain.part_of(chunk) - subdomain.parts().start;
            parts[part].1.add(&grains.advance(chunk, forces, self.simd));
        }
        parts
    }

    /// Pairs of an earlier subdomain that act on owned grains. Their virial is summed there.
    fn earlier_part(&self, pairs: &mut SubdomainPairs, part: usize, grains: &Grains<'_, S>) {
        let mut pairs = pairs.part_mut(part);
        pairs.accumulator.begin();
        for c in 0..pairs.chunks() {
            (self.kernel)(self.simd, grains.force_input(), pairs.chunk(c), false);
        }
        pairs.accumulator.discard_own();
    }

    fn owned_part(
        &self,
        pairs: &mut SubdomainPairs,
        part: usize,
        grains: &mut Grains<'_, S>,
    ) -> (Virial, SpeedStats) {
        let first = pairs.subdomain.chunks_of(part).start;
        let mut pairs = pairs.part_mut(part);
        let (mut periodic, mut inner) = (Virial::default(), Virial::default());
        let mut stats = SpeedStats::default();
        pairs.accumulator.begin();
        for c in 0..pairs.chunks() {
            periodic.add(&(self.kernel)(self.simd, grains.force_input(), pairs.chunk(c), self.with_virial));
            let chunk = first + c;
            if self.moves() && !self.with_virial {
                stats.add(&grains.advance(chunk, pairs.accumulator.take(c), self.simd));
                continue;
            }
            pairs.accumulator.store(c, self.simd);
            let forces = pairs.accumulator.load(c);
            if self.with_virial {
                let all = grains.force_input().position;
                let positions = &all[chunk * CHUNK_SIZE..((chunk + 1) * CHUNK_SIZE).min(all.len())];
                inner.add(&virial::of_chunk(forces, positions, self.simd));
            }
            if self.moves() {
                stats.add(&grains.advance(chunk, forces, self.simd));
            }
        }
        periodic.add(&inner);
        (periodic, stats)
    }
}

type ForceKernel<S> = fn(Simd, ForceInput<'_, S>, PairChunk<'_>, bool) -> Virial;

fn kernel_for<S: ContactSprings, const SIZES: bool>(
    settings: &EngineSettings,
    as_saved: bool,
) -> ForceKernel<S> {
    match (settings.features(), as_saved) {
        (Features::Frictionless, _) => forces::<Frictionless<S, SIZES>>,
        (Features::Sliding, false) => forces::<Frictional<S, true, true, SIZES>>,
        (Features::NoSlip, false) => forces::<Frictional<S, true, false, SIZES>>,
        (Features::Sliding, true) => forces_once::<Frictional<S, false, true, SIZES>>,
        (Features::NoSlip, true) => forces_once::<Frictional<S, false, false, SIZES>>,
    }
}
