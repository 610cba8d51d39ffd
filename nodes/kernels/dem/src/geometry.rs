//! Where pairs are and whether they touch.

use crate::lanes::{BLOCK, Lanes, Octad, Quad, Rows, V3};
use crate::law::Law;
use crate::share::{Block, Sizes};

/// What all pairs are seen from.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) position: &'a [Quad],
    pub(crate) twist: &'a [Octad],
    /// Shift of each periodic image.
    pub(crate) shift: &'a [Quad],
    /// Columns of the strain rate, 1/s.
    pub(crate) rate: [[f64; 3]; 3],
    pub(crate) law: Law,
    pub(crate) dt: f64,
    pub(crate) equal: Equal,
}

/// What every pair has in common where grains are of one size.
#[derive(Clone, Copy)]
pub(crate) struct Equal {
    pub(crate) radius: f64,
    pub(crate) r_eff: f64,
    pub(crate) m_eff: f64,
}

/// Which grains some lanes of a block are of.
#[derive(Clone, Copy)]
pub(crate) struct Grains<'a, L> {
    pub(crate) i: Rows<'a, L>,
    pub(crate) j: Rows<'a, L>,
}

impl<'a, L: Lanes> Grains<'a, L> {
    #[inline(always)]
    pub(crate) fn of(view: &View<'_>, i: &'a [u32; BLOCK], j: &'a [u32; BLOCK], lane: usize) -> Self {
        let grains = view.position.len();
        Self { i: Rows::new(i, lane, grains), j: Rows::new(j, lane, grains) }
    }
}

/// Some lanes of a block, looked at.
pub(crate) struct Geometry<L: Lanes> {
    pub(crate) radius: [L; 2],
    pub(crate) branch: V3<L>,
    pub(crate) normal: V3<L>,
    pub(crate) distance: L,
    pub(crate) inverse_distance: L,
    /// Never negative.
    pub(crate) overlap: L,
    pub(crate) touching: L::Mask,
}

impl<L: Lanes> Geometry<L> {
    /// `None` where no lane touches.
    #[inline(always)]
    pub(crate) fn of<const SIZES: bool>(
        view: &View<'_>,
        block: &Block,
        sizes: Option<&Sizes>,
        lane: usize,
    ) -> Option<Self> {
        let grains = Grains::of(view, &block.i, &block.j, lane);
        let image = Rows::new(&block.image, lane, view.shift.len());
        let radius = match sizes {
            Some(s) if SIZES => [L::load(&s.radius_i, lane), L::load(&s.radius_j, lane)],
            _ => [L::splat(view.equal.radius); 2],
        };
        let apart = L::difference(view.position, grains.j, grains.i);
        let branch = apart + L::rows(view.shift, image);
        let reach = radius[0] + radius[1];
        let square = branch.dot(branch);
        if !L::any((reach * reach).gt(square)) {
            return None;
        }
        let distance = square.sqrt();
        // Not 1/distance: root and division need not wait for each other.
        let inverse_distance = distance * (L::splat(1.0) / square);
        let overlap = (reach - distance).max(L::splat(0.0));
        Some(Self {
            radius,
            branch,
            normal: branch.scale(inverse_distance),
            distance,
            inverse_distance,
            overlap,
            touching: overlap.gt(L::splat(0.0)),
        })
    }
}
