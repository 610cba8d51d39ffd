//! Cases that no law covers are refused with grains and numbers named, never answered with numbers that are not.

use grainlab_core::contact::{ContactLaw, Linear, SpringLaw};
use grainlab_core::{Cell, Material, Packing, PackingError, Vec3};
use grainlab_dem::Engine;
use grainlab_engine::{EngineError, EngineSettings, TimeStep};
use grainlab_testkit::engine::*;

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
            assert!(matches!(seen, EngineError::Overlap { first: 1, second: 2, .. }), "{seen}");
            let refused = e.step().unwrap_err();
            let EngineError::Unstable { grain, .. } = refused else { panic!("{refused}") };
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
        let EngineError::Overlap { step: 0, first: 0, second: 1, overlap } = refused else {
            panic!("{refused}")
        };
        assert!((overlap / (0.1001 * 2.0 * small * RADIUS) - 1.0).abs() < 1e-9);
    }
}

/// Expected: a velocity or a spin that is not a number is refused with its grain, and the engine is as before.
#[test]
fn a_velocity_that_is_not_finite_is_refused() {
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let x = [Vec3::zeros(), Vec3::z() * (3.0 * RADIUS)];
        let mut e = engine(Cell::cube(20.0 * RADIUS).unwrap(), GLASS, &[RADIUS; 2], &x, setting(0.3, 1e-9));
        let motion = [Vec3::zeros(), Vec3::new(0.0, bad, 0.0)];
        for refused in [
            e.set_velocities(&motion),
            e.set_spins(&motion),
            e.add_velocities(motion.into_iter().enumerate()),
        ] {
            let named =
                |e: &EngineError| matches!(e, EngineError::Packing(PackingError::NotFinite { index: 1, .. }));
            assert!(refused.as_ref().is_err_and(named), "{refused:?}");
        }
        assert!(e.step().is_ok() && e.speed() == 0.0);
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
        assert!(
            matches!(refused(rate), Some(EngineError::Cell { step: 1 })),
            "{rate:?}: {:?}",
            refused(rate)
        );
    }
    // Two axes turned inside out at once leave a positive volume.
    let twice = refused([-1.5e6, -1.5e6, 0.0, 0.0, 0.0, 0.0]);
    assert!(matches!(twice, Some(EngineError::Cell { step: 1 })), "{twice:?}");
}

/// Expected: a grain more than a hundred cells away is refused by its id, not given a wrong image.
#[test]
fn a_grain_more_than_a_hundred_cells_away_is_refused() {
    let cell = Cell::cube(4.0 * RADIUS).unwrap();
    let prepare = |far: f64| {
        let x = [Vec3::zeros(), Vec3::x() * (far * 4.0 * RADIUS)];
        Engine::new(cell, GLASS, vec![RADIUS; 2], &x, setting(0.0, 1e-9)).unwrap().initialise()
    };
    assert_eq!(prepare(98.4), Ok(()));
    assert_eq!(prepare(-98.4), Ok(()));
    assert_eq!(prepare(101.0), Err(EngineError::Image { grain: 1 }));
    assert_eq!(prepare(-101.0), Err(EngineError::Image { grain: 1 }));
}

/// Expected: arrays of different lengths, numbers out of their range and no grains at all are refused by name.
#[test]
fn grains_that_are_none_are_refused() {
    let cell = Cell::cube(20.0 * RADIUS).unwrap();
    let x = [Vec3::zeros(), Vec3::z() * (3.0 * RADIUS)];
    let refused = |material, radii: &[f64], x: &[Vec3]| {
        Engine::new(cell, material, radii.to_vec(), x, setting(0.3, 1e-9)).unwrap_err().to_string()
    };
    for (radii, part) in [
        (&[RADIUS][..], "position has 2 entries, but there are 1 grains"),
        (&[RADIUS; 3], "position has 2 entries, but there are 3 grains"),
        (&[RADIUS, -RADIUS], "radius[1] = -1e-4"),
        (&[RADIUS, 0.0], "radius[1]"),
        (&[RADIUS, f64::NAN], "radius[1] is not finite"),
    ] {
        let refused = refused(GLASS, radii, &x);
        assert!(refused.contains(part), "{refused}");
    }
    assert!(refused(GLASS, &[RADIUS; 2], &[x[0], Vec3::y() * f64::INFINITY]).contains("position[1]"));
    assert!(refused(Material { density: -1.0, ..GLASS }, &[RADIUS; 2], &x).contains("density"));
    assert_eq!(refused(GLASS, &[], &[]), "there are no grains");
}

/// Expected: every setting out of its range is refused by its name, in the constructor and later, and nothing changes.
#[test]
fn settings_out_of_their_range_are_refused() {
    let cell = Cell::cube(20.0 * RADIUS).unwrap();
    let x = [Vec3::zeros(), Vec3::z() * (3.0 * RADIUS)];
    let sound = setting(0.3, 1e-9);
    let mut e = engine(cell, GLASS, &[RADIUS; 2], &x, sound);
    for bad in [-1.0, f64::NAN] {
        for (name, settings) in [
            ("friction", EngineSettings { friction: bad, ..sound }),
            ("damping", EngineSettings { damping: bad, ..sound }),
            ("drag", EngineSettings { drag: bad, ..sound }),
            ("spin_drag", EngineSettings { spin_drag: bad, ..sound }),
            ("skin", EngineSettings { skin: bad, ..sound }),
            ("thermostat_speed", EngineSettings { thermostat_speed: Some(bad), ..sound }),
            ("time_step", EngineSettings { time_step: TimeStep::Fixed(bad), ..sound }),
            ("time_step", EngineSettings { time_step: TimeStep::FractionOfStable(bad), ..sound }),
        ] {
            let new = Engine::new(cell, GLASS, vec![RADIUS; 2], &x, settings).map(|_| ());
            for refused in [new, e.set_settings(settings)] {
                // The friction of a new engine is that of its packing.
                let named = match refused {
                    Err(EngineError::Setting { name, .. }) => name,
                    Err(EngineError::Packing(PackingError::Range { field, .. })) => field,
                    other => panic!("{name}: {other:?}"),
                };
                assert_eq!(named, name);
            }
        }
        let rate = e.set_rate(&[0.0, bad.ln(), 0.0, 0.0, 0.0, 0.0]);
        assert!(matches!(rate, Err(EngineError::Rate { component: "yy", .. })), "{rate:?}");
    }
    assert_eq!(*e.settings(), sound);
    assert!(e.step().is_ok());
}

/// Expected: velocities and spins are one per grain.
#[test]
fn motions_of_another_number_of_grains_are_refused() {
    let cell = Cell::cube(20.0 * RADIUS).unwrap();
    let x = [Vec3::zeros(), Vec3::z() * (3.0 * RADIUS)];
    let mut e = engine(cell, GLASS, &[RADIUS; 2], &x, setting(0.3, 1e-9));
    for motion in [&[Vec3::x()][..], &[Vec3::x(); 3]] {
        let wrong = |r: Result<(), EngineError>| matches!(r, Err(EngineError::Packing(PackingError::Length { expected: 2, found, .. })) if found == motion.len());
        assert!(wrong(e.set_velocities(motion)) && wrong(e.set_spins(motion)));
    }
    assert!(e.add_velocities([(2, Vec3::x())]).is_err());
    assert_eq!(e.speed(), 0.0);
}

/// Expected: a law out of its range is refused.
#[test]
fn a_contact_law_out_of_its_range_is_refused() {
    let of = |normal_stiffness| {
        let law = ContactLaw::of(SpringLaw::Linear(Linear { normal_stiffness, stiffness_ratio: 0.5 }));
        Engine::from_packing(&Packing { law, ..gas(&[RADIUS; 2], 0.0, 1) }, setting(0.3, 1e-9))
    };
    for bad in [0.0, -1.0, f64::NAN] {
        assert!(matches!(of(bad), Err(EngineError::Law(_))), "{bad}");
    }
    assert!(of(1e4).is_ok());
}
