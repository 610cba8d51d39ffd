//! Stress control of a real packing: the default law from 1 kPa to 5 MPa, and Eq. 1 at its stability limit.

use grainlab_core::{ComponentControl, ServoLaw};
use grainlab_dem::Engine;
use grainlab_engine::{EngineSettings, TimeStep};
use std::sync::OnceLock;

/// Targets, Pa, one after the other.
const PRESSURES: [f64; 5] = [1e3, 10e3, 50e3, 500e3, 5e6];

const GAS: &str = r#"
name = "servo"
seed = 1
[grains]
count = 200
diameter = 2e-4
[[phase]]
kind = "gas"
rate = -40.0
until = { solid_fraction = 0.6 }
[[phase]]
kind = "relax"
friction = 0.0
drag = 1e4
control_period = 50
until = { speed = 1e-3 }
"#;

/// Isotropic compression to `pressure` (Pa) under the default law of the scene, with unchanged parameters, until rattlers rest, too: one
/// that hits a grain changes a stress of 1 kPa by 3 %.
fn servo_phase(pressure: f64) -> String {
    let normal = format!("{{ stress = {pressure:e} }}");
    format!(
        "[[phase]]\nkind = \"servo\"\nfriction = 0.1\ndrag = 1.5e3\npublish = true\n\
         control = {{ xx = {normal}, yy = {normal}, zz = {normal}, yz = {{ stress = 0 }}, xz = {{ stress = 0 }}, \
         xy = {{ stress = 0 }} }}\n\
         until = {{ on_target = 1e-3, unbalanced = 1e-5, hold = 2e-5, timeout = 0.05 }}\n"
    )
}

/// The packing at each of [`PRESSURES`], with the largest relative error of a component when it settled.
fn settled() -> &'static Vec<(Engine, f64)> {
    static SETTLED: OnceLock<Vec<(Engine, f64)>> = OnceLock::new();
    SETTLED.get_or_init(|| {
        let text = GAS.to_string() + &PRESSURES.map(servo_phase).concat();
        let mut run = crate::begin(&text);
        let mut out = Vec::new();
        while let Some(advanced) = run.exchange().unwrap() {
            if advanced.packing_due {
                let target = PRESSURES[out.len()];
                let stress = run.engine().observables().unwrap().stress.tensor.voigt();
                let error = |i: usize| (stress[i] - if i < 3 { target } else { 0.0 }).abs() / target;
                println!("{target:e} Pa at step {}: {stress:?}", run.engine().steps());
                let settings = *run.engine().settings();
                let mut engine = Engine::from_packing(&run.packing().unwrap(), settings).unwrap();
                engine.initialise().unwrap();
                out.push((engine, (0..6).map(error).fold(0.0, f64::max)));
            }
        }
        out
    })
}

#[test]
fn the_default_law_settles_to_a_permille_in_all_components_from_1_kpa_to_5_mpa() {
    let errors: Vec<f64> = settled().iter().map(|s| s.1).collect();
    assert_eq!(errors.len(), PRESSURES.len());
    assert!(errors.iter().all(|e| *e <= 1e-3), "{errors:?}");
}

/// Pressing a gas of these grains, without friction, to 100 kPa under the default law, with this line in the phase: the number of
/// exchanges, or why it failed.
fn pressed(sizes: &str, seed: u64, line: &str) -> Result<u32, String> {
    let text = format!(
        "name = \"pressed\"\nseed = {seed}\n[grains]\n{sizes}\n\
         [[phase]]\nkind = \"gas\"\nrate = -12.0\nuntil = {{ solid_fraction = 0.45 }}\n{}{line}\n",
        servo_phase(1e5)
            .replace("friction = 0.1\ndrag = 1.5e3", "friction = 0.0\ndrag = 1e3\nrate_limit = 20.0")
    );
    let mut run = crate::begin(&text);
    let mut exchanges = 0;
    while run.exchange().map_err(|e| e.to_string())?.is_some() {
        exchanges += 1;
    }
    Ok(exchanges)
}

/// Three grains that bear the whole load form a lattice: every strain is affine, so that none of its energy reaches the grains. Then
/// only the leak ends a swing of the stress, with rattlers between the grains or without.
#[test]
fn the_default_law_settles_a_few_large_grains_which_damp_no_swing_themselves() {
    let with_rattlers = "diameter = [{ diameter = 1e-3, count = 3 }, { diameter = 2e-4, count = 30 }]";
    for sizes in ["count = 3\ndiameter = 1e-3", "count = 4\ndiameter = 1e-3", with_rattlers] {
        for seed in 1..=3 {
            let settled = pressed(sizes, seed, "");
            println!("{sizes}, seed {seed}: {settled:?} exchanges");
            assert!(settled.is_ok(), "{sizes}, seed {seed}: {settled:?}");
            let swings = pressed(sizes, seed, "leak = 0.0").unwrap_err();
            assert!(swings.contains("off target") && swings.contains("leak of the phase, 0 now"), "{swings}");
        }
    }
}

/// Eq. 1 in a closed loop with a settled packing, with targets slightly (1e-4 of the pressure) off its
/// stress.
struct Loop {
    engine: Engine,
    controls: [ComponentControl; 6],
    targets: [f64; 6],
    period: u32,
    shade: f64,
}

impl Loop {
    fn around(packing: &Engine, servoed: [bool; 6], period: u32) -> Self {
        let mut engine = packing.clone();
        engine
            .set_settings(EngineSettings {
                time_step: TimeStep::Fixed(engine.time_step()),
                ..*packing.settings()
            })
            .unwrap();
        let stress = engine.observables().unwrap().stress.tensor;
        let shade = 1e-4 * stress.mean();
        // Both signs: volume and shape of the cell are off.
        let targets: [f64; 6] =
            std::array::from_fn(|i| stress.voigt()[i] + shade * [1.0, 0.5, 1.0, -0.5, 0.5, 1.0][i]);
        let controls = std::array::from_fn(|i| match servoed[i] {
            true => ComponentControl::Stress(targets[i]),
            false => ComponentControl::Held,
        });
        Self { engine, controls, targets, period, shade }
    }

    fn interval(&self) -> f64 {
        self.engine.time_step() * f64::from(self.period)
    }

    fn predicted(&self, leak: f64) -> f64 {
        let tangent = self.engine.observables().unwrap().tangent;
        grainlab_servo::critical_gain(&tangent, &self.controls, self.interval(), leak)
    }

    /// The largest error of a servoed component, in units of this offset, before each of `intervals` control
    /// intervals.
    fn errors(&mut self, gain: f64, leak: f64, rate_limit: f64, intervals: usize) -> Vec<f64> {
        let mut errors = Vec::new();
        for _ in 0..intervals {
            let stress = self.engine.observables().unwrap().stress.tensor;
            let off = |i: usize| match self.controls[i] {
                ComponentControl::Stress(_) => (stress.voigt()[i] - self.targets[i]).abs() / self.shade,
                _ => 0.0,
            };
            errors.push((0..6).map(off).fold(0.0, f64::max));
            // Far beyond an oscillation, and still far below the pressure: the network is the same.
            if errors[errors.len() - 1] > 100.0 && rate_limit.is_infinite() {
                break;
            }
            let request = grainlab_servo::ServoInput {
                stress,
                controls: self.controls,
                rate: self.engine.rate(),
                rate_limit: rate_limit.min(f64::MAX),
                law: ServoLaw::Integral { gain, leak },
                // Without it the law is not refused beyond its limit.
                tangent: None,
                control_interval: self.interval(),
            };
            self.engine.set_rate(&grainlab_servo::control(&request).unwrap().rate).unwrap();
            for _ in 0..self.period {
                self.engine.step().unwrap();
            }
        }
        errors
    }
}

/// The gain at which the error grows a hundredfold within 60 intervals, over the predicted one: by bisection between
/// a quarter and four times, to 4 %.
fn found_over_predicted(packing: &Engine, servoed: [bool; 6], period: u32, leak: f64) -> f64 {
    let predicted = Loop::around(packing, servoed, period).predicted(leak);
    let grows = |ratio: f64| {
        let mut l = Loop::around(packing, servoed, period);
        l.errors(ratio * predicted, leak, f64::INFINITY, 60).iter().any(|e| *e > 100.0)
    };
    let (mut stable, mut unstable) = (0.25f64, 4.0f64);
    assert!(!grows(stable) && grows(unstable), "the limit is not between {stable} and {unstable} times");
    for _ in 0..6 {
        let middle = (stable * unstable).sqrt();
        if grows(middle) { unstable = middle } else { stable = middle }
    }
    (stable * unstable).sqrt()
}

fn only(k: usize) -> [bool; 6] {
    std::array::from_fn(|i| i == k)
}

#[test]
fn eq_1_goes_unstable_at_the_gain_predicted_from_the_tangent_stiffness() {
    let mut wrong = Vec::new();
    for (packing, pressure) in settled().iter().map(|s| &s.0).zip(PRESSURES).step_by(2) {
        for (servoed, what) in [([true; 6], "all"), (only(2), "zz"), (only(5), "xy")] {
            for (period, leak) in [(1, 0.0), (5, 0.0), (20, 0.0), (20, 0.5), (20, 1.0)] {
                let ratio = found_over_predicted(packing, servoed, period, leak);
                let line = format!("{pressure:e} Pa, {what}, {period} steps, leak {leak}: {ratio:.2}");
                println!("{line}");
                if !(1.0 / 1.5..=1.5).contains(&ratio) {
                    wrong.push(line);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Three times the critical gain: rates alternate between the limits, the stress error stays of the order of
/// the strain of one interval at the limit, and vanishes after the gain is reduced.
#[test]
fn beyond_the_critical_gain_the_rate_limit_bounds_the_swings_and_nothing_winds_up() {
    let mut l = Loop::around(&settled()[2].0, [true; 6], 20);
    let critical = l.predicted(0.0);
    // K h = 4/g_c: one interval at this rate strains by 10 offsets of stress.
    let limit = 10.0 * l.shade * critical / 4.0;
    let swings = l.errors(3.0 * critical, 0.0, limit, 400);
    let late = swings[200..].iter().fold(0.0f64, |m, e| m.max(*e));
    assert!((2.5..20.0).contains(&late), "{late} shades");
    assert!(l.engine.rate().iter().all(|r| r.abs() <= limit));
    // The agitated grains need some hundred intervals to come to rest.
    let after = l.errors(0.3 * critical, 0.0, limit, 400);
    let left = after[350..].iter().fold(0.0f64, |m, e| m.max(*e));
    assert!(left < 0.5, "{left} shades left of {late}");
}
