//! The built-in scenes with their servo, with stress targets at the ends of its range.

use grainlab_core::ComponentControl;
use grainlab_core::stress::stress;
use grainlab_experiment::Simulation;
use grainlab_scene::{Condition, Measure, PhaseKind, Scene};
use grainlab_testkit::nightly;

const GRAINS: u32 = 200;

/// Simulated time within which a servoed phase settles, s: twenty times that of the slowest, so that a
/// failure ends early.
const TIMEOUT: f64 = 0.05;

/// Targets of the scenes, Pa.
#[derive(Clone, Copy, Debug)]
enum Targets {
    LowestAt(f64),
    HighestAt(f64),
}

/// Every stress that a phase controls or waits for.
fn stresses(scene: &mut Scene) -> Vec<&mut f64> {
    let mut found = Vec::new();
    for phase in &mut scene.phases {
        if let PhaseKind::Servo { controls, .. } = &mut phase.kind {
            found.extend(controls.iter_mut().filter_map(|c| match c {
                ComponentControl::Stress(target) => Some(target),
                _ => None,
            }));
        }
        found.extend(phase.until.all.iter_mut().filter_map(|c| match c {
            Condition::AtLeast(Measure::Stress(_), value) | Condition::AtMost(Measure::Stress(_), value) => {
                Some(value)
            }
            _ => None,
        }));
    }
    found
}

/// The scene of `text` with fewer grains and all its stresses scaled. Law, rate limits, drags, control
/// periods and tolerances are unchanged.
fn scaled(text: &str, targets: Targets) -> Scene {
    let mut scene = Scene::parse(text).unwrap();
    let mut stresses = stresses(&mut scene);
    let pressures = stresses.iter().map(|s| **s).filter(|s| *s > 0.0);
    let factor = match targets {
        Targets::LowestAt(pressure) => pressure / pressures.fold(f64::INFINITY, f64::min),
        Targets::HighestAt(pressure) => pressure / pressures.fold(0.0, f64::max),
    };
    stresses.iter_mut().for_each(|s| **s *= factor);
    scene.grains = GRAINS;
    let servoed = scene.phases.iter_mut().filter(|p| matches!(p.kind, PhaseKind::Servo { .. }));
    servoed.for_each(|p| p.until.timeout = p.until.timeout.min(TIMEOUT));
    scene
}

/// Runs `scene`. For each phase with six servoed components: its name, and the largest error of a component
/// over the target pressure, with the stress computed from the packing at its end.
fn errors(scene: Scene) -> Vec<(String, f64)> {
    let label = format!("{} ", scene.name);
    let mut run = Simulation::new(scene).unwrap();
    let mut errors = Vec::new();
    while let Some(r) = run.request() {
        let advanced = run.advance(&grainlab_servo::control(&r.input).unwrap().rate);
        let advanced = advanced.unwrap_or_else(|e| panic!("{label}{e}"));
        let targets = r.input.controls.map(|c| match c {
            ComponentControl::Stress(target) => target,
            _ => f64::NAN,
        });
        if let Some(name) = advanced.ended
            && targets.iter().all(|t| t.is_finite())
        {
            let found = stress(&run.packing().unwrap()).tensor.voigt();
            let worst = found.iter().zip(targets).map(|(s, t)| (s - t).abs()).fold(0.0, f64::max);
            errors.push((label.clone() + &name, worst / (targets[..3].iter().sum::<f64>() / 3.0)));
        }
    }
    errors
}

/// Expected: `phases` servoed phases, each within a thousandth of its pressure in all six components.
fn settles(text: &str, phases: usize) {
    for targets in [Targets::LowestAt(1e3), Targets::HighestAt(5e6)] {
        let errors = errors(scaled(text, targets));
        println!("{targets:?}: {errors:?}");
        assert_eq!(errors.len(), phases, "{errors:?}");
        assert!(errors.iter().all(|e| e.1 <= 1e-3), "{targets:?}: {errors:?}");
    }
}

#[test]
fn the_demo_settles_to_a_permille_in_all_components_from_1_kpa_and_up_to_5_mpa() {
    settles(include_str!("../../../../scenes/demo.toml"), 3);
}

/// The samples of the paper differ by their friction alone.
#[test]
fn the_paths_of_the_paper_settle_to_a_permille_in_all_components_from_1_kpa_and_up_to_5_mpa() {
    let all = [
        include_str!("../../../../scenes/s2.toml"),
        include_str!("../../../../scenes/uniaxial.toml"),
        include_str!("../../../../scenes/s1.toml"),
        include_str!("../../../../scenes/s3.toml"),
        include_str!("../../../../scenes/s4.toml"),
    ];
    all.into_iter().take(nightly(1, 5)).for_each(|text| settles(text, 9));
}

/// Expected: a scene cannot exceed the bound; the fault names the key.
#[test]
fn a_scene_that_asks_for_105_hundredths_of_the_bound_is_refused() {
    let text = "name = 'x'\n[grains]\ncount = 2\ndiameter = 2e-4\n[numerics]\ntime_step_safety = 1.05\n\
                [[phase]]\nkind = 'gas'\nrate = -1.0\nuntil = { elapsed = 1e-6 }\n";
    let faults = Scene::parse(text).unwrap_err().faults;
    assert!(faults.len() == 1 && faults[0].place.contains("time_step_safety"), "{faults:?}");
    assert!(Scene::parse(&text.replace("1.05", "0.95")).is_ok());
}
