//! Fabric tensor of fourth order.

use grainlab_core::results::FourthOrderFabric;
use grainlab_core::{Mat3, Packing, SymTensor};

/// Indices of the 15 components, in the order of [`FourthOrderFabric::components`].
fn indices() -> impl Iterator<Item = [usize; 4]> {
    (0..81).map(|n| [n / 27, n / 9 % 3, n / 3 % 3, n % 3]).filter(|indices| indices.is_sorted())
}

/// ⟨n n n n⟩ of the contacts; zero without contacts.
pub fn fourth_order_fabric(packing: &Packing) -> FourthOrderFabric {
    let indices: Vec<[usize; 4]> = indices().collect();
    let mut components = [0.0; 15];
    for c in &packing.contacts {
        let second = c.normal * c.normal.transpose();
        for (sum, [i, j, k, l]) in components.iter_mut().zip(&indices) {
            *sum += second[(*i, *j)] * second[(*k, *l)];
        }
    }
    let count = packing.contacts.len().max(1) as f64;
    components.iter_mut().for_each(|sum| *sum /= count);
    FourthOrderFabric { components, magnitude: magnitude(&components) }
}

/// 9 √(35/8) |H|, H = ⟨nnnn⟩ − (6/7) sym(L ⊗ δ) + (3/35) sym(δ ⊗ δ).
///
/// With ⟨nnnn⟩ of 1 + a4 P4(n·h), H = (a4/9) dev(hhhh), and |dev(hhhh)|² = 8/35.
fn magnitude(components: &[f64; 15]) -> f64 {
    let second = contracted(components).matrix();
    let unit = Mat3::identity();
    let mut squares = 0.0;
    for (value, indices) in components.iter().zip(indices()) {
        let harmonic = value - 6.0 / 7.0 * symmetrised(&second, &unit, indices)
            + 3.0 / 35.0 * symmetrised(&unit, &unit, indices);
        squares += multiplicity(indices) * harmonic * harmonic;
    }
    9.0 * (35.0 / 8.0 * squares).sqrt()
}

/// L = ⟨n n n n⟩ contracted once.
fn contracted(c: &[f64; 15]) -> SymTensor {
    SymTensor {
        xx: c[0] + c[3] + c[5],
        yy: c[3] + c[10] + c[12],
        zz: c[5] + c[12] + c[14],
        yz: c[4] + c[11] + c[13],
        xz: c[2] + c[7] + c[9],
        xy: c[1] + c[6] + c[8],
    }
}

/// Component of sym(a ⊗ b): the mean over the six ways to assign two of the four indices to `a` and two to `b`.
fn symmetrised(a: &Mat3, b: &Mat3, [i, j, k, l]: [usize; 4]) -> f64 {
    let pairings = [(i, j, k, l), (i, k, j, l), (i, l, j, k), (j, k, i, l), (j, l, i, k), (k, l, i, j)];
    pairings.iter().map(|&(p, q, r, s)| a[(p, q)] * b[(r, s)]).sum::<f64>() / 6.0
}

/// Number of occurrences of a component in the full tensor of 81: 4!/(a! b! c!) of the numbers of x, y and z.
fn multiplicity(indices: [usize; 4]) -> f64 {
    let factorial = |axis| (1..=indices.iter().filter(|index| **index == axis).count()).product::<usize>();
    (24 / (0..3).map(factorial).product::<usize>()) as f64
}
