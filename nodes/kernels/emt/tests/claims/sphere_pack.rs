//! The pack with contacts in all directions alike against integration over the sphere, along paths of strain, and against
//! the limits of Walton, J. Mech. Phys. Solids 35, 213 (1987).

use crate::sphere::directions;
use grainlab_core::{Mat3, Material, Stiffness};
use grainlab_emt::{ContactHistory, Moduli, Modulus, PackShape};
use nalgebra::Matrix6;
use std::f64::consts::PI;

const HISTORIES: [ContactHistory; 3] =
    [ContactHistory::HydrostaticFirst, ContactHistory::Proportional, ContactHistory::Slip];

/// Shapes of strain from along e3 alone to across it alone, and k_t/k_n from that of ν = 1/2 to that of ν = 0.
fn grid() -> impl Iterator<Item = (f64, f64)> {
    (0..=30).flat_map(|i| [2.0 / 3.0, 0.8, 1.0].map(|ratio| (-0.5 + 0.025 * f64::from(i), ratio)))
}

fn of(g: f64, stiffness_ratio: f64) -> PackShape {
    PackShape::new(g, stiffness_ratio).unwrap()
}

/// Two spheres of this strain in direction x: the root of the overlap over that of equal strain.
fn root(g: f64, x: f64) -> f64 {
    (1.0 + 2.0 * g - 6.0 * g * x * x).max(0.0).sqrt()
}

/// Every component of C = ⟨(k_n − k_t) nnnn + k_t (δ_ik n_j n_l + …)/4⟩, without a spin of the grains.
#[test]
fn stiffness_is_the_integral_over_the_sphere() {
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
    let sphere = directions();
    for (g, stiffness_ratio) in grid() {
        let mut c = Matrix6::zeros();
        for (d, weight) in &sphere {
            let normal = weight / (4.0 * PI) * root(g, d.z);
            let tangential = normal * stiffness_ratio;
            let delta = |i: usize, j: usize| f64::from(u8::from(i == j));
            for (row, (i, j)) in PAIRS.into_iter().enumerate() {
                for (column, (k, l)) in PAIRS.into_iter().enumerate() {
                    let sides = delta(i, k) * d[j] * d[l]
                        + delta(i, l) * d[j] * d[k]
                        + delta(j, k) * d[i] * d[l]
                        + delta(j, l) * d[i] * d[k];
                    c[(row, column)] +=
                        (normal - tangential) * d[i] * d[j] * d[k] * d[l] + 0.25 * tangential * sides;
                }
            }
        }
        let closed = of(g, stiffness_ratio).stiffness();
        let off = (c - closed.stiffness().0).amax();
        assert!(off < 1e-12, "g {g}, k_t/k_n {stiffness_ratio}: {off}");
        assert!(Stiffness(c).transverse_isotropy().residual < 1e-12);
        assert!((closed.g12 - 0.5 * (closed.c11 - closed.c12)).abs() < 1e-15);
    }
}

/// The closed form of Johnson et al., with α² = ε/e3 of the equal strain ε and the further strain e3, B = 2/(π C_n) and
/// C = (4/π)(1/C_t − 1/C_n), where C_t/C_n = k_t/k_n, and Iₙ = ∫₀¹ xⁿ (α² + x²)^½ dx.
#[test]
fn stiffness_is_the_published_one_where_the_further_strain_compresses() {
    for (alpha, ratio) in [0.05, 0.3, 1.0, 3.0, 8.0].into_iter().flat_map(|a: f64| [0.7, 0.9].map(|r| (a, r)))
    {
        let square = alpha * alpha;
        let end = (1.0 + square).sqrt();
        let i0 = 0.5 * (end + square * ((end + 1.0) / alpha).ln());
        let i2 = 0.25 * (end.powi(3) - square * i0);
        let i4 = (end.powi(3) - 3.0 * square * i2) / 6.0;
        // In units of 2/(π C_n).
        let (b, c) = (1.0, 2.0 * (1.0 / ratio - 1.0));
        let flat = i0 - 2.0 * i2 + i4;
        let published = [
            2.0 * b * (i0 - i2) + 0.75 * c * flat,
            0.25 * c * flat,
            c * (i2 - i4),
            4.0 * b * i2 + 2.0 * c * i4,
            0.5 * b * (i0 + i2) + c * (i2 - i4),
            b * (i0 - i2) + 0.25 * c * flat,
        ];
        // 1 + 2g : −6g as ε : e3.
        let t = of(-1.0 / (6.0 * square + 2.0), ratio).stiffness();
        for (found, expected) in [t.c11, t.c12, t.c13, t.c33, t.g13, t.g12].into_iter().zip(published) {
            let off = found / t.c33 - expected / published[3];
            assert!(off.abs() < 1e-12, "alpha {alpha}, k_t/k_n {ratio}: {found} {expected}");
        }
    }
}

#[test]
fn contact_stiffness_and_pressure_are_the_integrals_over_the_sphere() {
    let sphere = directions();
    for (g, stiffness_ratio) in grid() {
        let (mut fabric, mut pressure) = (Mat3::zeros(), 0.0);
        for (d, weight) in &sphere {
            let s = root(g, d.z);
            fabric += d * d.transpose() * (weight / (4.0 * PI) * s);
            pressure += weight / (4.0 * PI) * s.powi(3) / 3.0;
        }
        fabric /= fabric.trace();
        let shape = of(g, stiffness_ratio);
        let eps = 2.5 * (fabric[(2, 2)] - fabric[(0, 0)]);
        assert!((shape.eps_stiffness() - eps).abs() < 1e-12, "g {g}: {eps}");
        assert!((shape.pressure() - pressure).abs() < 1e-12, "g {g}: {pressure}");
        for history in HISTORIES {
            let [across, along] = shape.stress(history);
            assert!(((2.0 * across + along) / 3.0 - pressure).abs() < 1e-14, "{history:?}");
        }
    }
}

/// dσ = C dE along both paths without slip, with C of the strain reached. Units: φ k E* = 1.
#[test]
fn stress_without_slip_is_the_work_of_the_stiffness_along_the_path() {
    const STEPS: usize = 1000;
    for (g, ratio) in grid().filter(|(g, _)| (-0.4..0.2).contains(g)) {
        let ends = [1.0 + 2.0 * g, 1.0 - 4.0 * g];
        // σ_11 and σ_33 for strains across and along at t, and their rates.
        let integrate = |strain: &dyn Fn(f64) -> ([f64; 2], [f64; 2])| {
            let rate = |t: f64| {
                let ([across, along], [d_across, d_along]) = strain(t);
                let third = (2.0 * across + along) / 3.0;
                if third == 0.0 {
                    return [0.0; 2];
                }
                let c = of((across - along) / (6.0 * third), ratio).stiffness();
                let unit = 3.0 / PI * third.sqrt();
                [
                    unit * ((c.c11 + c.c12) * d_across + c.c13 * d_along),
                    unit * (2.0 * c.c13 * d_across + c.c33 * d_along),
                ]
            };
            // Simpson's rule.
            let h = 1.0 / STEPS as f64;
            let mut sum = [0.0; 2];
            for i in 0..STEPS {
                let t = i as f64 * h;
                for (at, weight) in [(t, 1.0), (t + 0.5 * h, 4.0), (t + h, 1.0)] {
                    for (sum, rate) in sum.iter_mut().zip(rate(at)) {
                        *sum += weight * h / 6.0 * rate;
                    }
                }
            }
            sum
        };
        let near = |found: [f64; 2], history| {
            for (found, closed) in found.into_iter().zip(of(g, ratio).stress(history)) {
                let closed = 2.0 / PI * closed;
                assert!((found - closed).abs() < 1e-9, "{history:?} g {g}: {found} {closed}");
            }
        };
        // From zero the strain grows as t²: its rates are then smooth.
        let proportional = integrate(&|t| (ends.map(|e| t * t * e), ends.map(|e| 2.0 * t * e)));
        near(proportional, ContactHistory::Proportional);
        let first = integrate(&|t| ([t * t * ends[0]; 2], [2.0 * t * ends[0]; 2]));
        let second = integrate(&|t| ([ends[0], ends[0] + t * (ends[1] - ends[0])], [0.0, ends[1] - ends[0]]));
        near([first[0] + second[0], first[1] + second[1]], ContactHistory::HydrostaticFirst);
    }
}

/// K = [k²φ²G²p/(18π²(1−ν)²)]^⅓ and G/K = (3/5)(5−4ν)/(2−ν), and (3/5) without tangential stiffness.
#[test]
fn under_equal_strain_the_moduli_are_those_of_hertz_mindlin_and_walton() {
    let (k, phi, p) = (5.3, 0.62, 70.0e3);
    for nu in [0.0, 0.2, 0.35, 0.5] {
        let m = Material { poisson_ratio: nu, ..Material::GLASS };
        let bulk = (k * k * phi * phi * m.shear_modulus.powi(2) * p
            / (18.0 * PI * PI * (1.0 - nu) * (1.0 - nu)))
            .cbrt();
        for (ratio, over_bulk) in
            [(2.0 * (1.0 - nu) / (2.0 - nu), 0.6 * (5.0 - 4.0 * nu) / (2.0 - nu)), (0.0, 0.6)]
        {
            let shape = of(0.0, ratio);
            let unit = shape.unit(k, phi, &m, p);
            let t = shape.stiffness();
            let moduli = Moduli::of_medium(&t);
            let found = |modulus| unit * moduli.get(modulus).unwrap();
            let shear = over_bulk * bulk;
            for (modulus, expected) in [
                (Modulus::Theta, bulk),
                (Modulus::G12, shear),
                (Modulus::G13, shear),
                (Modulus::C11, bulk + 4.0 / 3.0 * shear),
                (Modulus::C33, bulk + 4.0 / 3.0 * shear),
                (Modulus::C13, bulk - 2.0 / 3.0 * shear),
            ] {
                assert!((found(modulus) - expected).abs() < 1e-13 * bulk, "nu {nu}: {modulus}");
            }
            assert!((shape.coordination(unit, phi, &m, p) / k - 1.0).abs() < 1e-14);
            assert!(HISTORIES.iter().all(|h| shape.stress_ratio(*h).abs() < 1e-15));
            assert!(shape.eps_stiffness().abs() < 1e-15);
        }
    }
}

/// Strain along e3 alone, Walton's other case: σ11/σ33 = C/(4(3B+C)); C11, C12, C13 and C33 as 3(α+2β), α−2β, 2(α−2β) and
/// 8(α+β), where α/β = (2B+C)/B, B ∝ 2 − 2ν and C ∝ 2ν.
#[test]
fn under_strain_along_the_axis_alone_stress_and_moduli_are_those_of_walton() {
    for nu in [0.0, 0.2, 0.35, 0.5] {
        let (b, c) = (2.0 - 2.0 * nu, 2.0 * nu);
        let shape = of(-0.5, b / (2.0 - nu));
        for history in HISTORIES {
            let [across, along] = shape.stress(history);
            let expected = if history == ContactHistory::Slip { 0.25 } else { c / (4.0 * (3.0 * b + c)) };
            assert!((across / along - expected).abs() < 1e-14, "{history:?} nu {nu}");
        }
        let (alpha, beta) = (1.0 / b, 1.0 / (2.0 * b + c));
        let t = shape.stiffness();
        let c12 = alpha - 2.0 * beta;
        let walton = [3.0 * (alpha + 2.0 * beta), c12, 2.0 * c12, 8.0 * (alpha + beta)];
        for (found, expected) in [t.c11, t.c12, t.c13, t.c33].into_iter().zip(walton) {
            assert!((found / t.c33 - expected / walton[3]).abs() < 1e-14, "nu {nu}: {t:?}");
        }
    }
}

/// Central forces leave the stiffness unchanged under every exchange of its indices (Cauchy).
#[test]
fn without_tangential_stiffness_shear_moduli_equal_the_off_diagonal_ones() {
    for (g, _) in grid() {
        let t = of(g, 0.0).stiffness();
        assert!((t.g13 - t.c13).abs() < 1e-15 && (t.g12 - t.c12).abs() < 1e-15, "g {g}: {t:?}");
    }
}
