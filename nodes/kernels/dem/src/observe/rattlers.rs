//! Rattlers, and the net force on the other grains.

use super::contact_sums::SlotForces;
use crate::pairs::contacts::Contacts;
use crate::simd::simd_f64::BLOCK_SIZE;
use grainlab_core::backbone;

pub(super) struct NetForces {
    /// True for each grain that is no rattler.
    backbone: Vec<bool>,
    /// Number of contacts, those of rattlers included.
    pub(super) contacts: u32,
    /// Net force on each grain, N.
    net_force: Vec<[f64; 3]>,
}

impl NetForces {
    /// Rattlers are removed recursively, until each grain left has at least `min_contacts`. `force` (N) is that on the second
    /// grain of each slot.
    pub(super) fn new(contacts: &Contacts, force: &[SlotForces], grains: usize, min_contacts: u32) -> Self {
        let mut net_force = vec![[0.0; 3]; grains];
        let mut pairs = vec![[0u32; 2]; contacts.slots()];
        let mut touching = 0;
        for (block, force) in contacts.blocks().zip(force) {
            for lane in 0..BLOCK_SIZE {
                // A slot that pads the block has no force and does not touch.
                let (i, j) = (block.i[lane] as usize, block.j[lane] as usize);
                for (k, f) in force.iter().enumerate() {
                    net_force[i][k] -= f[lane];
                    net_force[j][k] += f[lane];
                }
                let touches = block.contact_radius[lane] > 0.0;
                pairs[touching] = [block.i[lane], block.j[lane]];
                touching += usize::from(touches);
            }
        }
        pairs.truncate(touching);
        let backbone = backbone(grains, pairs, min_contacts);
        Self { backbone, contacts: touching as u32, net_force }
    }

    /// Mean net force of the grains that are no rattlers, N; `None` if there are none.
    pub(super) fn mean(&self) -> Option<f64> {
        let count = self.backbone.iter().filter(|b| **b).count();
        let size = |n: &[f64; 3]| (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        let backbone = self.net_force.iter().zip(&self.backbone).filter(|(_, backbone)| **backbone);
        let sum: f64 = backbone.map(|(n, _)| size(n)).sum();
        (count > 0).then(|| sum / count as f64)
    }
}
