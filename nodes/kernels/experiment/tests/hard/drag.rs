//! A drag on motion produces stress without contacts that sustain it.

use grainlab_core::ServoLaw;
use grainlab_dem::Engine;
use grainlab_engine::TimeStep;
use grainlab_experiment::Simulation;
use grainlab_scene::Scene;
use grainlab_servo::ServoInput;
use grainlab_testkit::engine::*;

const DRAG: f64 = 4e5;

/// The pressure of a state at rest in its cell, without drag, Pa.
fn left(e: &mut Engine) -> f64 {
    let mut s = *e.settings();
    (s.damping, s.drag, s.spin_drag) = (0.3, 0.0, 0.0);
    e.set_settings(s).unwrap();
    e.set_rate(&[0.0; 6]).unwrap();
    steps(e, 100_000);
    e.observables().unwrap().stress.tensor.mean()
}

/// Expected: grains compressed under drag far below the jamming density show a pressure; at rest it is zero.
/// The unbalanced force indicates this beforehand.
#[test]
fn a_pressure_due_to_drag_vanishes_at_rest_and_shows_in_the_unbalanced_force() {
    for seed in 1..4 {
        let mut s = setting(0.1, 0.0);
        (s.time_step, s.drag, s.spin_drag) = (TimeStep::FractionOfStable(0.8), DRAG, DRAG);
        let mut e = taken_up(&gas(&[RADIUS; 60], 0.0, seed), s);
        e.set_rate(&[-1000.0, -1000.0, -1000.0, 0.0, 0.0, 0.0]).unwrap();
        while e.observables().unwrap().solid_fraction < 0.52 {
            e.step().unwrap();
        }
        let moving = e.observables().unwrap();
        let pressure = moving.stress.tensor.mean();
        assert!(pressure > 1e3 && moving.unbalanced > 0.03, "{pressure} {}", moving.unbalanced);
        let kept = left(&mut e);
        assert!(kept < 0.01 * pressure, "seed {seed}: {pressure} to {kept}");
    }
}

/// Expected: under the same drag, a pressure reached with forces in balance is kept at rest to 1 %.
#[test]
fn a_pressure_met_in_balance_is_kept_at_rest() {
    let target = 9.5e4;
    let text = format!(
        r#"
name = "dragged"
seed = 5
[grains]
count = 60
diameter = 2e-4
[[phase]]
kind = "gas"
rate = -100.0
control_period = 100
until = {{ solid_fraction = 0.5 }}
[[phase]]
kind = "servo"
friction = 0.1
drag = {DRAG}
spin_drag = {DRAG}
rate_limit = 1000.0
response_time = 3e-6
control = {{ xx = {{ stress = {target} }}, yy = {{ stress = {target} }}, zz = {{ stress = {target} }} }}
until = {{ on_target = 0.05, unbalanced = 1e-4, timeout = 0.2 }}
"#
    );
    let mut run = Simulation::new(Scene::parse(&text).unwrap()).unwrap();
    while let Some(r) = run.request() {
        let law = ServoLaw::Scaled { response_time: 3e-6 };
        let rate_limit = if r.phase == 1 { 100.0 } else { 1000.0 };
        let input = ServoInput { law, rate_limit, ..r.input };
        run.advance(&grainlab_servo::control(&input).unwrap().rate).unwrap();
    }
    let p = run.packing().unwrap();
    let mut e = taken_up(&p, setting(0.1, p.time_step));
    let kept = left(&mut e);
    assert!((kept / target - 1.0).abs() < 0.06, "on target to 5 %: {kept}");
    let met = grainlab_core::stress::stress(&p).tensor.mean();
    assert!((kept / met - 1.0).abs() < 0.01, "{met} to {kept}");
}
