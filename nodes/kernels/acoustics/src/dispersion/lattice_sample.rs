//! A small packing without symmetry.

use grainlab_core::{Cell, Contact, Mat3, Material, Packing, Vec3};

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
    let cell = Cell::new(Mat3::from_diagonal_element(edge)).unwrap();
    let n = positions.len();
    let mut packing = Packing {
        step: 0,
        time: 0.0,
        cell,
        deformation: Mat3::identity(),
        ids: (1..=n as u32).collect(),
        radii: vec![RADIUS; n],
        positions,
        velocities: vec![Vec3::zeros(); n],
        spins: vec![Vec3::zeros(); n],
        contacts: Vec::new(),
        material: Material::GLASS,
        law: Default::default(),
        friction: 0.1,
        time_step: 0.0,
    };
    for (i, j) in (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))) {
        let apart = packing.cell.fractional(&(packing.positions[j] - packing.positions[i]));
        let image = [0, 1, 2].map(|k| -apart[k].round() as i8);
        let branch = packing.positions[j] - packing.positions[i] + packing.cell.shift(image);
        let overlap = 2.0 * RADIUS - branch.norm();
        if overlap > 0.0 {
            let normal_force = packing.material.normal_force(0.5 * RADIUS, overlap);
            packing.contacts.push(Contact {
                i: i as u32,
                j: j as u32,
                image,
                overlap,
                normal: branch.normalize(),
                normal_force,
                tangential_force: Vec3::zeros(),
                rolling_force: Vec3::zeros(),
            });
        }
    }
    packing.validated().unwrap()
}
