//! The frozen network as an operator on Bloch waves.
//!
//! Grain i moves as w_i exp(iq·x_i) with a complex amplitude w_i, the same in every repetition of the cell. The
//! relative displacement at a contact with the branch l is, up to a factor of modulus one, c (w_j − w_i) + is (w_j +
//! w_i) from displacements, and c (φ_j + φ_i) + is (φ_j − φ_i) times their levers from rotations, with c = cos(q·l/2)
//! and s = sin(q·l/2). A uniform amplitude is a plane wave, and the amplitude of a long wave changes little between
//! neighbours.

use crate::backbone::Backbone;
use crate::dispersion::waves::{Amplitude, Row};
use grainlab_core::Vec3;
use grainlab_micromechanics::network::{Block, ContactSpring, generalised_inverse};

#[derive(Clone, Copy, Debug)]
struct BlochContact {
    i: u32,
    j: u32,
    normal: [f64; 3],
    /// Mean lever of the two grains.
    lever: f64,
    /// Levers of i and j over their mean: exactly 1 where radii are equal.
    share: [f64; 2],
    tangential: f64,
    kn_minus_kt: f64,
    cos: f64,
    sin: f64,
}

/// The operator K(q), with the inverses of its diagonal blocks.
#[derive(Debug)]
pub(crate) struct Bloch<'a> {
    pub(crate) backbone: &'a Backbone,
    q: Vec3,
    contacts: Vec<BlochContact>,
    inverses: Vec<Block>,
}

impl<'a> Bloch<'a> {
    pub(crate) fn new(backbone: &'a Backbone, q: &Vec3) -> Self {
        let contact = |l: &ContactSpring| {
            let half = 0.5 * q.dot(&Vec3::from(l.branch()));
            let ContactSpring { i, j, normal, tangential, kn_minus_kt, .. } = *l;
            let levers = l.levers();
            let lever = 0.5 * (levers[0] + levers[1]);
            let share = levers.map(|own| own / lever);
            let (sin, cos) = (half.sin(), half.cos());
            BlochContact { i, j, normal, lever, share, tangential, kn_minus_kt, cos, sin }
        };
        let contacts: Vec<BlochContact> = backbone.network.contact_springs().iter().map(contact).collect();
        let mut blocks = vec![[[0.0; 6]; 6]; backbone.mass.len()];
        for contact in &contacts {
            for (grain, block) in contact.blocks() {
                let sum = &mut blocks[grain as usize];
                for row in 0..6 {
                    for column in 0..6 {
                        sum[row][column] += block[row][column];
                    }
                }
            }
        }
        let inverses = blocks.iter().map(generalised_inverse).collect();
        Self { backbone, q: *q, contacts, inverses }
    }

    /// y = K x.
    #[inline(always)]
    pub(crate) fn apply(&self, x: &[Amplitude], y: &mut [Amplitude]) {
        y.fill(Amplitude::STILL);
        for contact in &self.contacts {
            let (i, j) = (contact.i as usize, contact.j as usize);
            let (on_i, on_j) = contact.forces(&x[i], &x[j]);
            for (grain, force) in [(i, on_i), (j, on_j)] {
                for k in 0..6 {
                    y[grain].re[k] += force.re[k];
                    y[grain].im[k] += force.im[k];
                }
            }
        }
    }

    /// y = M x.
    #[inline(always)]
    pub(crate) fn apply_mass(&self, x: &[Amplitude], y: &mut [Amplitude]) {
        for (g, (x, y)) in x.iter().zip(y).enumerate() {
            let (mass, inertia) = (self.backbone.mass[g], self.backbone.inertia[g]);
            for k in 0..6 {
                let weight = if k < 3 { mass } else { inertia };
                y.re[k] = weight * x.re[k];
                y.im[k] = weight * x.im[k];
            }
        }
    }

    /// y = D⁻¹ x with the blocks D of single grains.
    #[inline(always)]
    pub(crate) fn precondition(&self, x: &[Amplitude], y: &mut [Amplitude]) {
        for ((inverse, x), y) in self.inverses.iter().zip(x).zip(y) {
            for (k, [first, rest @ ..]) in inverse.iter().enumerate() {
                let (mut re, mut im) = (*first * x.re[0], *first * x.im[0]);
                for (c, entry) in rest.iter().enumerate() {
                    re += *entry * x.re[c + 1];
                    im += *entry * x.im[c + 1];
                }
                (y.re[k], y.im[k]) = (re, im);
            }
        }
    }

    /// Removes floppy modes from x. Those of several grains are Bloch waves too, with a phase from grain to
    /// grain.
    pub(crate) fn project_out_floppy_modes(&self, x: &mut [Amplitude]) {
        let backbone = self.backbone;
        for cluster in backbone.clusters.iter().filter(|c| c.motions.iter().any(|m| m.is_free)) {
            let turns: Vec<(f64, f64)> = cluster.offsets.iter().map(|o| self.q.dot(o).sin_cos()).collect();
            for z in cluster.motions.iter().filter(|m| m.is_free).map(|m| &m.shape) {
                let (mut re, mut im) = (Row::ZERO, Row::ZERO);
                for (at, g) in cluster.grains.iter().enumerate() {
                    let (g, (sin, cos)) = (*g as usize, turns[at]);
                    for k in 0..6 {
                        let weight =
                            z[6 * at + k] * if k < 3 { backbone.mass[g] } else { backbone.inertia[g] };
                        re += weight * (cos * x[g].re[k] - sin * x[g].im[k]);
                        im += weight * (cos * x[g].im[k] + sin * x[g].re[k]);
                    }
                }
                for (at, g) in cluster.grains.iter().enumerate() {
                    let (g, (sin, cos)) = (*g as usize, turns[at]);
                    for k in 0..6 {
                        x[g].re[k] = x[g].re[k] - z[6 * at + k] * (cos * re + sin * im);
                        x[g].im[k] = x[g].im[k] - z[6 * at + k] * (cos * im - sin * re);
                    }
                }
            }
        }
    }
}

impl BlochContact {
    /// K x of the two grains by this contact alone.
    #[inline(always)]
    fn forces(&self, a: &Amplitude, b: &Amplitude) -> (Amplitude, Amplitude) {
        let (c, s) = (self.cos, self.sin);
        // c (b − a) + is (b + a) of displacements, c (b + a) + is (b − a) of rotations.
        let mut felt = Amplitude::STILL;
        for k in 0..3 {
            felt.re[k] = c * (b.re[k] - a.re[k]) - s * (b.im[k] + a.im[k]);
            felt.im[k] = c * (b.im[k] - a.im[k]) + s * (b.re[k] + a.re[k]);
        }
        let [of_i, of_j] = self.share;
        for k in 3..6 {
            let (a_re, a_im) = (of_i * a.re[k], of_i * a.im[k]);
            let (b_re, b_im) = (of_j * b.re[k], of_j * b.im[k]);
            felt.re[k] = c * (b_re + a_re) - s * (b_im - a_im);
            felt.im[k] = c * (b_im + a_im) + s * (b_re - a_re);
        }
        let (re, im) = (self.spring(&felt.re), self.spring(&felt.im));
        // The adjoint: ∓c − is … on i and j for displacements, c ± is for rotations.
        let (mut on_i, mut on_j) = (Amplitude::STILL, Amplitude::STILL);
        for k in 0..6 {
            let [side, arm] = if k < 3 { [-1.0, 1.0] } else { self.share };
            on_j.re[k] = arm * (c * re[k] + s * im[k]);
            on_j.im[k] = arm * (c * im[k] - s * re[k]);
            on_i.re[k] = side * (c * re[k] - s * im[k]);
            on_i.im[k] = side * (c * im[k] + s * re[k]);
        }
        (on_i, on_j)
    }

    /// Force and torque from the relative displacement.
    #[inline(always)]
    fn spring(&self, felt: &[Row; 6]) -> [Row; 6] {
        let [nx, ny, nz] = self.normal;
        let (mx, my, mz) = (self.lever * nx, self.lever * ny, self.lever * nz);
        let wx = felt[0] - (mz * felt[4] - my * felt[5]);
        let wy = felt[1] - (mx * felt[5] - mz * felt[3]);
        let wz = felt[2] - (my * felt[3] - mx * felt[4]);
        let along = self.kn_minus_kt * (nx * wx + ny * wy + nz * wz);
        let fx = self.tangential * wx + nx * along;
        let fy = self.tangential * wy + ny * along;
        let fz = self.tangential * wz + nz * along;
        // −m×f: the torque on either grain, up to the ratio of its lever to the mean.
        [fx, fy, fz, mz * fy - my * fz, mx * fz - mz * fx, my * fx - mx * fy]
    }

    /// Contribution of this contact to the diagonal blocks: real parts, which are positive semidefinite if the blocks
    /// are.
    fn blocks(&self) -> Vec<(u32, Block)> {
        let unit = |moves: bool, column: usize| {
            let mut x = Amplitude::STILL;
            x.re[column] = Row::of([f64::from(u8::from(moves)), 0.0, 0.0]);
            x
        };
        let block = |on_i: bool, on_j: bool| -> Block {
            let own =
                |moves: bool, force: &Amplitude, row: usize| if moves { force.re[row].0[0] } else { 0.0 };
            // Columns equal rows: the real parts are symmetric.
            std::array::from_fn(|column| {
                let (i, j) = self.forces(&unit(on_i, column), &unit(on_j, column));
                std::array::from_fn(|row| own(on_i, &i, row) + own(on_j, &j, row))
            })
        };
        if self.i == self.j {
            vec![(self.i, block(true, true))]
        } else {
            vec![(self.i, block(true, false)), (self.j, block(false, true))]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispersion::subspace::product;
    use crate::dispersion::waves::WAVES;

    #[test]
    fn the_operator_is_hermitian() {
        let packing = crate::dispersion::lattice_sample::lattice();
        let backbone = Backbone::new(&packing).unwrap();
        let bloch = Bloch::new(&backbone, &Vec3::new(3e3, -1e4, 5e3));
        let random = |seed: usize| -> Vec<Amplitude> {
            let value = |k: usize| ((seed * 7919 + k * 104_729) % 1009) as f64 / 1009.0 - 0.5;
            let rows =
                |g: usize| std::array::from_fn(|r| Row::of([0, 1, 2].map(|w| value(100 * g + 8 * r + w))));
            (0..packing.grains()).map(|g| Amplitude { re: rows(g), im: rows(g + 50) }).collect()
        };
        let (x, y) = (random(1), random(2));
        let (mut kx, mut ky) = (vec![Amplitude::STILL; x.len()], vec![Amplitude::STILL; x.len()]);
        bloch.apply(&x, &mut kx);
        bloch.apply(&y, &mut ky);
        for wave in 0..WAVES {
            let (one, other) = (product(&x, wave, &ky, wave), product(&kx, wave, &y, wave));
            assert!((one - other).norm() < 1e-12 * one.norm(), "{one} {other}");
        }
    }
}
