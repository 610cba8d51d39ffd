//! One pass over the chunks of grains: forces, motion, or both at once, compiled for the features of the phase.
//!
//! The force on a grain is complete once its own chunk was evaluated. So the grain can move at once, while its data is still
//! in the cache. The pairs of a chunk read its own grains and later ones only (the first grain of a pair has the lower
//! number). So with one subdomain grains move in the state itself; with several, each subdomain has a copy. The bits are the
//! same.

use super::integrate::{self, Motion, SpeedStats};
use crate::domain::accumulator::ChunkForces;
use crate::domain::compute::Compute;
use crate::domain::distributed_state::{DistributedState, SubdomainView};
use crate::domain::state::State;
use crate::force::geometry::ForceInput;
use crate::force::kernel::{FrictionalKernel, FrictionlessKernel};
use crate::force::virial::{self, Virial};
use crate::pairs::contacts::Contacts;
use crate::pairs::subdomain_pairs::SubdomainPairs;
use crate::pairs::types::PairChunk;
use crate::settings::{EngineSettings, Features};
use crate::simd::instruction_set::Simd;
use crate::simd::simd_f64::{CHUNK_SIZE, F64x4};
use grainlab_core::contact::{ContactSprings, LawVisitor, TangentialLaw};

/// What a pass does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PassKind {
    /// Evaluates forces at the present positions.
    Forces,
    /// The same, with the tangential history as it is instead of one step further (after a resume).
    ForcesAsSaved,
    /// Moves all grains over one step, under the forces last evaluated.
    Motion,
    /// Evaluates forces, and moves all grains over one step under them.
    ForcesAndMotion,
}

/// The data of a pass.
pub(crate) struct Pass<'a> {
    pub(crate) state: &'a mut State,
    pub(crate) copies: &'a mut DistributedState,
    pub(crate) contacts: &'a mut Contacts,
    pub(crate) settings: &'a EngineSettings,
    pub(crate) compute: &'a Compute,
}

impl Pass<'_> {
    /// Runs over all grains. The virial is summed if `with_virial`, where forces are evaluated.
    pub(crate) fn run(self, kind: PassKind, with_virial: bool) -> (Virial, SpeedStats) {
        let (law, material) = (self.state.law, self.state.material);
        law.visit(&material, LawPass { pass: self, kind, with_virial })
    }
}

/// A pass, compiled for each contact law.
struct LawPass<'a> {
    pass: Pass<'a>,
    kind: PassKind,
    with_virial: bool,
}

impl LawVisitor for LawPass<'_> {
    type Output = (Virial, SpeedStats);

    fn visit<S: ContactSprings>(self, springs: S) -> Self::Output {
        let Self { pass: Pass { state, copies, contacts, settings, compute }, kind, with_virial } = self;
        let kernel = force_kernel::<S>(settings, kind, !state.is_monodisperse());
        let over = SubdomainPass { kind, kernel, simd: compute.simd(), with_virial };
        if let [pairs] = &mut contacts.subdomains[..] {
            copies.clear();
            let offset = contacts.images.offsets();
            return join([over.run(pairs, &mut WholeState { state, offset, settings, springs })]);
        }
        if !copies.is_current() {
            let subdomains: Vec<_> =
                contacts.subdomains.iter().map(|p| (p.subdomain(), p.ghosts())).collect();
            copies.scatter(state, &subdomains, compute);
        }
        let input = ForceInput::new(state, contacts.images.offsets(), settings, springs);
        let motion = Motion::of(state, settings);
        let work = |(mut view, pairs): (SubdomainView<'_>, &mut SubdomainPairs)| {
            view.receive_halo();
            let mut grains = SubdomainCopy { view, input, motion };
            let parts = over.run(pairs, &mut grains);
            if over.moves() {
                grains.view.send_halo();
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

/// Where the grains of a subdomain are stored.
trait GrainStorage<S> {
    /// The input of the force kernel.
    fn force_input(&self) -> ForceInput<'_, S>;

    /// Moves the grains of a chunk.
    fn advance(&mut self, chunk: usize, forces: impl ChunkForces, simd: Simd) -> SpeedStats;
}

/// In the state itself.
struct WholeState<'a, S> {
    state: &'a mut State,
    offset: &'a [F64x4],
    settings: &'a EngineSettings,
    springs: S,
}

impl<S: ContactSprings> GrainStorage<S> for WholeState<'_, S> {
    fn force_input(&self) -> ForceInput<'_, S> {
        ForceInput::new(self.state, self.offset, self.settings, self.springs)
    }

    fn advance(&mut self, chunk: usize, forces: impl ChunkForces, simd: Simd) -> SpeedStats {
        let (motion, grains) = Motion::split(self.state, self.settings);
        integrate::advance(&motion, forces, chunk * CHUNK_SIZE, grains.chunk(chunk, CHUNK_SIZE), simd)
    }
}

/// In the copy of the subdomain.
struct SubdomainCopy<'a, S> {
    view: SubdomainView<'a>,
    /// The input with the grains of the state.
    input: ForceInput<'a, S>,
    motion: Motion<'a>,
}

impl<S: ContactSprings> GrainStorage<S> for SubdomainCopy<'_, S> {
    fn force_input(&self) -> ForceInput<'_, S> {
        ForceInput { position: self.view.positions(), twist: self.view.twists(), ..self.input }
    }

    fn advance(&mut self, chunk: usize, forces: impl ChunkForces, simd: Simd) -> SpeedStats {
        let grains = self.view.grains_mut().chunk(chunk, CHUNK_SIZE);
        integrate::advance(&self.motion, forces, chunk * CHUNK_SIZE, grains, simd)
    }
}

/// A pass over one subdomain.
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

    /// Virial and speeds of each owned part.
    fn run(&self, pairs: &mut SubdomainPairs, grains: &mut impl GrainStorage<S>) -> PartResults {
        if self.kind == PassKind::Motion {
            return self.motion(pairs, grains);
        }
        let owned = pairs.subdomain().parts();
        for part in 0..owned.start {
            self.earlier_part(pairs, part, grains);
        }
        owned.map(|part| self.owned_part(pairs, part, grains)).collect()
    }

    fn motion(&self, pairs: &SubdomainPairs, grains: &mut impl GrainStorage<S>) -> PartResults {
        let subdomain = pairs.subdomain();
        let mut parts = vec![(Virial::default(), SpeedStats::default()); subdomain.parts().len()];
        for (chunk, forces) in subdomain.chunks().zip(pairs.stored_forces()) {
            let part = subdomain.part_of(chunk) - subdomain.parts().start;
            parts[part].1.add(&grains.advance(chunk, forces, self.simd));
        }
        parts
    }

    /// Pairs of an earlier subdomain that act on owned grains. Their virial is summed there.
    fn earlier_part(&self, pairs: &mut SubdomainPairs, part: usize, grains: &impl GrainStorage<S>) {
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
        grains: &mut impl GrainStorage<S>,
    ) -> (Virial, SpeedStats) {
        let first = pairs.subdomain().chunks_of(part).start;
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

/// The force kernel compiled for these features.
fn force_kernel<S: ContactSprings>(settings: &EngineSettings, kind: PassKind, sizes: bool) -> ForceKernel<S> {
    let as_saved = kind == PassKind::ForcesAsSaved;
    if sizes { kernel_for::<S, true>(settings, as_saved) } else { kernel_for::<S, false>(settings, as_saved) }
}

fn kernel_for<S: ContactSprings, const SIZES: bool>(
    settings: &EngineSettings,
    as_saved: bool,
) -> ForceKernel<S> {
    let rescaled = settings.tangential == TangentialLaw::Rescaled;
    match (settings.features(), rescaled, as_saved) {
        (Features::Frictionless, ..) => frictionless::<S, SIZES>,
        (Features::Sliding, true, false) => frictional::<S, true, true, true, SIZES>,
        (Features::Sliding, false, false) => frictional::<S, true, true, false, SIZES>,
        (Features::NoSlip, true, false) => frictional::<S, true, false, true, SIZES>,
        (Features::NoSlip, false, false) => frictional::<S, true, false, false, SIZES>,
        (Features::Sliding, _, true) => frictional::<S, false, true, false, SIZES>,
        (Features::NoSlip, _, true) => frictional::<S, false, false, false, SIZES>,
    }
}

fn frictionless<S: ContactSprings, const SIZES: bool>(
    simd: Simd,
    input: ForceInput<'_, S>,
    chunk: PairChunk<'_>,
    with_virial: bool,
) -> Virial {
    simd.run(FrictionlessKernel::<S, SIZES> { input, chunk, with_virial })
}

fn frictional<
    S: ContactSprings,
    const ADVANCE: bool,
    const SLIDING: bool,
    const RESCALED: bool,
    const SIZES: bool,
>(
    simd: Simd,
    input: ForceInput<'_, S>,
    chunk: PairChunk<'_>,
    with_virial: bool,
) -> Virial {
    simd.run(FrictionalKernel::<S, ADVANCE, SLIDING, RESCALED, SIZES> { input, chunk, with_virial })
}
