//! A drag on motion holds stress that the packing does not bear.

use crate::support::*;
use dem::{Engine, Simulation};
use grains::ServoLaw;
use scene::Scene;

const TARGET: f64 = 9.5e4;

/// Pressure while a strong drag is on and the servo has just reached its target, whether or not forces balance, and
/// the pressure that is left at rest; Pa.
fn pressures(unbalanced: f64) -> (f64, f64) {
    let text = format!(
        r#"
name = "dragged"
seed = 3
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
drag = 4e5
spin_drag = 4e5
rate_limit = 1000.0
response_time = 3e-6
control = {{ xx = {{ stress = {TARGET} }}, yy = {{ stress = {TARGET} }}, zz = {{ stress = {TARGET} }} }}
until = {{ on_target = 0.05, unbalanced = {unbalanced}, timeout = 0.1 }}
"#
    );
    let mut run = Simulation::new(Scene::parse(&text).unwrap()).unwrap();
    while let Some(r) = run.request() {
        let law = ServoLaw::Scaled { response_time: 3e-6 };
        let limit = if r.phase == 0 { 100.0 } else { 1000.0 };
        let answer = servo(run.engine(), r.controls, law, limit, 10);
        run.answer(&answer.rate).unwrap();
    }
    let p = run.packing();
    let moving = grains::stress::stress(&p).tensor.mean();
    let mut s = setting(0.1, p.time_step);
    (s.damping, s.drag, s.spin_drag) = (0.3, 2e4, 2e4);
    let mut e = Engine::from_packing(&p, s);
    e.prepare().unwrap();
    steps(&mut e, 100_000);
    (moving, e.snapshot().unwrap().stress.tensor.mean())
}

/// Expected: a target met while grains are dragged through each other is lost at rest; one met in balance is kept. The
/// unbalanced force tells them apart.
#[test]
fn a_stress_met_in_balance_is_kept_at_rest_and_one_propped_up_by_drag_is_not() {
    let (moving, left) = pressures(1e3);
    assert!((moving / TARGET - 1.0).abs() < 0.06 && left < 0.5 * moving, "{moving} to {left}");
    let (moving, left) = pressures(1e-4);
    assert!((left / moving - 1.0).abs() < 0.01, "{moving} to {left}");
}
