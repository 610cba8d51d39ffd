//! The knobs: settings of a scene that are varied, their values, and their most accurate value.

use clap::ValueEnum;
use grainlab_core::{ComponentControl, ServoLaw};
use grainlab_scene::{GasMethod, Phase, PhaseKind, Scene};
use serde::Serialize;
use std::fmt;

/// A knob. Every value is a factor on that of the scene, so that the unchanged scene is the default of every
/// knob.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[value(rename_all = "snake_case")]
#[serde(rename_all = "snake_case")]
pub(crate) enum Knob {
    /// Fraction of the stability bound that the time step takes.
    TimeStep,
    /// Control law of the servo phases.
    ServoLaw,
    /// Solver steps between two exchanges with the servo, in every phase but the gas.
    ControlPeriod,
    /// Every strain rate and rate limit after the gas; the inertial number is proportional to it.
    StrainRate,
    /// Strain rate of the gas: determines its temperature during compression.
    GasRate,
    /// Method of the gas: hard spheres event by event, or soft ones step by step.
    GasStage,
    /// Contact damping after the gas, share of critical.
    Damping,
    /// Verlet skin over grain diameter.
    Skin,
    /// Number of grains.
    Grains,
}

/// The value of a knob.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(crate) enum Value {
    /// In the unit of the knob.
    Number(f64),
    /// The name of a law.
    Text(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // A factor leaves digits that are not significant.
            Self::Number(v) => write!(f, "{}", (v * 1e4).round() / 1e4),
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// One value of one knob, with the rest of the scene unchanged.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    pub(crate) knob: Knob,
    pub(crate) value: Value,
    /// The unchanged scene.
    pub(crate) default: bool,
    pub(crate) scene: Scene,
}

/// The state of the servo at the end of a run, from which the gain of Eq. 1 is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Servoed {
    /// Tangent stiffness of a normal component, Pa.
    pub(crate) tangent: f64,
    /// Simulated time between two exchanges, s.
    pub(crate) interval: f64,
}

impl Knob {
    /// Its name on the command line and in output.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map(|v| v.get_name().to_owned()).unwrap_or_default()
    }

    /// Factors on the value of the scene, and the most accurate one; 0 is the smallest possible value.
    fn factors(self, quick: bool) -> (&'static [f64], f64) {
        match (self, quick) {
            (Self::TimeStep, false) => (&[0.5, 0.75, 1.0, 1.25], 0.5),
            (Self::TimeStep, true) => (&[1.0, 1.25], 0.75),
            (Self::ControlPeriod, false) => (&[0.0, 0.25, 1.0, 4.0], 0.0),
            (Self::ControlPeriod, true) => (&[1.0, 4.0], 0.0),
            (Self::StrainRate, false) => (&[0.25, 0.5, 1.0, 2.0, 4.0], 0.25),
            (Self::StrainRate, true) => (&[1.0, 2.0], 0.5),
            // A slow gas cools down, so that its limit is not meaningful: no value is more accurate than that
            // of the scene.
            (Self::GasRate, false) => (&[0.5, 1.0, 2.0, 4.0], 1.0),
            (Self::GasRate, true) => (&[1.0, 2.0], 1.0),
            // Slow straining makes the end independent of damping; no value of damping is more accurate by
            // itself.
            (Self::Damping, false) => (&[0.33, 1.0, 2.0], 1.0),
            (Self::Damping, true) => (&[1.0, 2.0], 1.0),
            (Self::Skin, false) => (&[0.4, 1.0, 2.0, 4.0], 4.0),
            (Self::Skin, true) => (&[1.0, 2.0], 2.0),
            (Self::Grains, false) => (&[0.5, 1.0, 2.0], 2.0),
            (Self::Grains, true) => (&[0.5, 1.0], 1.0),
            (Self::ServoLaw | Self::GasStage, _) => (&[], 1.0),
        }
    }

    /// The scene with this knob changed by `factor`, within its range.
    fn turned(self, scene: &Scene, factor: f64) -> Scene {
        let mut s = scene.clone();
        match self {
            Self::TimeStep => {
                s.numerics.time_step_safety = (s.numerics.time_step_safety * factor).min(1.0);
            }
            Self::Skin => s.numerics.skin = (s.numerics.skin * factor).min(1.0),
            Self::Grains => s.grains = (f64::from(s.grains) * factor).round().max(1.0) as u32,
            Self::ServoLaw | Self::GasStage => {}
            Self::ControlPeriod | Self::StrainRate | Self::GasRate | Self::Damping => {
                s.phases.iter_mut().for_each(|p| self.turn_phase(p, factor));
            }
        }
        s
    }

    fn turn_phase(self, phase: &mut Phase, factor: f64) {
        if matches!(phase.kind, PhaseKind::Gas { .. }) != (self == Self::GasRate) {
            return;
        }
        match self {
            Self::ControlPeriod => {
                phase.control_period = (f64::from(phase.control_period) * factor).round().max(1.0) as u32;
            }
            Self::Damping => phase.damping = (phase.damping * factor).min(1.0),
            Self::StrainRate | Self::GasRate => {
                phase.kind.scale_rates(factor);
                // A slower path needs the longer time; a faster one fails no later.
                phase.until.timeout *= (1.0 / factor).max(1.0);
            }
            Self::TimeStep | Self::ServoLaw | Self::GasStage | Self::Skin | Self::Grains => {}
        }
    }

    /// The present value of this knob; `None` if the scene has no such setting.
    fn reading(self, scene: &Scene) -> Option<f64> {
        let behind_gas = scene.phases.iter().rfind(|p| !matches!(p.kind, PhaseKind::Gas { .. }));
        match self {
            Self::TimeStep => Some(scene.numerics.time_step_safety),
            Self::Skin => Some(scene.numerics.skin),
            Self::Grains => Some(f64::from(scene.grains)),
            Self::ControlPeriod => behind_gas.map(|p| f64::from(p.control_period)),
            Self::Damping => behind_gas.map(|p| p.damping),
            Self::StrainRate => largest_rate(scene),
            Self::GasRate => scene.phases.iter().find_map(|p| match p.kind {
                PhaseKind::Gas { rate, .. } => Some(rate.abs()),
                _ => None,
            }),
            Self::ServoLaw | Self::GasStage => None,
        }
    }

    /// The settings of this knob for this scene, including the default; empty if the scene has no such
    /// setting.
    pub(crate) fn settings(self, scene: &Scene, servoed: Option<Servoed>, quick: bool) -> Vec<Setting> {
        if self == Self::ServoLaw {
            return servo_laws(scene, servoed, quick);
        }
        if self == Self::GasStage {
            return gas_stages(scene);
        }
        let mut settings: Vec<Setting> = Vec::new();
        for factor in self.factors(quick).0 {
            let turned = self.turned(scene, *factor);
            let Some(value) = self.reading(&turned) else { continue };
            // At the end of a range, two factors give one setting.
            if settings.iter().all(|s| s.scene != turned) {
                let (value, default) = (Value::Number(value), turned == *scene);
                settings.push(Setting { knob: self, value, default, scene: turned });
            }
        }
        settings
    }
}

/// The scene with every knob at its most accurate value.
pub(crate) fn converged(scene: &Scene, quick: bool) -> Scene {
    let turn = |s: Scene, knob: &Knob| knob.turned(&s, knob.factors(quick).1);
    Knob::value_variants().iter().fold(scene.clone(), turn)
}

/// Largest strain rate imposed or allowed after the gas, 1/s.
fn largest_rate(scene: &Scene) -> Option<f64> {
    let behind_gas = scene.phases.iter().filter(|p| !matches!(p.kind, PhaseKind::Gas { .. }));
    behind_gas.filter_map(|p| p.kind.rate_limit()).reduce(f64::max)
}

/// Inertial number I = rate·D·√(ρ/p) of the fastest straining after the gas, at the mean stress target p of
/// the last servo phase; `None` without either.
pub(crate) fn inertial_number(scene: &Scene) -> Option<f64> {
    let target = |c: &ComponentControl| if let ComponentControl::Stress(s) = c { Some(*s) } else { None };
    let pressure = scene.phases.iter().rev().find_map(|p| match &p.kind {
        PhaseKind::Servo { controls, .. } => {
            let targets: Vec<f64> = controls[..3].iter().filter_map(target).collect();
            (!targets.is_empty()).then(|| targets.iter().sum::<f64>() / targets.len() as f64)
        }
        _ => None,
    })?;
    Some(largest_rate(scene)? * scene.sizes.mean() * (scene.material.density / pressure).sqrt())
}

fn law(scene: &Scene) -> Option<ServoLaw> {
    scene.phases.iter().rev().find_map(|p| match p.kind {
        PhaseKind::Servo { law, .. } => Some(law),
        _ => None,
    })
}

/// The law of the scene and others of similar speed. Eq. 1 makes stress and rate an oscillator of ω² =
/// gain·K/T, with T the time between two exchanges; ω is set a decade below the response of the scene, and a
/// leak of 2ωT damps it critically.
fn servo_laws(scene: &Scene, servoed: Option<Servoed>, quick: bool) -> Vec<Setting> {
    let (Some(own), Some(servoed)) = (law(scene), servoed) else { return Vec::new() };
    let response_time = match own {
        ServoLaw::Scaled { response_time } => response_time,
        // A few periods of a contact.
        ServoLaw::Integral { .. } | ServoLaw::Normalised { .. } => 2.0e-6,
    };
    let slow = 10.0 * response_time;
    let gain = servoed.interval / (servoed.tangent * slow * slow);
    let leak = (2.0 * servoed.interval / slow).min(1.0);
    let mut others = vec![ServoLaw::Scaled { response_time: slow }];
    if !quick {
        others.extend([leak, 0.0].map(|leak| ServoLaw::Integral { gain, leak }));
        others.push(ServoLaw::Scaled { response_time });
        others.extend([0.1, 0.3, 0.6].map(|share| ServoLaw::Normalised { share, leak: 0.0 }));
    }
    let laws: Vec<ServoLaw> = std::iter::once(own).chain(others.into_iter().filter(|l| *l != own)).collect();
    let setting = |new: &ServoLaw| {
        let mut turned = scene.clone();
        for phase in &mut turned.phases {
            if let PhaseKind::Servo { law, .. } = &mut phase.kind {
                *law = *new;
            }
        }
        let text = match new {
            ServoLaw::Scaled { response_time } => format!("scaled, {response_time:.1e} s"),
            ServoLaw::Integral { leak, .. } => format!("Eq. 1, leak {leak:.2}"),
            ServoLaw::Normalised { share, leak } if *leak == 0.0 => {
                format!("Eq. 1 at {share} of critical")
            }
            ServoLaw::Normalised { share, leak } => {
                format!("Eq. 1 at {share} of critical, leak {leak:.2}")
            }
        };
        // The scene's servo phases may have different laws; they are unchanged.
        let default = *new == own;
        let scene = if default { scene.clone() } else { turned };
        Setting { knob: Knob::ServoLaw, value: Value::Text(text), default, scene }
    };
    laws.iter().map(setting).collect()
}

/// Both methods of the gas. Settings that only soft spheres have are those of the paper's preparation: nearly
/// elastic collisions, and long control periods.
fn gas_stages(scene: &Scene) -> Vec<Setting> {
    let with = |wanted: GasMethod| {
        let mut turned = scene.clone();
        for phase in &mut turned.phases {
            if let PhaseKind::Gas { method, .. } = &mut phase.kind
                && *method != wanted
            {
                *method = wanted;
                let soft = wanted == GasMethod::Soft;
                (phase.damping, phase.control_period) = if soft { (0.002, 200) } else { (0.0, 20) };
            }
        }
        let text = if wanted == GasMethod::Soft { "soft" } else { "event_driven" };
        let value = Value::Text(text.to_owned());
        Setting { knob: Knob::GasStage, value, default: turned == *scene, scene: turned }
    };
    let gas = |p: &Phase| matches!(p.kind, PhaseKind::Gas { .. });
    if scene.phases.iter().any(gas) {
        vec![with(GasMethod::EventDriven), with(GasMethod::Soft)]
    } else {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Scene {
        Scene::parse(include_str!("press.toml")).unwrap()
    }

    const SERVOED: Option<Servoed> = Some(Servoed { tangent: 3e8, interval: 3.5e-7 });

    #[test]
    fn every_knob_has_exactly_one_default_and_changes_only_its_own_setting() {
        for quick in [false, true] {
            for knob in Knob::value_variants() {
                let settings = knob.settings(&scene(), SERVOED, quick);
                assert!(settings.len() > 1, "{knob:?}");
                for s in &settings {
                    assert_eq!(s.default, s.scene == scene(), "{knob:?} {:?}", s.value);
                }
                assert_eq!(settings.iter().filter(|s| s.default).count(), 1, "{knob:?}");
            }
        }
    }

    #[test]
    fn slow_straining_leaves_the_gas_alone_and_lowers_the_inertial_number_in_proportion() {
        let slow = Knob::StrainRate.turned(&scene(), 0.25);
        assert_eq!(slow.phases[0], scene().phases[0]);
        assert_eq!(slow.phases[2].kind, PhaseKind::Strain { rate: [0.0, 0.0, -2.0, 0.0, 0.0, 0.0] });
        // 8/s · 0.2 mm · √(2500/50e3)
        let own = inertial_number(&scene()).unwrap();
        assert!((own - 8.0 * 2e-4 * 0.05f64.sqrt()).abs() < 1e-12, "{own}");
        assert!((inertial_number(&slow).unwrap() - own / 4.0).abs() < 1e-15);
    }

    #[test]
    fn the_converged_run_answers_every_step_slowly_with_more_grains() {
        let s = converged(&scene(), false);
        assert!(s.phases[1..].iter().all(|p| p.control_period == 1));
        assert_eq!((s.grains, s.numerics.time_step_safety, s.numerics.skin), (400, 0.4, 0.2));
        assert_eq!(largest_rate(&s), Some(2.0));
    }

    #[test]
    fn a_share_of_the_stability_bound_never_exceeds_one_and_no_setting_comes_twice() {
        let mut own = scene();
        own.numerics.time_step_safety = 1.0;
        let settings = Knob::TimeStep.settings(&own, None, false);
        let values: Vec<_> = settings.iter().map(|s| s.value.clone()).collect();
        assert_eq!(values, [0.5, 0.75, 1.0].map(Value::Number));
    }

    #[test]
    fn the_gain_of_eq_1_follows_from_stiffness_and_control_interval() {
        let settings = Knob::ServoLaw.settings(&scene(), SERVOED, false);
        let Some(ServoLaw::Integral { gain, leak }) = law(&settings[2].scene) else { panic!("no Eq. 1") };
        // ω = 5e4/s: gain K/T = ω²
        assert!((gain * 3e8 / 3.5e-7 / 25e8 - 1.0).abs() < 1e-12 && (leak - 0.035).abs() < 1e-12);
        assert!(Knob::ServoLaw.settings(&scene(), None, false).is_empty());
    }
}
