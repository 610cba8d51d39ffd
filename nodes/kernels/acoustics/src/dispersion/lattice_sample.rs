//! A small packing without symmetry.

use grainlab_core::{Cell, Packing, Vec3, contact_search};

/// 3 × 3 × 3 grains, nearly simple cubic, with unequal overlaps.
pub(crate) fn lattice() -> Packing {
    const N: usize = 3;
    const RADIUS: f64 = 1e-4;
    let edge = N as f64 * 2.0 * RADIUS * 0.999;
    let at = |i: usize, j: usize, k: usize| (i * N + j) * N + k;
    let mut positions = Vec::new();
    for (i, j, k) in (0..N).flat_map(|i| (0..N).flat_map(move |j| (0..N).map(move |k| (i, j, k)))) {
        let shake = |s: usize| 5e-4 * RADIUS * ((at(i, j, k) * 31 + s * 17) % 13) as f64 / 13.0;
        let spacing = edge / N as f64;
        positions.push(
            Vec3::new(i as f64, j as f64, k as f64) * spacing + Vec3::new(shake(1), shake(2), shake(3)),
        );
    }
    let cell = Cell::cube(edge).unwrap();
    let n = positions.len();
    let mut packing = Packing {
        ids: (1..=n as u32).collect(),
        friction: 0.1,
        ..Packing::at_rest(cell, vec![RADIUS; n], positions)
    };
    packing.contacts = contact_search::of_packing(&packing).unwrap();
    packing.validated().unwrap()
}
