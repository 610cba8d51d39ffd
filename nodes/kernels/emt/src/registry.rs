//! The list of the models.

use crate::model::Model;
use crate::models::directional::Directional;
use crate::models::effective_medium::EffectiveMedium;
use crate::models::free_contact::{self, FreeContact};
use crate::models::hertz_mindlin::HertzMindlin;
use crate::models::ratio;
use crate::models::relaxed::Relaxed;
use grainlab_core::notes::Status;

/// Every model of contacts that are known, in the order of every list of results.
pub fn models() -> &'static [&'static dyn Model] {
    &[&EffectiveMedium, &ratio::CORRECTED, &ratio::AS_PRINTED, &Directional, &Relaxed, &HertzMindlin]
}

/// The model of contacts that are not known, or of another law than Hertz–Mindlin.
pub fn free_contact() -> &'static dyn Model {
    &FreeContact
}

/// The model of this name.
pub fn model(name: &str) -> Option<&'static dyn Model> {
    models().iter().copied().chain([free_contact()]).find(|m| m.name() == name)
}

/// Names of the models by their rms error of ε on packings that teach, smallest first: `relaxed` 0.007, `directional` 0.028, those of the
/// paper 0.054 with γ/Δ of the contacts. A test of `grainlab_calibration` checks the order. The error of k of the plain theory is 3.
const BY_ERROR: [&str; 5] = ["relaxed", "directional", "ratio", "ratio-as-printed", "emt"];

/// Name of the model that infers no ε; its error of k over the same packings is 0.86.
const WITHOUT_EPS: &str = "hertz-mindlin";

/// The models that are recommended, and none in their place: that of contacts that are not known is asked only where they are not.
const RECOMMENDED: [&str; 2] = [free_contact::NAME, "relaxed"];

/// The model whose estimate is recommended, of all models that were asked, those without an estimate as [`Status::Unknown`].
/// Among models with `free-contact`, else with `relaxed`, it is that one or none: no other model is a substitute for it. Among others,
/// the one with the smallest error over the held-out packings of those inside their range, else of those that do not contradict
/// the data; one that infers no ε only where no other has an estimate.
pub fn recommended<'a>(asked: impl IntoIterator<Item = (&'a str, Status)>) -> Option<&'a str> {
    let rank = |name: &str| BY_ERROR.iter().position(|known| *known == name).unwrap_or(BY_ERROR.len());
    let trust = |status| match status {
        Status::Ok => 0,
        Status::Extrapolated => 1,
        Status::Contradictory | Status::Unknown => 2,
    };
    let answers = |(_, status): &(&str, Status)| *status != Status::Unknown;
    let asked: Vec<(&'a str, Status)> = asked.into_iter().collect();
    let of = |first: &str| asked.iter().find(|(name, _)| *name == first);
    if let Some(recommended) = RECOMMENDED.into_iter().find_map(of) {
        return answers(recommended).then_some(recommended.0);
    }
    let key = |(name, status): &(&str, Status)| (*name == WITHOUT_EPS, trust(*status), rank(name));
    asked.into_iter().filter(answers).min_by_key(key).map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_has_a_place_in_the_order_of_errors() {
        let mut names: Vec<_> = models().iter().map(|m| m.name()).collect();
        let mut ranked = [&BY_ERROR[..], &[WITHOUT_EPS]].concat();
        names.sort_unstable();
        ranked.sort_unstable();
        assert_eq!(names, ranked);
    }

    #[test]
    fn without_an_estimate_of_the_recommended_model_no_other_stands_in_for_it() {
        use Status::{Contradictory, Extrapolated, Ok, Unknown};
        assert_eq!(recommended([("ratio", Ok), ("relaxed", Ok), ("emt", Ok)]), Some("relaxed"));
        assert_eq!(recommended([("ratio", Ok), ("relaxed", Extrapolated)]), Some("relaxed"));
        assert_eq!(recommended([("relaxed", Contradictory), ("ratio", Ok)]), Some("relaxed"));
        assert_eq!(recommended([("ratio", Ok), ("relaxed", Unknown), ("directional", Ok)]), None);
        assert_eq!(recommended([("relaxed", Ok), ("free-contact", Extrapolated)]), Some("free-contact"));
        assert_eq!(recommended([("relaxed", Ok), ("free-contact", Unknown)]), None);
    }

    #[test]
    fn of_other_models_the_best_inside_its_range_is_recommended() {
        use Status::{Extrapolated, Ok, Unknown};
        assert_eq!(recommended([("ratio", Ok), ("directional", Extrapolated)]), Some("ratio"));
        assert_eq!(recommended([("mine", Ok), ("ratio", Ok)]), Some("ratio"));
        assert_eq!(recommended([("directional", Unknown), ("emt", Ok)]), Some("emt"));
        assert_eq!(recommended([("hertz-mindlin", Ok), ("ratio", Extrapolated)]), Some("ratio"));
        assert_eq!(recommended([("hertz-mindlin", Ok), ("ratio", Unknown)]), Some("hertz-mindlin"));
        assert_eq!(recommended([("emt", Unknown), ("ratio", Unknown)]), None);
        assert_eq!(recommended([]), None);
    }
}
