//! A dense Cholesky factorisation against the iterations: one operator, two methods for C = A − ΞᵀK⁺Ξ/V.

use crate::samples::{network, random, solved};
use grainlab_core::Packing;
use grainlab_micromechanics::network::{GrainDofs, Springs, solve};
use grainlab_micromechanics::{MicroError, Settings, analyze};
use grainlab_testkit::Random;
use nalgebra::{DMatrix, Matrix6};

/// Fraction of the mean diagonal that is added to it: far above rounding, so that no pivot vanishes, and far below the stiffness of
/// almost every mode, so that one solve leaves this share of most of the residual.
const SHARE: f64 = 1e-11;

/// The stiffness of the network, Pa, with every force balanced to a relative residual of 1e-12.
pub(crate) fn factorised(packing: &Packing, springs: Springs) -> Matrix6<f64> {
    let network = network(packing, springs);
    let grains = packing.grains();
    let mut image = vec![[[0.0; 6]; 6]; grains];
    let mut matrix = DMatrix::zeros(6 * grains, 6 * grains);
    for grain in 0..grains {
        let mut unit = vec![[[0.0; 6]; 6]; grains];
        (0..6).for_each(|k| unit[grain][k][k] = 1.0);
        network.apply(&unit, &mut image);
        matrix.columns_mut(6 * grain, 6).copy_from(&stacked(&image));
    }
    let shift = SHARE * matrix.diagonal().mean();
    (0..6 * grains).for_each(|k| matrix[(k, k)] += shift);
    let factor = matrix.cholesky().unwrap();
    let (loads, norms) = network.affine_loads();
    let mut motion = vec![[[0.0; 6]; 6]; grains];
    for _ in 0..100 {
        network.apply(&motion, &mut image);
        let left = stacked(&loads) - stacked(&image);
        if left.column_iter().zip(norms).all(|(left, norm)| left.norm() <= 1e-12 * norm) {
            return network.stiffness_with(&motion).0;
        }
        let step = factor.solve(&left);
        for (grain, motion) in motion.iter_mut().enumerate() {
            (0..6).for_each(|k| (0..6).for_each(|l| motion[k][l] += step[(6 * grain + k, l)]));
        }
    }
    panic!("no balance of forces: a mode is as soft as the shift");
}

fn stacked(motions: &[GrainDofs<6>]) -> DMatrix<f64> {
    DMatrix::from_fn(6 * motions.len(), 6, |row, l| motions[row / 6][row % 6][l])
}

/// Returns the iterations of a solve that agrees with the factorisation.
fn agree(packing: &Packing, springs: Springs) -> u32 {
    let settings = Settings { springs, tolerance: Some(1e-10), ..Settings::default() };
    let found = solved(packing, &settings);
    let error = (found.tensor.0 - factorised(packing, springs)).amax() / found.bounds.affine.0.amax();
    // Above the exact one by the square of the residual over the smallest stiffness.
    assert!(error < 1e-9, "{error:e}");
    found.iterations
}

#[test]
fn grains_without_contacts_and_grains_that_hang_on_one_do_no_harm() {
    let mut dice = Random::new(6);
    let mut p = random(120, 1.2, 6);
    // All contacts of some grains, and all but the first of others.
    let fates: Vec<f64> = (0..p.grains()).map(|_| dice.unit()).collect();
    let mut kept = vec![false; p.grains()];
    p.contacts.retain(|c| {
        let ends = [c.i as usize, c.j as usize];
        if ends.iter().any(|g| fates[*g] < 0.1 || (fates[*g] < 0.2 && kept[*g])) {
            return false;
        }
        ends.iter().for_each(|g| kept[*g] = true);
        true
    });
    let p = p.validated().unwrap();
    let rattlers = analyze(&p, &Settings::default()).unwrap().report.contacts.rattlers;
    assert!(rattlers > 12, "{rattlers}");
    agree(&p, Springs::NormalAndTangential);
}

#[test]
fn another_number_of_loads_than_of_grains_is_refused() {
    let p = random(30, 1.3, 1);
    let network = network(&p, Springs::Carried);
    let loads = vec![[[0.0]; 6]; 29];
    let refused = solve(&network, &loads, &[1.0], 1e-9, 10).unwrap_err();
    assert_eq!(refused, MicroError::Loads { grains: 30, loads: 29 });
}
