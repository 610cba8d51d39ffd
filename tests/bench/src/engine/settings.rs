//! Settings of a scene that are varied, their values, and their most accurate value.

use clap::ValueEnum;
use grainlab_core::ComponentControl;
use grainlab_scene::{Phase, PhaseKind, Scene};

/// A setting. Every value is a factor on that of the scene, so that the unchanged scene is the default of every
/// setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum VariedSetting {
    /// Fraction of the stability bound that the time step takes.
    TimeStep,
    /// Solver steps between two exchanges with the servo, in every phase but the gas.
    ControlPeriod,
    /// Every strain rate and rate limit after the gas; the inertial number is proportional to it.
    StrainRate,
    /// Strain rate of the gas: determines its temperature during compression.
    GasRate,
    /// Contact damping after the gas, share of critical.
    Damping,
    /// Verlet skin over grain diameter.
    Skin,
    /// Number of grains.
    Grains,
}

impl VariedSetting {
    /// Name on the command line and in output.
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
        }
    }

    /// The scene with this setting changed by `factor`, within its range, and its value there; `None` if the scene has no such
    /// setting.
    fn scaled(self, scene: &Scene, factor: f64) -> (Scene, Option<f64>) {
        let mut s = scene.clone();
        let value = match self {
            Self::TimeStep => {
                s.numerics.time_step_safety = (s.numerics.time_step_safety * factor).min(1.0);
                Some(s.numerics.time_step_safety)
            }
            Self::Skin => {
                s.numerics.skin = (s.numerics.skin * factor).min(1.0);
                Some(s.numerics.skin)
            }
            Self::Grains => {
                s.grains = (f64::from(s.grains) * factor).round().max(1.0) as u32;
                Some(f64::from(s.grains))
            }
            Self::ControlPeriod | Self::StrainRate | Self::GasRate | Self::Damping => {
                let phases = s.phases.iter_mut().filter(|p| is_gas(p) == (self == Self::GasRate));
                let values: Vec<f64> = phases.filter_map(|phase| self.scale_phase(phase, factor)).collect();
                // The fastest straining; else the last phase, which is measured.
                let fastest = self == Self::StrainRate;
                if fastest { values.into_iter().reduce(f64::max) } else { values.last().copied() }
            }
        };
        (s, value)
    }

    fn scale_phase(self, phase: &mut Phase, factor: f64) -> Option<f64> {
        match self {
            Self::ControlPeriod => {
                phase.control_period = (f64::from(phase.control_period) * factor).round().max(1.0) as u32;
                Some(f64::from(phase.control_period))
            }
            Self::Damping => {
                phase.damping = (phase.damping * factor).min(1.0);
                Some(phase.damping)
            }
            _ => {
                scale_rates(&mut phase.kind, factor);
                // A slower path needs the longer time; a faster one fails no later.
                phase.until.timeout *= (1.0 / factor).max(1.0);
                match phase.kind {
                    PhaseKind::Gas { rate, .. } => Some(rate.abs()),
                    _ => phase.kind.rate_limit(),
                }
            }
        }
    }

    /// Values of this setting, each with its scene, the default among them; empty if the scene has no such setting.
    pub(crate) fn values(self, scene: &Scene, quick: bool) -> Vec<(f64, Scene)> {
        let mut values: Vec<(f64, Scene)> = Vec::new();
        for factor in self.factors(quick).0 {
            let (scaled, value) = self.scaled(scene, *factor);
            // At the end of a range, two factors give one setting.
            if values.iter().all(|(_, scene)| *scene != scaled) {
                values.extend(value.map(|value| (value, scaled)));
            }
        }
        values
    }
}

fn is_gas(phase: &Phase) -> bool {
    matches!(phase.kind, PhaseKind::Gas { .. })
}

/// The scene with every setting at its most accurate value.
pub(super) fn converged(scene: &Scene, quick: bool) -> Scene {
    let scaled = |s: Scene, setting: &VariedSetting| setting.scaled(&s, setting.factors(quick).1).0;
    VariedSetting::value_variants().iter().fold(scene.clone(), scaled)
}

/// Multiplies every strain rate, and the limit of one, by `factor`.
fn scale_rates(kind: &mut PhaseKind, factor: f64) {
    match kind {
        PhaseKind::Gas { rate, .. } => *rate *= factor,
        PhaseKind::Relax => {}
        PhaseKind::Strain { rate } => rate.iter_mut().for_each(|r| *r *= factor),
        PhaseKind::Servo { controls, rate_limit, .. } => {
            *rate_limit *= factor;
            for control in controls {
                if let ComponentControl::StrainRate(rate) = control {
                    *rate *= factor;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Scene {
        Scene::parse(include_str!("press.toml")).unwrap()
    }

    #[test]
    fn every_setting_has_exactly_one_default_and_changes_only_its_own_setting() {
        for quick in [false, true] {
            for setting in VariedSetting::value_variants() {
                let values = setting.values(&scene(), quick);
                assert!(values.len() > 1, "{setting:?}");
                assert_eq!(values.iter().filter(|v| v.1 == scene()).count(), 1, "{setting:?}");
            }
        }
    }

    #[test]
    fn slow_straining_leaves_the_gas_alone() {
        let (slow, value) = VariedSetting::StrainRate.scaled(&scene(), 0.25);
        assert_eq!(slow.phases[0], scene().phases[0]);
        assert_eq!(slow.phases[2].kind, PhaseKind::Strain { rate: [0.0, 0.0, -2.0, 0.0, 0.0, 0.0] });
        assert_eq!(value, Some(2.0));
    }

    #[test]
    fn the_converged_run_answers_every_step_slowly_with_more_grains() {
        let s = converged(&scene(), false);
        assert!(s.phases[1..].iter().all(|p| p.control_period == 1));
        assert_eq!((s.grains, s.numerics.time_step_safety, s.numerics.skin), (400, 0.4, 0.2));
    }

    #[test]
    fn a_share_of_the_stability_bound_never_exceeds_one_and_no_setting_comes_twice() {
        let mut own = scene();
        own.numerics.time_step_safety = 1.0;
        let values: Vec<f64> =
            VariedSetting::TimeStep.values(&own, false).into_iter().map(|(value, _)| value).collect();
        assert_eq!(values, [0.5, 0.75, 1.0]);
    }
}
