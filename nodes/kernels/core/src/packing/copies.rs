//! Copies of a packing, side by side.

use super::Packing;
use crate::cell::Cell;
use crate::tensor::Vec3;

impl Packing {
    /// The packing repeated `copies` times along each edge of its cell, with its contacts and their forces: the same stress and
    /// structure, and `copies`³ times the grains. `None` for no copies, or more grains than there are ids.
    pub fn repeated(&self, copies: u32) -> Option<Self> {
        let matrix = *self.cell.matrix();
        let cell = Cell::new(matrix * f64::from(copies))?;
        let (grains, times) = (u32::try_from(self.grains()).ok()?, copies.checked_pow(3)?);
        grains.checked_mul(times)?;
        let place = |copy: u32| [copy / (copies * copies), copy / copies % copies, copy % copies];
        let shift = |copy| matrix * Vec3::from(place(copy).map(f64::from));
        let mut positions = Vec::with_capacity(self.grains() * times as usize);
        for copy in 0..times {
            positions.extend(self.positions.iter().map(|x| x + shift(copy)));
        }
        let along = i64::from(copies);
        let mut contacts = Vec::with_capacity(self.contacts.len() * times as usize);
        for copy in 0..times {
            let place = place(copy).map(i64::from);
            for c in &self.contacts {
                let reached: [i64; 3] = std::array::from_fn(|k| place[k] + i64::from(c.image[k]));
                let [a, b, d] = reached.map(|k| k.rem_euclid(along) as u32);
                let image = reached.map(|k| k.div_euclid(along) as i8);
                let (i, j) = (copy * grains + c.i, ((a * copies + b) * copies + d) * grains + c.j);
                contacts.push(c.named(i, j, image));
            }
        }
        contacts.sort_unstable_by_key(|c| (c.i, c.j, c.image));
        let times = times as usize;
        Some(Self {
            cell,
            ids: (0..grains * times as u32).collect(),
            radii: self.radii.repeat(times),
            velocities: self.velocities.repeat(times),
            spins: self.spins.repeat(times),
            positions,
            contacts,
            path: self.path.clone(),
            ..*self
        })
    }
}
