//! The search of contacts.

use super::error::SearchError;
use super::grid::Grid;
use crate::{Cell, Contact, Packing, Vec3, effective_radius};

/// Every contact (positive overlap) of spheres of `radii` (m) at `positions` (m, folded or not) in `cell`,
/// sorted by `(i, j, image)`: Hertz normal force from the overlap, no tangential force. Contacts across
/// periodic images are found in any cell, also one so small that a grain touches an image of itself or
/// several images of another. Positions and radii must be finite and radii positive.
///
/// # Errors
/// If two centres coincide, the index of an image is too large, grains fill the cell many times over, or lie
/// in a tiny part of it.
///
/// ```
/// use grainlab_core::{Cell, Material, Vec3, contact_search};
/// let (cell, r) = (Cell::cube(1.0).unwrap(), [0.11, 0.11]);
/// let found = contact_search::find(&cell, &[Vec3::zeros(), Vec3::new(0.0, 0.0, 0.8)], &r, |r, d| Material::GLASS.normal_force(r, d));
/// let found = found.unwrap();
/// assert_eq!((found.len(), found[0].image), (1, [0, 0, -1]));
/// assert!((found[0].overlap - 0.02).abs() < 1e-15);
/// ```
pub fn find(
    cell: &Cell,
    positions: &[Vec3],
    radii: &[f64],
    normal_force: impl Fn(f64, f64) -> f64,
) -> Result<Vec<Contact>, SearchError> {
    let grid = Grid::new(cell, positions, radii)?;
    let mut contacts = Vec::new();
    for i in 0..positions.len() {
        grid.visit(i, |j, lattice| {
            let (i, j, lattice) = if i <= j { (i, j, lattice) } else { (j, i, lattice.map(|n| -n)) };
            // Computed from unfolded positions, so that `Packing::branch` gives the same number.
            let step =
                |k: usize| lattice[k].saturating_add(grid.cells[i][k]).saturating_sub(grid.cells[j][k]);
            let steps: [i64; 3] = std::array::from_fn(step);
            let image = steps.map(i8::try_from);
            let [Ok(a), Ok(b), Ok(c)] = image else {
                // The image index is too large, which is only an error if the two touch.
                let shift = cell.matrix() * Vec3::new(steps[0] as f64, steps[1] as f64, steps[2] as f64);
                let touch = (positions[j] - positions[i] + shift).norm() < radii[i] + radii[j];
                return if touch { Err(SearchError::FarImage(i, j)) } else { Ok(()) };
            };
            let branch = positions[j] - positions[i] + cell.shift([a, b, c]);
            let distance = branch.norm();
            let overlap = radii[i] + radii[j] - distance;
            if overlap <= 0.0 {
                return Ok(());
            }
            if distance == 0.0 {
                return Err(SearchError::Coincident(i, j));
            }
            let r_eff = effective_radius(radii[i], radii[j]);
            let force = normal_force(r_eff, overlap);
            contacts.push(Contact::pressed(
                [i as u32, j as u32],
                [a, b, c],
                branch / distance,
                overlap,
                force,
            ));
            Ok(())
        })?;
    }
    contacts.sort_by_key(|c| (c.i, c.j, c.image));
    Ok(contacts)
}

/// Contacts of `packing` by its positions, as [`find`] returns them, with the normal forces of its contact law.
///
/// # Errors
/// As [`find`], with the ids of grains.
pub fn of_packing(packing: &Packing) -> Result<Vec<Contact>, SearchError> {
    let force = |r_eff, overlap| packing.law.normal_force(&packing.material, r_eff, overlap);
    find(&packing.cell, &packing.positions, &packing.radii, force).map_err(|e| e.with_ids(&packing.ids))
}
