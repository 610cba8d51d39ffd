//! A contact as a file lists it.

use grainlab_core::Vec3;

#[derive(Clone, Copy, Debug)]
pub(super) struct ListedContact {
    pub(super) line: usize,
    /// Ids of the two grains, in the file's order.
    pub(super) ids: (u32, u32),
    /// Unit vector from the second to the first grain, if the file has it.
    pub(super) normal: Option<Vec3>,
    /// m, if the file has it.
    pub(super) overlap: Option<f64>,
    /// On the first grain, N.
    pub(super) force: ListedForce,
    /// Elastic rolling force, N; the same seen from either grain.
    pub(super) rolling: Vec3,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum ListedForce {
    /// Along the normal, and across it.
    Split {
        normal: f64,
        tangential: Vec3,
    },
    Total(Vec3),
}
