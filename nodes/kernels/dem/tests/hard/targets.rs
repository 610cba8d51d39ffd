//! Stress targets that reverse, vanish, or cannot be reached, through the servo as a laboratory runs it.

use grainlab_core::{ComponentControl, ServoLaw};
use grainlab_dem::Engine;
use grainlab_engine::{EngineError, TimeStep};
use grainlab_testkit::engine::*;

const PERIOD: u32 = 10;
const LIMIT: f64 = 30.0;
const PRESSURE: f64 = 1e5;
const SCALED: ServoLaw = ServoLaw::Scaled { response_time: 3e-6 };

fn start() -> Engine {
    let mut s = setting(0.3, 0.0);
    s.time_step = TimeStep::FractionOfStable(0.8);
    (s.damping, s.drag, s.spin_drag) = (0.3, 2e4, 2e4);
    taken_up(&Sample::Pressed.packing(), s)
}

/// Runs `periods` control periods; returns the last answer.
fn servoed(
    e: &mut Engine,
    controls: [ComponentControl; 6],
    law: ServoLaw,
    periods: usize,
) -> grainlab_servo::ServoOutput {
    let mut last = grainlab_servo::ServoOutput { rate: [0.0; 6], saturated: [false; 6] };
    for _ in 0..periods {
        last = servo(e, controls, law, LIMIT, PERIOD);
        e.set_rate(&last.rate).unwrap();
        steps(e, PERIOD as usize);
    }
    last
}

fn stress(e: &Engine) -> [f64; 6] {
    e.observables().unwrap().stress.tensor.voigt()
}

/// Eq. 1 with a leak, its gain a tenth of what one control period of the affine stiffness allows.
fn integral(e: &Engine) -> ServoLaw {
    let interval = e.time_step() * f64::from(PERIOD);
    ServoLaw::Integral { gain: 0.05 / (e.observables().unwrap().tangent[0] * interval), leak: 0.5 }
}

/// Expected: the shear stress follows its target from +5 to −5 kPa and back, all six components within 0.5 % of the
/// pressure.
#[test]
fn a_reversed_shear_stress_target_is_followed() {
    let mut e = start();
    for shear in [5e3, -5e3, 5e3] {
        let mut controls = isotropic(PRESSURE);
        controls[5] = ComponentControl::Stress(shear);
        servoed(&mut e, controls, SCALED, 10_000);
        let found = stress(&e);
        for (k, target) in [PRESSURE, PRESSURE, PRESSURE, 0.0, 0.0, shear].into_iter().enumerate() {
            assert!((found[k] - target).abs() < 5e-3 * PRESSURE, "{found:?} for {shear}");
        }
    }
}

/// Expected: grains without cohesion reach no tension. The packing opens at the rate limit with stress 0, and the moment
/// the target is one that can be reached the answer is the opposite limit: nothing was wound up.
#[test]
fn a_tension_cannot_be_reached_and_winds_nothing_up() {
    for law in [SCALED, integral(&start())] {
        let mut e = start();
        let open = servoed(&mut e, isotropic(-PRESSURE), law, 3000);
        assert_eq!((&open.rate[..3], &open.saturated[..3]), (&[LIMIT; 3][..], &[true; 3][..]));
        assert!(stress(&e)[..3].iter().all(|s| (0.0..1e-3 * PRESSURE).contains(s)), "{:?}", stress(&e));
        let opened = e.packing(grainlab_core::Mat3::identity()).cell.volume();
        let back = servoed(&mut e, isotropic(PRESSURE), law, 6);
        assert_eq!(&back.rate[..3], &[-LIMIT; 3], "{law:?}");
        assert!(packing(&e).cell.volume() < opened);
        let mut periods = 6;
        while stress(&e)[..3].iter().any(|s| (s / PRESSURE - 1.0).abs() > 0.01) {
            servoed(&mut e, isotropic(PRESSURE), law, 1);
            periods += 1;
            assert!(periods < 30_000, "{:?}", stress(&e));
        }
        servoed(&mut e, isotropic(PRESSURE), law, 10_000);
        assert!(stress(&e)[..3].iter().all(|s| (s / PRESSURE - 1.0).abs() < 5e-3), "{:?}", stress(&e));
    }
}

/// Expected: a target of zero unloads the packing smoothly until nothing presses, and leaves it there.
#[test]
fn a_target_of_zero_unloads_and_stays() {
    let mut e = start();
    let volume = packing(&e).cell.volume();
    servoed(&mut e, isotropic(0.0), SCALED, 10_000);
    let left = stress(&e);
    assert!(left.iter().all(|s| s.abs() < 1e-4 * PRESSURE), "{left:?}");
    let at_rest = packing(&e).cell.volume();
    assert!(at_rest > volume && at_rest < 1.02 * volume, "{}", at_rest / volume);
    servoed(&mut e, isotropic(0.0), SCALED, 10_000);
    let (now, seen) = (packing(&e), e.observables().unwrap());
    assert!((now.cell.volume() / at_rest - 1.0).abs() < 2e-3, "{}", now.cell.volume() / at_rest - 1.0);
    assert!(seen.stress.tensor.is_finite() && now.validated().is_ok());
}

/// Expected: a pressure no glass bears is pressed for at the rate limit, and ends with the grains that overlap too far.
#[test]
fn a_pressure_that_cannot_be_reached_ends_at_the_overlap_that_hertz_allows() {
    let mut e = start();
    let (controls, limit) = (isotropic(1e12), 10.0 * LIMIT);
    let refused = (0..100_000).find_map(|_| {
        let seen = e.observables().err();
        if seen.is_none() {
            let answer = servo(&e, controls, SCALED, limit, PERIOD);
            assert_eq!(&answer.rate[..3], &[-limit; 3]);
            e.set_rate(&answer.rate).unwrap();
            steps(&mut e, PERIOD as usize);
        }
        seen
    });
    let Some(EngineError::Overlap { overlap, .. }) = refused else { panic!("{refused:?}") };
    assert!(overlap > 0.2 * RADIUS && overlap < 0.21 * RADIUS, "{overlap}");
    assert!(packing(&e).validated().is_ok());
}
