//! The factorisation against the iterations: one operator, two methods for C = A − ΞᵀK⁺Ξ/V.

use crate::samples::{Dice, packing, random};
use grainlab_core::results::ElasticStiffness;
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_micromechanics::network::{Solver, SpringNetwork, Springs, solve, solve_directly};
use grainlab_micromechanics::{MicroError, PackingView, Settings, analyze};

fn moduli(packing: &Packing, solver: Solver, tangential: bool) -> ElasticStiffness {
    let springs = if tangential { Springs::NormalAndTangential } else { Springs::Normal };
    let settings = Settings { solver, springs, tolerance: 1e-10, ..Settings::default() };
    analyze(packing, &settings).unwrap().report.stiffness().copied().unwrap()
}

/// Both stiffnesses exceed the exact one by the square of a residual of 1e-10 over the smallest stiffness.
/// Returns the iterations of each.
fn agree(packing: &Packing, tangential: bool) -> [u32; 2] {
    let [iterative, direct] =
        [Solver::Iterative, Solver::Direct].map(|solver| moduli(packing, solver, tangential));
    let error = (iterative.tensor.0 - direct.tensor.0).amax() / iterative.bounds.affine.0.amax();
    assert!(error < 1e-9, "{error:e}");
    assert!(direct.residual <= 1e-10);
    [iterative.iterations, direct.iterations]
}

/// Without the contacts selected by `lost`.
fn thinned(mut packing: Packing, mut lost: impl FnMut() -> bool) -> Packing {
    packing.contacts.retain(|_| !lost());
    packing.validated().unwrap()
}

#[test]
fn random_networks_with_and_without_tangential_springs_are_as_stiff_by_either_path() {
    for (swell, seed) in [(1.12, 1), (1.16, 2), (1.3, 3)] {
        let p = random(120, swell, seed);
        agree(&p, true);
        if swell > 1.2 {
            agree(&p, false);
        }
    }
}

/// Each contact fixes three of the six degrees of freedom of a grain with tangential springs, one of three
/// without: 4 and 6 contacts per grain are the least for a stable network.
#[test]
fn near_isostaticity_the_factorisation_takes_a_few_rounds_where_iterations_are_hundreds_of_times_as_many() {
    let mut dice = Dice(4);
    let p = random(300, 1.25, 4);
    let share = 4.6 / coordination(&p);
    let loose = thinned(p, || dice.next() > share);
    let frictionless = random(300, 1.25, 5);
    for (packing, tangential, isostatic) in [(loose, true, 4.0), (frictionless, false, 6.0)] {
        let z = coordination(&packing);
        assert!(z < isostatic + 0.7, "{z}");
        let [iterations, rounds] = agree(&packing, tangential);
        assert!(rounds <= 4 && iterations > 100 * rounds, "z {z}: {iterations} and {rounds}");
    }
}

fn coordination(packing: &Packing) -> f64 {
    2.0 * packing.contacts.len() as f64 / packing.grains() as f64
}

#[test]
fn grains_without_contacts_and_grains_that_hang_on_one_do_no_harm() {
    let mut dice = Dice(6);
    let p = random(200, 1.2, 6);
    // All contacts of some grains, and all but the first of others.
    let fates: Vec<f64> = (0..p.grains()).map(|_| dice.next()).collect();
    let mut kept = vec![false; p.grains()];
    let mut p = p;
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
    assert!(rattlers > 20, "{rattlers}");
    agree(&p, true);
}

/// Each grain touches itself through two faces, and the other through several.
#[test]
fn contacts_with_own_images_and_several_between_two_grains_are_in_the_matrix() {
    let d = 2.0e-4;
    let cell = Cell::new(Mat3::new(d, 0.1 * d, 0.0, 0.0, 0.98 * d, 0.2 * d, 0.0, 0.0, 1.5 * d)).unwrap();
    let positions = vec![Vec3::zeros(), Vec3::new(0.4, 0.6, 0.7) * d];
    let p = packing(cell, positions, 0.52 * d, 0.1, None);
    assert!(p.contacts.iter().any(|c| c.i == c.j));
    assert!(p.contacts.iter().filter(|c| c.i != c.j).count() > 1);
    agree(&p, true);
    agree(&p, false);
}

#[test]
fn the_same_packing_gives_the_same_bits_and_a_round_too_few_is_an_error() {
    let p = random(60, 1.15, 15);
    let bits = || moduli(&p, Solver::Direct, true).tensor.row_major().map(f64::to_bits);
    assert_eq!(bits(), bits());
    let settings =
        Settings { solver: Solver::Direct, tolerance: 1e-13, max_iterations: 0, ..Settings::default() };
    let refused = analyze(&p, &settings);
    assert!(matches!(refused, Err(MicroError::NotConverged { iterations: 0, .. })), "{refused:?}");
}

#[test]
fn another_number_of_loads_than_of_grains_is_refused_by_either_solver() {
    let p = random(30, 1.3, 1);
    let network = SpringNetwork::new(&PackingView::new(&p).unwrap(), Springs::Carried).unwrap();
    let refused = MicroError::Loads { grains: 30, loads: 29 };
    let loads = vec![[[0.0]; 6]; 29];
    assert_eq!(solve(&network, &loads, &[1.0], 1e-9, 10).unwrap_err(), refused);
    assert_eq!(solve_directly(&network, &loads, &[1.0], 1e-9, 10).unwrap_err(), refused);
}
