//! Bond-orientational order: which grains of a packing have the surroundings of a crystal.
//!
//! The surroundings of grain i are the directions to its neighbours. Their order parameter is the vector
//! q6m(i) = ⟨Y6m⟩ over these directions (Steinhardt, Nelson & Ronchetti, Phys. Rev. B 28, 784 (1983), Eq. 1.3). Two neighbours
//! are joined if their vectors, normalised, agree: Re Σ_m q6m(i) q6m(j)* > 0.7. A grain that is joined to more than seven
//! neighbours is solid-like (ten Wolde, Ruiz-Montero & Frenkel, J. Chem. Phys. 104, 9932 (1996), section III B). A simple cubic
//! crystal has six neighbours only: a grain that is joined to all its neighbours, six or seven, is solid-like as well. By the
//! addition theorem of spherical harmonics the product is a sum of Legendre polynomials P6 over pairs of directions.

use crate::contact_search::{self, SearchError};
use crate::packing::Packing;
use crate::tensor::Vec3;

/// Distance over the sum of the radii up to which grains are neighbours: it contains the 12 of close packing and the 14 of a
/// body-centred cubic crystal (at 1 and 1.155), and not the next ones, at 1.27 where grains overlap by a tenth of a diameter.
const NEIGHBOUR: f64 = 1.2;

/// Product of normalised order parameters above which two neighbours are joined.
const JOINED: f64 = 0.7;

/// Number of joined neighbours above which a grain is solid-like.
const SOLID: usize = 7;

/// Number of neighbours from which a grain that is joined to all of them is solid-like: a simple cubic crystal has as many.
const CUBIC: usize = 6;

/// Legendre polynomial P6 of a cosine.
fn p6(x: f64) -> f64 {
    let s = x * x;
    (((231.0 * s - 315.0) * s + 105.0) * s - 5.0) / 16.0
}

/// Sum of P6 over all pairs of directions.
fn product(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().map(|a| b.iter().map(|b| p6(a.dot(b))).sum::<f64>()).sum()
}

/// Returns the share of the grains of `packing` that are solid-like, from 0 to 1: 1 in simple, face-centred and body-centred
/// cubic and in hexagonal close-packed crystals, about 0 in random packings of spheres of nearly one size; 0 without grains. A
/// crystal with fewer than six neighbours, as diamond, has none.
///
/// # Errors
/// As [`contact_search::find`].
pub fn solid_like_share(packing: &Packing) -> Result<f64, SearchError> {
    let radii: Vec<f64> = packing.radii.iter().map(|r| NEIGHBOUR * r).collect();
    let near = contact_search::find(&packing.cell, &packing.positions, &radii, |_, _| 0.0)?;
    let mut directions = vec![Vec::new(); packing.grains()];
    for pair in &near {
        directions[pair.i as usize].push(pair.normal);
        directions[pair.j as usize].push(-pair.normal);
    }
    let norms: Vec<f64> = directions.iter().map(|of| product(of, of).max(0.0).sqrt()).collect();
    let mut joined = vec![0; packing.grains()];
    for [i, j] in near.iter().map(|pair| [pair.i, pair.j].map(|g| g as usize)) {
        if product(&directions[i], &directions[j]) > JOINED * norms[i] * norms[j] {
            joined[i] += 1;
            joined[j] += 1;
        }
    }
    let is_solid =
        |(joined, near): (&usize, &Vec<Vec3>)| *joined > SOLID || (*joined >= CUBIC && *joined == near.len());
    let solid = joined.iter().zip(&directions).filter(|grain| is_solid(*grain)).count();
    Ok(solid as f64 / packing.grains().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Mat3};

    /// Copies of a cell with these edges and sites (in edges), with the distance of neighbours 1 − `overlap` diameters.
    fn crystal(edges: [f64; 3], sites: &[[f64; 3]], overlap: f64, copies: u32) -> Packing {
        let edges = Vec3::from(edges) * (1.0 - overlap);
        let positions = sites.iter().map(|s| Vec3::from(*s).component_mul(&edges)).collect();
        let cell = Cell::new(Mat3::from_diagonal(&edges)).unwrap();
        Packing::at_rest(cell, vec![0.5; sites.len()], positions).repeated(copies).unwrap()
    }

    fn crystals(overlap: f64, copies: u32) -> [Packing; 4] {
        let (root2, root3) = (2f64.sqrt(), 3f64.sqrt());
        let cubic = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
        let hexagonal = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 1.0 / 6.0, 0.5], [0.0, 2.0 / 3.0, 0.5]];
        [
            crystal([root2; 3], &cubic, overlap, copies),
            crystal([1.0, root3, 2.0 * root2 / root3], &hexagonal, overlap, copies),
            crystal([2.0 / root3; 3], &[[0.0; 3], [0.5; 3]], overlap, copies),
            crystal([1.0; 3], &[[0.0; 3]], overlap, copies),
        ]
    }

    #[test]
    fn every_grain_of_a_crystal_is_solid_like_at_any_overlap_and_in_cells_of_one_unit() {
        for overlap in [-0.02, 0.0, 0.1] {
            for copies in [1, 3] {
                for (k, p) in crystals(overlap, copies).iter().enumerate() {
                    assert_eq!(solid_like_share(p), Ok(1.0), "{k}, overlap {overlap}, {copies} copies");
                }
            }
        }
    }

    /// Displacements of a hundredth of a diameter occur in a crystal under load; displacements of 0.3 diameters leave no crystal.
    #[test]
    fn a_disturbed_crystal_is_one_until_its_order_is_gone() {
        for p in crystals(0.0, 4) {
            let shaken = |by: f64| {
                let mut dice = 1u64;
                let mut next = || {
                    dice = dice.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                    (dice >> 11) as f64 / (1u64 << 53) as f64 - 0.5
                };
                let positions =
                    p.positions.iter().map(|x| x + Vec3::from_fn(|_, _| 2.0 * by * next())).collect();
                solid_like_share(&Packing { positions, ..p.clone() }).unwrap()
            };
            assert!(shaken(0.03) > 0.95 && shaken(0.4) < 0.05, "{} {}", shaken(0.03), shaken(0.4));
        }
    }

    #[test]
    fn grains_without_six_neighbours_are_not_solid_like() {
        let (half, quarter) = (0.5, 0.25);
        let cubic = [[0.0, 0.0, 0.0], [half, half, 0.0], [half, 0.0, half], [0.0, half, half]];
        let sites: Vec<_> = cubic.into_iter().flat_map(|s| [s, s.map(|x| x + quarter)]).collect();
        let diamond = crystal([4.0 / 3f64.sqrt(); 3], &sites, 0.01, 2);
        let gas = crystal([3.0; 3], &[[0.0; 3]], 0.01, 3);
        for p in [diamond, gas] {
            assert_eq!(solid_like_share(&p), Ok(0.0));
        }
    }
}
