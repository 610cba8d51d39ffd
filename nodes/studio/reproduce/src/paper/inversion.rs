//! The models judged on the simulated packings, whose microstructure was counted.

use super::sample::{Observed, States};
use super::tables::PAPER;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{
    Calibration, Inversion, Model, Modulus, Observation, StrainRatio, StrainRatioSource, models,
};
use grainlab_page::Mean;

/// Relative error of each modulus.
pub const ERROR: f64 = 0.01;

/// A model with its constants and its γ/Δ.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Model of the inversion.
    pub model: &'static dyn Model,
    /// Constants of the model.
    pub calibration: &'static Calibration,
    /// The γ/Δ; `None` for a model without.
    pub gamma: Option<StrainRatioSource>,
}

impl Case {
    /// Every model with the paper's constants and with ours, where it takes them, and with each of the three γ/Δ.
    pub fn all() -> Vec<Self> {
        let ratios = [StrainRatioSource::Total, StrainRatioSource::Elastic, StrainRatioSource::Contact];
        let mut all = Vec::new();
        for model in models().iter().copied() {
            let gammas: Vec<_> = if model.uses_gamma() { ratios.map(Some).to_vec() } else { vec![None] };
            let default = model.default_calibration();
            let ours = Calibration::builtin("grainlab")
                .filter(|c| c.name() != default.name() && model.uses_constants());
            for calibration in std::iter::once(default).chain(ours) {
                all.extend(gammas.iter().map(|gamma| Self { model, calibration, gamma: *gamma }));
            }
        }
        all
    }

    /// The estimate from the moduli of a packing, as `grainlab invert` makes it with this error; `None` where it has no answer.
    fn infer(&self, observed: &Observed) -> Option<Inversion> {
        let r = &observed.report;
        let mut observation = Observation::of(r)?;
        let gamma = self.gamma.map(|source| StrainRatio::of(&r.strain_ratios, source));
        observation.conditions.gamma = gamma.unwrap_or(StrainRatio::ZERO);
        // Θ follows from the other moduli: with an error of its own it would be one more measurement.
        observation.moduli = observation.moduli.without(Modulus::Theta);
        self.model.infer(&observation.with_relative_error(ERROR), self.calibration).ok()
    }
}

/// Errors of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Mean of the magnitude.
    pub magnitude: f64,
    /// Mean with its sign.
    pub bias: f64,
    /// Root mean square.
    pub rms: f64,
    /// Number of states with an estimate.
    pub count: usize,
}

impl Errors {
    /// Summary of these errors; `None` without one.
    pub fn of(errors: &[f64]) -> Option<Self> {
        let mean = |value: fn(f64) -> f64| Mean::of(errors.iter().map(|e| value(*e))).map(|m| m.value);
        Some(Self {
            magnitude: mean(f64::abs)?,
            bias: mean(|e| e)?,
            rms: mean(|e| e * e)?.sqrt(),
            count: errors.len(),
        })
    }
}

/// Errors of one case on all states.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Case that is judged.
    pub case: Case,
    /// Errors of k; `None`, as of z and ε, where the model does not infer it.
    pub k: Option<Errors>,
    /// Errors of z.
    pub z: Option<Errors>,
    /// Errors of ε.
    pub eps: Option<Errors>,
    /// States without an answer.
    pub unanswered: usize,
    /// Inferred k and ε of each state, mean over seeds, by sample and pressure.
    pub rows: Vec<Row>,
}

impl Judged {
    /// The errors of a model with a γ/Δ and constants.
    pub fn find<'a>(
        judged: &'a [Self],
        model: &str,
        gamma: Option<&str>,
        calibration: &str,
    ) -> Option<&'a Self> {
        judged.iter().find(|Self { case, .. }| {
            case.model.name() == model
                && case.calibration.name() == calibration
                && case.gamma.map(|g| g.name()) == gamma
        })
    }
}

/// Means over the seeds of one state; the errors are the standard deviations of one estimate, mean over seeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Index of the sample.
    pub sample: usize,
    /// Index of the pressure.
    pub pressure: usize,
    /// Inferred k, mean.
    pub k: Option<Mean>,
    /// Inferred ε, mean.
    pub eps: Option<Mean>,
}

/// Every case on every state.
pub fn judge(states: &States) -> Vec<Judged> {
    Case::all().into_iter().map(|case| judge_one(case, states)).collect()
}

fn judge_one(case: Case, states: &States) -> Judged {
    let found: Vec<_> = states.all().iter().map(|o| (o, case.infer(o))).collect();
    let value = |found: &Option<Inversion>, q: InferredQuantity| found.as_ref()?.structure.get(q);
    let errors = |q: InferredQuantity, truth: fn(&Observed) -> f64| {
        let errors: Vec<f64> = found.iter().filter_map(|(o, f)| Some(value(f, q)? - truth(o))).collect();
        Errors::of(&errors)
    };
    let rows = States::places().map(|(sample, pressure)| {
        let here = || found.iter().filter(move |(o, _)| o.sample == sample && o.pressure == pressure);
        let mean = |q| {
            let sigma = Mean::of(here().filter_map(|(_, f)| f.as_ref()?.stddev(q)));
            let mean = Mean::of(here().filter_map(|(_, f)| value(f, q)))?;
            Some(Mean { error: sigma.map(|s| s.value), ..mean })
        };
        Row { sample, pressure, k: mean(InferredQuantity::K), eps: mean(InferredQuantity::Eps) }
    });
    Judged {
        rows: rows.collect(),
        k: errors(InferredQuantity::K, |o| o.report.contacts.coordination),
        z: errors(InferredQuantity::Z, |o| o.report.contacts.mechanical_coordination),
        eps: errors(InferredQuantity::Eps, |o| o.report.fabric.contact_anisotropy),
        unanswered: found.iter().filter(|(_, f)| f.is_none()).count(),
        case,
    }
}

/// Errors of the paper's own inversion on its own packings (Table III): k by the ratios, k by the effective medium theory, ε.
pub fn of_the_paper() -> [Errors; 3] {
    let states = || PAPER.iter().flat_map(|s| &s.states);
    let all = |error: fn(&super::tables::State) -> f64| {
        let errors: Vec<f64> = states().map(error).collect();
        Errors::of(&errors).unwrap_or(Errors { magnitude: f64::NAN, bias: f64::NAN, rms: f64::NAN, count: 0 })
    };
    [all(|s| s.k_ratio - s.k_sim), all(|s| s.k_emt - s.k_sim), all(|s| s.eps_ratio - s.eps_sim)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sizes that ERRATA and the README give for the paper's own rows.
    #[test]
    fn the_errors_of_table_iii_are_those_known() {
        let [ratio, emt, eps] = of_the_paper();
        assert!((ratio.magnitude - 0.16).abs() < 0.01 && ratio.bias > 0.0, "{ratio:?}");
        assert!((emt.magnitude - 4.9).abs() < 0.05 && emt.bias < 0.0, "{emt:?}");
        assert!((eps.magnitude - 0.036).abs() < 0.001 && (eps.bias - 0.028).abs() < 0.001, "{eps:?}");
    }

    #[test]
    fn models_with_gamma_are_judged_with_each_of_the_three() {
        let cases = Case::all();
        let of = |name: &str| cases.iter().filter(|w| w.model.name() == name).count();
        assert_eq!((of("relaxed"), of("emt"), of("ratio")), (1, 3, 6));
    }
}
