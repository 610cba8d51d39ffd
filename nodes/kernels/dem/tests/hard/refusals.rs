//! What no law covers is refused with grains and numbers named, never answered with numbers that are not.

use crate::support::*;
use grainlab_core::{Cell, Vec3};
use grainlab_dem::{DemError, Engine};

/// Expected: two grains at one point overlap by a diameter, without a normal: the look at the stress refuses them by
/// their ids, and so does the first step.
#[test]
fn coincident_centres_are_refused() {
    for friction in [0.0, 0.3, f64::INFINITY] {
        for apart in [0.0, 1e-300, 1e-20] {
            let x = [Vec3::zeros(), Vec3::x() * (5.0 * RADIUS), Vec3::x() * (5.0 * RADIUS + apart)];
            let cell = Cell::cube(20.0 * RADIUS).unwrap();
            let mut e = engine(cell, GLASS, &[RADIUS; 3], &x, setting(friction, 1e-8));
            let seen = e.observables().unwrap_err();
            assert!(matches!(seen, DemError::Overlap { first: 1, second: 2, .. }), "{seen}");
            let refused = e.step().unwrap_err();
            let DemError::Unstable { grain, .. } = refused else { panic!("{refused}") };
            assert!(grain == 1 || grain == 2);
            assert!(refused.to_string().contains("unstable at step 0"), "{refused}");
        }
    }
}

/// Expected: up to a tenth of the smaller diameter Hertz's law is used, beyond it the look is refused.
#[test]
fn an_overlap_above_a_tenth_of_the_smaller_diameter_is_refused() {
    for small in [1.0, 0.2] {
        let look = |share: f64| {
            let x = [Vec3::zeros(), Vec3::z() * RADIUS * (1.0 + small - share * 2.0 * small)];
            let cell = Cell::cube(20.0 * RADIUS).unwrap();
            engine(cell, GLASS, &[RADIUS, small * RADIUS], &x, setting(0.3, 1e-9)).observables()
        };
        assert!(look(0.0999).is_ok());
        let refused = look(0.1001).unwrap_err();
        let DemError::Overlap { step: 0, first: 0, second: 1, overlap } = refused else {
            panic!("{refused}")
        };
        assert!((overlap / (0.1001 * 2.0 * small * RADIUS) - 1.0).abs() < 1e-9);
    }
}

/// Expected: a velocity that is not a number is caught by the step that would use it, and named.
#[test]
fn a_velocity_that_is_not_finite_is_refused_by_the_next_step() {
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let x = [Vec3::zeros(), Vec3::z() * (3.0 * RADIUS)];
        let mut e = engine(Cell::cube(20.0 * RADIUS).unwrap(), GLASS, &[RADIUS; 2], &x, setting(0.3, 1e-9));
        e.set_velocities(&[Vec3::zeros(), Vec3::y() * bad]);
        let refused = e.step().unwrap_err();
        assert!(matches!(refused, DemError::Unstable { grain: 1, .. }), "{refused}");
    }
}

/// Expected: a strain step that turns the cell inside out is refused.
#[test]
fn a_strain_step_that_turns_the_cell_inside_out_is_refused() {
    let refused = |rate: [f64; 6]| {
        let mut e = engine(
            Cell::cube(20.0 * RADIUS).unwrap(),
            GLASS,
            &[RADIUS],
            &[Vec3::zeros()],
            setting(0.0, 1e-6),
        );
        e.set_rate(&rate).unwrap();
        e.step().err()
    };
    for rate in [[-1e6; 6], [-1.5e6, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 2e6]] {
        assert!(matches!(refused(rate), Some(DemError::Cell { step: 1 })), "{rate:?}: {:?}", refused(rate));
    }
    // Two axes turned inside out at once leave a positive volume.
    let twice = refused([-1.5e6, -1.5e6, 0.0, 0.0, 0.0, 0.0]);
    assert!(matches!(twice, Some(DemError::Cell { step: 1 })), "{twice:?}");
}

/// Expected: a grain more than a hundred cells away is refused by its id, not given a wrong image.
#[test]
fn a_grain_more_than_a_hundred_cells_away_is_refused() {
    let cell = Cell::cube(4.0 * RADIUS).unwrap();
    let prepare = |far: f64| {
        let x = [Vec3::zeros(), Vec3::x() * (far * 4.0 * RADIUS)];
        Engine::new(cell, GLASS, vec![RADIUS; 2], &x, setting(0.0, 1e-9)).initialise()
    };
    assert_eq!(prepare(98.4), Ok(()));
    assert_eq!(prepare(-98.4), Ok(()));
    assert_eq!(prepare(101.0), Err(DemError::Image { grain: 1 }));
    assert_eq!(prepare(-101.0), Err(DemError::Image { grain: 1 }));
}
