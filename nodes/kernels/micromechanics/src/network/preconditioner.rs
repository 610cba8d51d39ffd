//! Inverse of a grain's own 6×6 block, singular or not.

/// A symmetric 6×6 block: three displacements, then three scaled rotations.
pub type Block = [[f64; 6]; 6];

/// Pivots below this fraction of their original diagonal are directions without stiffness: rounding leaves
/// about 10⁻¹⁶ there, and real blocks of spheres stay above 10⁻⁸.
const ZERO_PIVOT: f64 = 1e-12;

/// A symmetric generalised inverse G of a positive semidefinite block A: A G A = A.
///
/// Swept with diagonal pivoting; coordinates whose pivot vanishes get zero rows. A right-hand side in the
/// range of A is solved exactly. Residuals of the network lie in that range: a null vector of the block of a
/// grain is a null vector of the whole network.
pub fn generalised_inverse(block: &Block) -> Block {
    let mut a = *block;
    let largest = (0..6).fold(0.0f64, |m, k| m.max(block[k][k]));
    let diagonal: [f64; 6] = std::array::from_fn(|k| block[k][k]);
    let mut swept = [false; 6];
    for _ in 0..6 {
        // Largest remaining pivot relative to its original diagonal; the first among equals, so that the
        // order is deterministic.
        let mut pivot = None;
        let mut best = ZERO_PIVOT;
        for k in 0..6 {
            if !swept[k] && diagonal[k] > ZERO_PIVOT * largest && a[k][k] > best * diagonal[k] {
                best = a[k][k] / diagonal[k];
                pivot = Some(k);
            }
        }
        let Some(k) = pivot else { break };
        sweep(&mut a, k);
        swept[k] = true;
    }
    std::array::from_fn(|i| std::array::from_fn(|j| if swept[i] && swept[j] { -a[i][j] } else { 0.0 }))
}

fn sweep(a: &mut Block, k: usize) {
    let d = 1.0 / a[k][k];
    let row = a[k];
    for i in 0..6 {
        if i != k {
            for j in 0..6 {
                if j != k {
                    a[i][j] -= row[i] * row[j] * d;
                }
            }
        }
    }
    for i in 0..6 {
        a[i][k] = row[i] * d;
        a[k][i] = row[i] * d;
    }
    a[k][k] = -d;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product(a: &Block, b: &Block) -> Block {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| a[i][k] * b[k][j]).sum()))
    }

    /// A = Σ v vᵀ over `rank` fixed vectors.
    fn of_rank(rank: usize) -> Block {
        let v = |r: usize, i: usize| ((3 * r + 7 * i + 1) as f64).sin();
        std::array::from_fn(|i| std::array::from_fn(|j| (0..rank).map(|r| v(r, i) * v(r, j)).sum()))
    }

    #[test]
    fn generalised_inverse_solves_every_consistent_system_at_any_rank() {
        for rank in 0..=6 {
            let a = of_rank(rank);
            let g = generalised_inverse(&a);
            let back = product(&product(&a, &g), &a);
            for i in 0..6 {
                for j in 0..6 {
                    // The smallest pivot of these blocks is about 10⁻², at the cost of two or three digits.
                    assert!((back[i][j] - a[i][j]).abs() < 1e-11, "rank {rank} [{i}][{j}]");
                    assert!((g[i][j] - g[j][i]).abs() <= 1e-9 * g[i][i].abs().max(g[j][j].abs()));
                }
            }
        }
    }
}
