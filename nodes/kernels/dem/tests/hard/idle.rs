//! Millions of steps of a packing at rest.

use grainlab_core::Packing;
use grainlab_core::contact::TangentialLaw;
use grainlab_dem::Engine;
use grainlab_testkit::engine::*;
use grainlab_testkit::nightly;

/// A packing at the bottom: what is left of its preparation would else be taken for drift.
fn at_rest(tangential: TangentialLaw) -> Engine {
    let p = Sample::Few.packing();
    let mut s = setting(0.3, p.time_step);
    (s.tangential, s.damping, s.drag, s.spin_drag) = (tangential, 0.3, 2e4, 2e4);
    let mut e = taken_up(&p, s);
    steps(&mut e, 100_000);
    e
}

/// Largest displacement over a diameter, and the changes of stress and energy over what they are.
fn drift(start: &Packing, end: &Packing) -> (f64, f64, f64) {
    let moved = |i: usize| (end.positions[i] - start.positions[i]).norm() / (2.0 * RADIUS);
    let stress = |p: &Packing| grainlab_core::stress::stress(p).tensor.matrix();
    (
        (0..start.grains()).map(moved).fold(0.0, f64::max),
        (stress(end) - stress(start)).norm() / stress(start).norm(),
        (energy(end) / energy(start) - 1.0).abs(),
    )
}

/// Expected: with damping, as in every phase that brings grains to rest, nothing happens at all: no position, stress or
/// energy changes by more than 1e-12 of itself, no contact comes or goes.
#[test]
fn a_damped_packing_at_rest_stays_where_it_is_however_long() {
    let mut e = at_rest(TangentialLaw::Rescaled);
    let start = packing(&e);
    steps(&mut e, nightly(500_000, 10_000_000));
    let end = packing(&e);
    let (moved, stress, energies) = drift(&start, &end);
    assert!(moved < 1e-12 && stress < 1e-12 && energies < 1e-12, "{moved:e} {stress:e} {energies:e}");
    assert_eq!(found(&start), found(&end));
    assert!(end.velocities.iter().all(|v| v.norm() < 1e-12) && end.spins.iter().all(|w| w.norm() < 1e-8));
}

/// Expected: without any damping rounding sets grains trembling by less than 1e-12 of a diameter. The incremental law
/// takes no notice. The rescaled one gives up tangential force each time an overlap falls and regains none as it
/// rises: a millionth of the stress at most in a million steps, downhill.
#[test]
fn an_undamped_packing_at_rest_trembles_at_the_last_bit_and_does_not_heat() {
    for (tangential, bound) in [(TangentialLaw::Incremental, 1e-8), (TangentialLaw::Rescaled, 5e-6)] {
        let mut e = at_rest(tangential);
        let mut s = *e.settings();
        (s.damping, s.drag, s.spin_drag) = (0.0, 0.0, 0.0);
        e.set_settings(s).unwrap();
        let start = packing(&e);
        steps(&mut e, nightly(200_000, 1_000_000));
        let end = packing(&e);
        let (moved, stress, energies) = drift(&start, &end);
        assert!(moved < 1e-9 && stress < bound && energies < bound, "{moved:e} {stress:e} {energies:e}");
        assert_eq!(found(&start), found(&end));
        assert!(e.speed() < 1e-8, "{}", e.speed());
        if tangential == TangentialLaw::Rescaled {
            assert!(energy(&end) < energy(&start), "downhill");
        }
    }
}
