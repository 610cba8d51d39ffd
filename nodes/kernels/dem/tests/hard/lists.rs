//! Neighbour lists never miss a contact: after every step against brute force over all images.

use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::EngineSettings;
use grainlab_testkit::Random;
use grainlab_testkit::engine::*;

/// Grains at random that pass through each other, so that lists alone decide: `count` of radii from `smallest` to 1.
fn ghosts(cell: Cell, count: usize, smallest: f64, seed: u64, s: EngineSettings) -> Engine {
    let mut random = Random::new(seed);
    let radii: Vec<f64> = (0..count).map(|_| RADIUS * random.between(smallest, 1.0)).collect();
    // Unwrapped positions, up to three cells away.
    let x: Vec<Vec3> = (0..count).map(|_| cell.matrix() * random.vector(3.0)).collect();
    engine(cell, HEAVY, &radii, &x, s)
}

fn check(e: &Engine, place: &str) -> Packing {
    let p = packing(e);
    assert_eq!(found(&p), brute_force(&p), "{place}, step {}, cell {}", e.steps(), p.cell.matrix());
    p
}

fn shapes() -> Vec<(&'static str, Mat3)> {
    let edge = 2.0 * RADIUS;
    let of = |m: Mat3| m * edge;
    vec![
        ("cube", of(Mat3::identity() * 2.4)),
        ("small cube", of(Mat3::identity() * 1.01)),
        ("long and thin", of(Mat3::from_diagonal(&Vec3::new(1.02, 1.01, 12.0)))),
        ("flat", of(Mat3::from_diagonal(&Vec3::new(6.0, 1.05, 5.0)))),
        ("leaning", of(Mat3::new(2.0, 1.9, -1.7, 0.0, 2.0, 1.6, 0.0, 0.0, 2.0))),
        ("leaning far, turned", of(Mat3::new(2.0, 5.0, 0.3, 0.4, 3.0, -4.0, 0.1, 0.6, 2.5))),
    ]
}

/// Expected: every touching pair and image, in any cell, with any radii and wherever grains have travelled.
#[test]
fn every_contact_of_a_random_state_in_a_random_cell_is_found() {
    let mut random = Random::new(3);
    let mut contacts = 0;
    for seed in 0..300 {
        let shape = Mat3::from_diagonal(&Vec3::from_fn(|_, _| random.between(1.0, 9.0)))
            + Mat3::from_fn(|_, _| random.between(-1.5, 1.5));
        let Some(cell) = Cell::new(shape * 2.0 * RADIUS) else { continue };
        if (0..3).any(|k| cell.width(k) < 0.4 * RADIUS) {
            continue;
        }
        let mut s = setting(0.0, 1e-9);
        s.skin = RADIUS * random.between(0.01, 1.0);
        let e = ghosts(cell, 2 + seed as usize % 23, 0.2, seed, s);
        contacts += check(&e, &format!("seed {seed}")).contacts.len();
    }
    assert!(contacts > 500, "{contacts}");
}

/// Expected: no contact missed at any step while the cell is strained this way and that, by steps up to 1 %.
#[test]
fn no_contact_is_missed_under_strain() {
    for (name, shape) in shapes() {
        for (seed, rate) in [(1, 1.0), (2, 10.0)] {
            let mut random = Random::new(seed);
            let mut e = ghosts(Cell::new(shape).unwrap(), 28, 0.6, seed, setting(0.0, 1e-3));
            let mut last = 0;
            let mut changes = 0;
            for step in 0..600 {
                if step % 40 == 0 {
                    // There and back, so that the cell stays near its shape.
                    let turn = if step % 80 == 0 { 1.0 } else { -1.0 };
                    let r: [f64; 6] = if turn > 0.0 {
                        std::array::from_fn(|_| random.between(-rate, rate))
                    } else {
                        e.rate().map(|r| -r)
                    };
                    e.set_rate(&r).unwrap();
                }
                e.step().unwrap();
                let now = check(&e, name).contacts.len();
                changes += usize::from(now != last);
                last = now;
            }
            assert!(changes > 3, "{name}: contacts come and go, {changes}");
        }
    }
}

/// Expected: no contact missed in a gas whose grains cross a good part of the skin in every step, while it is pressed.
#[test]
fn no_contact_is_missed_in_a_fast_gas() {
    for (name, shape) in shapes() {
        let mut random = Random::new(9);
        let mut e = ghosts(Cell::new(shape).unwrap(), 14, 0.6, 4, setting(0.0, 1e-3));
        // Up to 0.05 R a step: half of what is refused as unstable, half of the skin.
        let velocities: Vec<Vec3> = (0..14).map(|_| random.vector(0.03 * RADIUS / 1e-3)).collect();
        e.set_velocities(&velocities).unwrap();
        e.set_rate(&[-0.3, 0.2, -0.1, 0.4, -0.2, 0.3]).unwrap();
        let mut changes = 0;
        let mut last = 0;
        for _ in 0..500 {
            e.step().unwrap();
            let now = check(&e, name).contacts.len();
            changes += usize::from(now != last);
            last = now;
        }
        assert!(changes > 30, "{name}: {changes}");
    }
}

/// Expected: strain steps of up to 20 %, far beyond the skin, are seen in the step that makes them.
#[test]
fn no_contact_is_missed_by_strain_steps_beyond_the_skin() {
    for (name, shape) in shapes() {
        let mut random = Random::new(6);
        let mut e = ghosts(Cell::new(shape).unwrap(), 14, 0.3, 8, setting(0.0, 1e-3));
        for _ in 0..40 {
            let r: [f64; 6] = std::array::from_fn(|_| random.between(-100.0, 100.0));
            for turn in [1.0, -1.0] {
                e.set_rate(&r.map(|r| r * turn)).unwrap();
                e.step().unwrap();
                check(&e, name);
            }
        }
    }
}

/// Expected: a pair just beyond the list that first parts, is strained together while apart, and then returns, touches
/// when it touches: the worst that travel and strain can do together, step by step at the edge of the criterion.
#[test]
fn no_contact_is_missed_where_travel_and_strain_conspire() {
    let (diameter, skin, dt) = (2.0 * RADIUS, 0.4 * RADIUS, 1e-6);
    for share in [0.2, 0.5, 0.8] {
        let mut s = setting(0.0, dt);
        s.skin = skin;
        let x = [Vec3::zeros(), Vec3::x() * (diameter + 1.0001 * skin)];
        let mut e = engine(Cell::cube(20.0 * RADIUS).unwrap(), HEAVY, &[RADIUS; 2], &x, s);
        let limit = skin / (diameter + skin);
        let apart = share * 0.5 * skin;
        let go = |e: &mut Engine, by: f64, strain: f64, count: usize| {
            e.set_rate(&[-strain / (dt * count as f64), 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
            let v = Vec3::x() * (by / (dt * count as f64));
            for _ in 0..count {
                e.set_velocities(&[-v, v]).unwrap();
                e.step().unwrap();
                check(e, "conspiring");
            }
        };
        go(&mut e, apart, 0.0, 20);
        go(&mut e, 0.0, (1.0 - share) * limit, 20);
        go(&mut e, -apart, 0.0, 20);
        go(&mut e, 0.0, 2.0 * share * limit, 400);
        assert_eq!(packing(&e).contacts.len(), 1, "they touch in the end");
    }
}
