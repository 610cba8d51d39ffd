//! The energy balance of a scene, under each contact law.

use grainlab_experiment::Simulation;
use grainlab_scene::Scene;

const SCENE: &str = r#"
name = "balance"
seed = 5
[grains]
count = 40
diameter = 2e-4
[contact]
LAW
[numerics]
time_step_safety = 0.05
energy_balance = true
[[phase]]
kind = "gas"
method = "soft"
rate = -60.0
control_period = 100
until = { solid_fraction = 0.55 }
[[phase]]
kind = "strain"
friction = 0.3
damping = 0.1
rate = [-100.0, -100.0, -120.0, 0.0, 3.0, 0.0]
until = { pressure_above = 2e5 }
publish = true
"#;

#[test]
fn a_scene_that_asks_for_it_has_a_balance_that_closes() {
    for law in ["law = 'hertz_mindlin'", "law = 'linear'\nnormal_stiffness = 2e5\nstiffness_ratio = 0.4"] {
        let scene = Scene::parse(&SCENE.replace("LAW", law)).unwrap();
        let name = scene.law.name();
        let mut run = Simulation::new(scene).unwrap();
        while let Some(r) = run.request() {
            run.advance(&grainlab_servo::control(&r.servo_input()).unwrap().rate).unwrap();
        }
        assert_eq!(run.packing().law.name(), name);
        let balance = run.engine().energy().unwrap();
        assert!(balance.sliding > 0.0, "{balance:?}");
        // The grains collide during the whole phase: the error of the steps is larger than at rest.
        assert!(balance.relative_residual().abs() < 1e-3, "{name}: {balance:?}");
    }
}
