//! A packing near isostaticity.

use grainlab_core::{ServoLaw, non_rattlers};
use grainlab_engine::TimeStep;
use grainlab_testkit::engine::*;

/// Expected: under p → 0 a frictionless packing keeps just the contacts that balance needs, 3 (N − 1) forces and 6
/// stresses, and the servo still settles it.
#[test]
fn a_frictionless_packing_at_ten_pascal_has_just_the_contacts_that_balance_needs() {
    let pressed = Sample::Frictionless.packing();
    let mut s = setting(0.0, 0.0);
    s.time_step = TimeStep::FractionOfStable(0.8);
    (s.damping, s.drag) = (0.3, 2e3);
    let mut e = taken_up(&pressed, s);
    let mut excess = Vec::new();
    for pressure in [1e5, 1e3, 10.0] {
        for period in 0..200_000 {
            let answer = servo(&e, isotropic(pressure), ServoLaw::Scaled { response_time: 3e-5 }, 10.0, 10);
            e.set_rate(&answer.rate).unwrap();
            steps(&mut e, 10);
            let seen = e.observables().unwrap();
            let error = isotropic_error(&seen.stress.tensor.voigt(), pressure);
            if error < 1e-3 && seen.unbalanced < 1e-3 {
                break;
            }
            assert!(period < 199_999, "at {pressure} Pa: off by {error}, unbalanced {}", seen.unbalanced);
        }
        let p = packing(&e);
        let bearing = non_rattlers(&p);
        let grains = bearing.iter().filter(|b| **b).count();
        let contacts = p.contacts.iter().filter(|c| bearing[c.i as usize] && bearing[c.j as usize]).count();
        excess.push(contacts as i64 - (3 * (grains as i64 - 1) + 6));
    }
    assert!(excess.iter().all(|x| *x >= 0), "fewer than balance needs: {excess:?}");
    assert!(excess[2] <= 3, "{excess:?}");
}

/// Largest error of a stress over the pressure asked for.
fn isotropic_error(stress: &[f64; 6], pressure: f64) -> f64 {
    (0..6).map(|k| (stress[k] - if k < 3 { pressure } else { 0.0 }).abs() / pressure).fold(0.0, f64::max)
}
