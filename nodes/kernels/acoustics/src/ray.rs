//! Direction of propagation and polarizations.

use grainlab_core::{Cell, Vec3};

/// Sine of the angle between ray and axis below which they count as parallel: the edges of a servo-controlled cell
/// deviate a little, in an arbitrary direction.
const PARALLEL: f64 = 0.02;

/// One direction of propagation with the polarizations to send along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ray {
    /// Unit direction of propagation.
    pub direction: Vec3,
    /// The direction in units of the reciprocal vectors of the cell: the lattice planes (h k l) of the periodic packing
    /// normal to it, along which the methods with moving grains repeat the packing. `None` for any direction.
    pub indices: Option<[i32; 3]>,
    /// One to three perpendicular unit polarizations (particle motions).
    pub polarizations: Vec<Vec3>,
}

impl Ray {
    /// The unit normal of the lattice planes (h k l) of `cell`: the direction of h b₁ + k b₂ + l b₃ with the reciprocal
    /// vectors b. `None` for (0 0 0).
    pub fn normal(cell: &Cell, indices: [i32; 3]) -> Option<Vec3> {
        let normal = cell.inverse().transpose() * Vec3::from(indices.map(f64::from));
        normal.try_normalize(0.0)
    }

    /// The polarizations of a medium that is isotropic about `axis`: along the ray; across the ray in its plane with
    /// the axis; across both. If ray and axis are parallel, the last two are any perpendicular pair.
    pub fn polarizations_about(direction: &Vec3, axis: &Vec3) -> [Vec3; 3] {
        let across = direction.cross(axis).try_normalize(PARALLEL);
        let across = across.unwrap_or_else(|| {
            // The coordinate axis furthest from the direction.
            direction.cross(&Vec3::ith(direction.iamin(), 1.0)).normalize()
        });
        [*direction, across.cross(direction), across]
    }
}
