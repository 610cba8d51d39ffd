//! Integration over the sphere and media of springs, independent of the code they test.

use grainlab_core::{Mat3, Vec3};
use nalgebra::Matrix6;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Directions and solid angles: 12 Gauss–Legendre points of the polar angle in panels that halve towards
/// poles and equator, where a root of the overlap can be nearly zero, times equal steps in azimuth, exact to
/// degree 5 there.
pub(crate) fn directions() -> Vec<(Vec3, f64)> {
    const HALVINGS: i32 = 8;
    const STEPS: usize = 6;
    let mut ends = vec![0.0];
    ends.extend((1..=HALVINGS).rev().map(|i| 0.5 * FRAC_PI_2 * 2f64.powi(1 - i)));
    let mirrored: Vec<f64> = ends[..HALVINGS as usize].iter().rev().map(|end| FRAC_PI_2 - end).collect();
    ends.extend(mirrored);
    let below: Vec<f64> = ends[..ends.len() - 1].iter().rev().map(|end| PI - end).collect();
    ends.extend(below);
    let mut out = Vec::new();
    for panel in ends.windows(2) {
        let (middle, half) = (0.5 * (panel[0] + panel[1]), 0.5 * (panel[1] - panel[0]));
        for (x, weight) in gauss_legendre() {
            let (sin, cos) = (middle + half * x).sin_cos();
            for step in 0..STEPS {
                let (s, c) = (TAU * step as f64 / STEPS as f64).sin_cos();
                out.push((Vec3::new(sin * c, sin * s, cos), weight * half * sin * TAU / STEPS as f64));
            }
        }
    }
    out
}

fn gauss_legendre() -> Vec<(f64, f64)> {
    const POINTS: usize = 12;
    let root = |level: usize| {
        let mut x = (PI * (level as f64 + 0.75) / (POINTS as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..50 {
            let (mut low, mut high) = (1.0, x);
            for n in 2..=POINTS {
                let n = n as f64;
                (low, high) = (high, ((2.0 * n - 1.0) * x * high - (n - 1.0) * low) / n);
            }
            slope = POINTS as f64 * (low - x * high) / (1.0 - x * x);
            x -= high / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..POINTS).map(root).collect()
}

/// Eq. 6 for one contact per grain.
pub(crate) fn contact_density(eps: f64, x: f64) -> f64 {
    (1.0 - eps + 3.0 * eps * x * x) / (4.0 * PI)
}

/// Stiffness of a medium whose contacts in direction d have springs k_n dd + k_t (1 − dd): `springs` gives their number
/// times k_n and times k_t. The relative displacement is (E + W)·d with the spin W that keeps the stress
/// Σ force d symmetric. Voigt, engineering shear strain.
pub(crate) fn stiffness(directions: &[(Vec3, f64)], springs: impl Fn(f64) -> [f64; 2]) -> Matrix6<f64> {
    let mut normal = [[Mat3::zeros(); 3]; 3];
    let mut tangential = Mat3::zeros();
    for (d, weight) in directions {
        let [k_n, k_t] = springs(d.z);
        let dd = d * d.transpose();
        tangential += dd * (weight * k_t);
        for (i, row) in normal.iter_mut().enumerate() {
            for (j, block) in row.iter_mut().enumerate() {
                *block += dd * (weight * (k_n - k_t) * d[i] * d[j]);
            }
        }
    }
    let stress = |gradient: &Mat3| {
        let normal = Mat3::from_fn(|i, j| normal[i][j].dot(gradient));
        normal + gradient * tangential
    };
    let torque = |s: &Mat3| Vec3::new(s[(2, 1)] - s[(1, 2)], s[(0, 2)] - s[(2, 0)], s[(1, 0)] - s[(0, 1)]);
    let spin = |v: Vec3| v.cross_matrix();
    let response = Mat3::from_columns(&[Vec3::x(), Vec3::y(), Vec3::z()].map(|v| torque(&stress(&spin(v)))));
    let response = response.lu();
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
    let mut c = Matrix6::zeros();
    for (column, (i, j)) in PAIRS.into_iter().enumerate() {
        let mut e = Mat3::zeros();
        e[(i, j)] += 0.5;
        e[(j, i)] += 0.5;
        let relative_spin = response.solve(&-torque(&stress(&e))).unwrap();
        let s = stress(&(e + spin(relative_spin)));
        assert!(torque(&s).amax() < 1e-12 * s.amax());
        PAIRS.into_iter().enumerate().for_each(|(row, at)| c[(row, column)] = s[at]);
    }
    c
}
