//! The search finds every contact, in every cell.

use grainlab_core::contact_search::{SearchError, find};
use grainlab_core::{Cell, Contact, Mat3, Material, Vec3};
use grainlab_testkit::packings::{keys, touching};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn it_agrees_with_all_pairs(
        tilt in proptest::array::uniform6(-0.5f64..0.5),
        size in 0.6f64..6.0,
        grains in proptest::collection::vec((proptest::array::uniform3(-0.7f64..1.7), -2.5f64..-0.3), 1..25),
    ) {
        let [a, b, c, d, e, f] = tilt;
        let cell = Cell::new(Mat3::new(1.0, a, b, c, 1.0, d, e, f, 1.0) * size);
        prop_assume!(cell.is_some());
        let cell = cell.unwrap();
        prop_assume!((0..3).all(|k| cell.width(k) > 0.1));
        let x: Vec<Vec3> = grains.iter().map(|(f, _)| cell.matrix() * Vec3::from(*f)).collect();
        let r: Vec<f64> = grains.iter().map(|(_, r)| 10f64.powf(*r)).collect();
        let found = find(&cell, &x, &r, |r, d| Material::GLASS.normal_force(r, d)).unwrap();
        prop_assert_eq!(keys(&found), touching(&cell, &x, &r));
        for c in &found {
            let branch = x[c.j as usize] - x[c.i as usize] + cell.shift(c.image);
            prop_assert!((branch - c.normal * (r[c.i as usize] + r[c.j as usize] - c.overlap)).norm() < 1e-12);
        }
    }

    /// Cells up to a million times as long as wide, and narrower than a few diameters, in every direction and
    /// sheared.
    #[test]
    fn it_agrees_with_all_pairs_in_cells_of_any_shape(
        lengths in proptest::array::uniform3(-1.0f64..6.0),
        tilt in proptest::array::uniform3(-0.4f64..0.4),
        near in 0usize..3,
        grains in proptest::collection::vec((proptest::array::uniform3(0.0f64..1.0), 0.1f64..0.4), 1..25),
    ) {
        let mut edges = lengths.map(|e| 10f64.powf(e));
        // At least one edge has the size of a few grains, so that there are contacts.
        edges[near] = edges[near].min(3.0);
        let cell = Cell::new(Mat3::new(
            edges[0], tilt[0] * edges[0].min(edges[1]), tilt[1] * edges[0].min(edges[2]),
            0.0, edges[1], tilt[2] * edges[1].min(edges[2]),
            0.0, 0.0, edges[2],
        ));
        prop_assume!(cell.is_some());
        let cell = cell.unwrap();
        let narrowest = (0..3).map(|k| cell.width(k)).fold(f64::INFINITY, f64::min);
        prop_assume!(narrowest > 0.08);
        // All within a few diameters of each other, anywhere in the cell.
        let x: Vec<Vec3> = grains.iter().map(|(f, _)| Vec3::from(*f) * 2.0).collect();
        let r: Vec<f64> = grains.iter().map(|(_, r)| *r).collect();
        match find(&cell, &x, &r, |r, d| Material::GLASS.normal_force(r, d)) {
            Ok(found) => prop_assert_eq!(keys(&found), touching(&cell, &x, &r)),
            Err(e) => prop_assert!(matches!(e, SearchError::Crowded { .. }), "{}", e),
        }
    }
}

#[test]
fn one_grain_in_a_small_cell_touches_its_own_images() {
    let cell = Cell::cube(1.0).unwrap();
    let found = find(&cell, &[Vec3::zeros()], &[0.51], |r, d| Material::GLASS.normal_force(r, d)).unwrap();
    assert_eq!(keys(&found), [(0, 0, [0, 0, 1]), (0, 0, [0, 1, 0]), (0, 0, [1, 0, 0])]);
}

#[test]
fn time_grows_with_the_number_of_grains_not_its_square() {
    // A cubic lattice of 40³ = 64,000 touching spheres: 192,000 contacts. All pairs would be 2·10⁹ distances.
    let n = 40usize;
    let cell = Cell::cube(n as f64).unwrap();
    let place = |k: usize| Vec3::new((k % n) as f64, (k / n % n) as f64, (k / n / n) as f64);
    let x: Vec<Vec3> = (0..n * n * n).map(place).collect();
    let mut r = vec![0.500_001; x.len()];
    for (largest, contacts) in [(r[0], 3 * x.len()), (15.0, 207_508)] {
        r[0] = largest;
        let start = std::time::Instant::now();
        let found = find(&cell, &x, &r, |r, d| Material::GLASS.normal_force(r, d)).unwrap();
        assert_eq!(found.len(), contacts);
        assert!(start.elapsed().as_secs_f64() < 5.0, "{:?}", start.elapsed());
    }
}

#[test]
fn an_absurd_cell_costs_neither_memory_nor_time() {
    let x: Vec<Vec3> = (0..5).map(|k| Vec3::new(0.9 * k as f64, 0.0, 0.0)).collect();
    let r = [0.5; 5];
    for long in [1e3, 1e6, 1e9, 4294967296.0, 1e30, 1e100, 1e200] {
        for k in 0..3 {
            let mut edges = Vec3::repeat(6.0);
            edges[k] = long;
            let Some(cell) = Cell::new(Mat3::from_diagonal(&edges)) else { continue };
            let found = find(&cell, &x, &r, |r, d| Material::GLASS.normal_force(r, d)).unwrap();
            assert_eq!(found.len(), 4, "{edges:?}");
        }
    }
}

#[test]
fn what_cannot_be_a_contact_is_refused() {
    let cell = Cell::cube(1.0).unwrap();
    let find =
        |b: Vec3| find(&cell, &[Vec3::zeros(), b], &[0.1, 0.1], |r, d| Material::GLASS.normal_force(r, d));
    assert_eq!(find(Vec3::zeros()).unwrap_err(), SearchError::Coincident(0, 1));
    assert_eq!(find(Vec3::new(200.05, 0.0, 0.0)).unwrap_err(), SearchError::FarImage(0, 1));
    assert_eq!(find(Vec3::new(200.5, 0.0, 0.0)).unwrap(), []);
    assert_eq!(find(Vec3::new(100.05, 0.0, 0.0)).unwrap()[0].image, [-100, 0, 0]);
}

/// As one with the grains exchanged, each direction of a contact is reversed: normal, tangential and rolling force.
#[test]
fn a_contact_named_in_reverse_is_kept_in_order_with_its_directions_reversed() {
    let pressed = Contact::pressed([3, 5], [0, 1, 0], Vec3::z(), 1e-3, 2.0);
    let c = Contact { tangential_force: Vec3::x(), rolling_force: Vec3::y(), ..pressed };
    assert_eq!(c.named(3, 5, [0, 1, 0]), c);
    let back = c.named(5, 3, [0, -1, 0]);
    assert_eq!((back.i, back.j, back.image, back.overlap), (3, 5, [0, 1, 0], 1e-3));
    assert_eq!(
        (back.normal, back.tangential_force, back.rolling_force),
        (-Vec3::z(), -Vec3::x(), -Vec3::y())
    );
}
