//! Cells sheared past one half: the same lattice written with other cell vectors.
//!
//! H and H U with an integer U of determinant 1 span the same lattice, so that every answer must be the same.

use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::EngineError;
use grainlab_testkit::Random;
use grainlab_testkit::engine::*;

/// The packing with its cell vectors recombined by `u`, without history.
fn recombined(p: &Packing, u: &Mat3) -> Engine {
    let cell = Cell::new(p.cell.matrix() * u).unwrap();
    let mut s = setting(0.3, 2e-8);
    s.damping = 0.1;
    Engine::new(cell, GLASS, p.radii.clone(), &p.positions, s).unwrap()
}

fn shear(xy: f64, xz: f64, yz: f64) -> Mat3 {
    Mat3::new(1.0, xy, xz, 0.0, 1.0, yz, 0.0, 0.0, 1.0)
}

/// Expected: the same contacts, stress and motion, however far the cell vectors lean.
#[test]
fn a_cell_sheared_past_one_half_answers_as_the_upright_cell_of_the_same_lattice() {
    let p = Sample::Pressed.packing();
    let run = |u: &Mat3| {
        let mut e = recombined(&p, u);
        e.initialise().unwrap();
        e.set_rate(&[-20.0, 10.0, 5.0, 15.0, -25.0, 30.0]).unwrap();
        (0..300).for_each(|_| {
            e.step().unwrap();
        });
        let q = packing(&e);
        assert_eq!(found(&q), brute_force(&q));
        (e.observables().unwrap(), q)
    };
    let (upright, q) = run(&Mat3::identity());
    for (xy, xz, yz) in [(1.0, 0.0, 0.0), (0.0, -2.0, 1.0), (3.0, 2.0, -3.0), (8.0, -3.0, 2.0)] {
        let (s, leaning) = run(&shear(xy, xz, yz));
        assert_eq!(s.contacts, upright.contacts, "{xy} {xz} {yz}");
        let difference = (s.stress.tensor.matrix() - upright.stress.tensor.matrix()).norm();
        assert!(difference < 1e-7 * upright.stress.tensor.mean(), "{xy} {xz} {yz}: {difference}");
        for (a, b) in leaning.positions.iter().zip(&q.positions) {
            assert!((a - b).norm() < 1e-9 * RADIUS);
        }
    }
}

/// Expected: a lean of more than a hundred cell vectors needs image numbers that a contact cannot hold; refused.
#[test]
fn a_cell_that_leans_by_more_than_a_hundred_vectors_is_refused() {
    let p = Sample::Pressed.packing();
    let refused = recombined(&p, &shear(150.0, 0.0, 0.0)).initialise();
    assert!(matches!(refused, Err(EngineError::Image { .. })), "{refused:?}");
}

/// Expected: shear through one half and far beyond, up to where grains meet their own images; every contact is found
/// on the way.
#[test]
fn shearing_through_one_half_and_on_keeps_finding_every_contact() {
    let edge = 10.0 * RADIUS;
    let mut random = Random::new(5);
    let x: Vec<Vec3> = (0..40).map(|_| random.vector(0.5 * edge)).collect();
    // Grains that pass through each other: only distances matter here.
    let mut e = engine(Cell::cube(edge).unwrap(), HEAVY, &[RADIUS; 40], &x, setting(0.0, 1e-3));
    e.set_rate(&[0.0, 0.0, 0.0, 0.0, 0.0, 5.0]).unwrap();
    let mut met_itself = false;
    for step in 0..400 {
        e.step().unwrap();
        if step % 5 == 0 {
            let p = packing(&e);
            assert_eq!(found(&p), brute_force(&p), "at a shear of {}", 5e-3 * f64::from(step));
            met_itself |= p.contacts.iter().any(|c| c.i == c.j);
        }
    }
    let m = *packing(&e).cell.matrix();
    assert!(m[(0, 1)] / m[(1, 1)] > 0.9, "the cell leans by {}", m[(0, 1)] / m[(1, 1)]);
    assert!(met_itself, "the narrow way across is below a diameter by then");
}
