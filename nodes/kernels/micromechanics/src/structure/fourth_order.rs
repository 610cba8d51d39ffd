//! Fabric tensor of fourth order.

use grainlab_core::results::FourthOrderFabric;
use grainlab_core::{Packing, SymTensor};

/// Exponents of x, y and z of the 15 components, in the order of [`FourthOrderFabric::components`].
const POWERS: [[i32; 3]; 15] = [
    [4, 0, 0],
    [3, 1, 0],
    [3, 0, 1],
    [2, 2, 0],
    [2, 1, 1],
    [2, 0, 2],
    [1, 3, 0],
    [1, 2, 1],
    [1, 1, 2],
    [1, 0, 3],
    [0, 4, 0],
    [0, 3, 1],
    [0, 2, 2],
    [0, 1, 3],
    [0, 0, 4],
];

/// ⟨n n n n⟩ of the contacts; zero without contacts.
pub fn fourth_order_fabric(packing: &Packing) -> FourthOrderFabric {
    let mut components = [0.0; 15];
    for c in &packing.contacts {
        let (x, y, z) = (c.normal.x, c.normal.y, c.normal.z);
        let (xx, xy, xz, yy, yz, zz) = (x * x, x * y, x * z, y * y, y * z, z * z);
        let products = [
            xx * xx,
            xx * xy,
            xx * xz,
            xx * yy,
            xx * yz,
            xx * zz,
            xy * yy,
            xy * yz,
            xy * zz,
            xz * zz,
            yy * yy,
            yy * yz,
            yy * zz,
            yz * zz,
            zz * zz,
        ];
        components.iter_mut().zip(products).for_each(|(sum, p)| *sum += p);
    }
    let count = packing.contacts.len().max(1) as f64;
    components.iter_mut().for_each(|sum| *sum /= count);
    FourthOrderFabric { components, magnitude: magnitude(&components) }
}

/// 9 √(35/8) |H|, H = ⟨nnnn⟩ − (6/7) sym(L ⊗ δ) + (3/35) sym(δ ⊗ δ).
///
/// With ⟨nnnn⟩ of 1 + a4 P4(n·h), H = (a4/9) dev(hhhh), and |dev(hhhh)|² = 8/35.
fn magnitude(components: &[f64; 15]) -> f64 {
    let second = contracted(components);
    let mut squares = 0.0;
    for (value, powers) in components.iter().zip(POWERS) {
        let harmonic =
            value - 6.0 / 7.0 * second_times_unit(&second, powers) + 3.0 / 35.0 * unit_times_unit(powers);
        squares += multiplicity(powers) * harmonic * harmonic;
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

/// Component of sym(L ⊗ δ): the mean over the six ways to assign two of the four indices to L and two to δ.
fn second_times_unit(second: &SymTensor, powers: [i32; 3]) -> f64 {
    over_pairings(powers, |i, j, k, l| second.matrix()[(i, j)] * unit(k, l))
}

/// Component of sym(δ ⊗ δ).
fn unit_times_unit(powers: [i32; 3]) -> f64 {
    over_pairings(powers, |i, j, k, l| unit(i, j) * unit(k, l))
}

fn unit(i: usize, j: usize) -> f64 {
    if i == j { 1.0 } else { 0.0 }
}

fn over_pairings(powers: [i32; 3], term: impl Fn(usize, usize, usize, usize) -> f64) -> f64 {
    let mut indices = (0..3).flat_map(|axis| std::iter::repeat_n(axis, powers[axis] as usize));
    let [i, j, k, l]: [usize; 4] = std::array::from_fn(|_| indices.next().unwrap_or(0));
    let pairings = [(i, j, k, l), (i, k, j, l), (i, l, j, k), (j, k, i, l), (j, l, i, k), (k, l, i, j)];
    pairings.iter().map(|&(a, b, c, d)| term(a, b, c, d)).sum::<f64>() / 6.0
}

/// Number of occurrences of a component in the full tensor of 81: 4!/(a! b! c!).
fn multiplicity(powers: [i32; 3]) -> f64 {
    let factorial = |n: i32| (1..=n).product::<i32>();
    f64::from(24 / powers.map(factorial).iter().product::<i32>())
}
