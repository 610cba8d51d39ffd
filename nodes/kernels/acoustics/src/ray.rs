//! Where a wave goes, and how the grains move in it.

use grainlab_core::{Cell, Vec3};

/// Sine of the angle between ray and axis below which they count as parallel: the edges of a cell that was servoed are a little
/// off, and which way tells nothing.
const PARALLEL: f64 = 0.02;

/// One direction of propagation with the particle motions to send along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ray {
    /// Unit direction of propagation.
    pub direction: Vec3,
    /// The direction in units of the reciprocal vectors of the cell: the wave's planes are lattice planes of the periodic
    /// packing, which the dynamic methods need in order to repeat it along the path. `None` for any direction.
    pub indices: Option<[i32; 3]>,
    /// Unit particle motions, perpendicular to each other: one to three.
    pub motions: Vec<Vec3>,
}

impl Ray {
    /// The unit normal of the lattice planes (h k l) of `cell`: the direction of h b₁ + k b₂ + l b₃ with the reciprocal
    /// vectors b. `None` for (0 0 0).
    pub fn normal(cell: &Cell, indices: [i32; 3]) -> Option<Vec3> {
        let normal = cell.inverse().transpose() * Vec3::from(indices.map(f64::from));
        normal.try_normalize(0.0)
    }

    /// The particle motions of a medium that is isotropic about `axis`: along the ray; across the ray in its plane with the
    /// axis; across both. Where ray and axis are parallel, the last two are any perpendicular pair.
    pub fn motions_about(direction: &Vec3, axis: &Vec3) -> [Vec3; 3] {
        let across = direction.cross(axis).try_normalize(PARALLEL);
        let across = across.unwrap_or_else(|| {
            // The coordinate axis that the direction is furthest from.
            direction.cross(&Vec3::ith(direction.iamin(), 1.0)).normalize()
        });
        [*direction, across.cross(direction), across]
    }
}
