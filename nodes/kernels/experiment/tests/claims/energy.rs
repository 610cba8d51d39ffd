//! The energy balance of a scene.

use grainlab_engine::EnergyBalance;
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
[[phase]]
kind = "servo"
friction = 0.3
damping = 0.1
control = { xx = { stress = 2.5e5 }, yy = { stress = 2.5e5 }, zz = { stress = 2e5 }, yz = { rate = 0 }, xz = { rate = 0 }, xy = { rate = 2 } }
rate_limit = 100.0
control_period = 20
until = { elapsed = 1e-3 }
publish = true
"#;

/// Expected: in every phase, at the default time step, the balance closes to 1e-9 of its largest term, and without the error
/// of integration it does not close to 1e-6.
#[test]
fn the_balance_of_a_scene_closes_in_every_phase() {
    let linear = "law = 'linear'\nnormal_stiffness = 2e5\nstiffness_ratio = 0.4\n";
    let rolling = "rolling_stiffness = 5e4\nrolling_damping = 5e-3\nrolling_friction = 0.1";
    for law in ["", &format!("{linear}{rolling}")] {
        let scene = Scene::parse(&SCENE.replace("LAW", law)).unwrap();
        let (name, phases, contact_law) = (scene.law.to_string(), scene.phases.len(), scene.law);
        let mut run = Simulation::new(scene).unwrap();
        let (mut ended, mut slid, mut rolled) = (0, 0.0f64, 0.0f64);
        while let Some(outcome) = run.exchange().unwrap() {
            let balance = outcome.energy.unwrap();
            let residual = balance.relative_residual().abs();
            assert!(residual < 1e-9, "{name}, phase {ended}, {residual:e}: {balance:?}");
            slid = slid.max(balance.sliding);
            rolled = rolled.max(balance.rolling.min(balance.rolling_damping).min(balance.rolling_springs));
            if outcome.ended.is_some() {
                let lacking = EnergyBalance { integration: 0.0, ..balance };
                assert!(lacking.relative_residual().abs() > 1e-6, "{name}, phase {ended}: {balance:?}");
                ended += 1;
            }
        }
        assert_eq!(ended, phases);
        assert!(slid > 0.0, "{name}");
        assert_eq!(rolled > 0.0, contact_law.rolling.is_some(), "{name}");
        assert_eq!(run.packing().unwrap().law, contact_law);
    }
}
