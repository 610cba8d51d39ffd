//! Findings of a run in sentences made from its numbers: what was done, what was found, how sure it is, and what to doubt.

mod doubts;
mod judged;

use crate::inference::Inference;
use crate::packing_text::eps;
use crate::read_back::InvertedPacking;
use doubts::Doubts;
use grainlab_console::{and, count, three_digits};
use grainlab_core::results::{InferredQuantity, PackingReport};
use grainlab_msgs::topics::PACKING_REPORT;
pub use judged::{Judged, recommended};
use std::collections::BTreeSet;

/// Deviator over mean stress from which a state is not called isotropic.
const ISOTROPIC: f64 = 0.01;

/// Sentences on a run, or on many.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// The packing, or the packings.
    pub done: String,
    /// Inferred beside counted values, and how often the intervals contain them.
    pub found: Vec<String>,
    /// Reasons to doubt; empty without any.
    pub doubts: Vec<String>,
}

impl Findings {
    /// Findings of the packings at the ends of the phases of a run, in their order.
    pub fn of(states: &[InvertedPacking]) -> Self {
        let all: Vec<&InvertedPacking> = states.iter().collect();
        let (done, found) = match states {
            [] => ("No packing at the end of a phase was measured.".to_owned(), Vec::new()),
            [state] => (done(state), recommended(state).map_or_else(Vec::new, |best| of_one(state, best))),
            several => (done_of_several(several), Self::inferred(&all)),
        };
        Self { done, found, doubts: Self::doubts(&all, "state") }
    }

    /// Reasons to doubt these states, each of which is of one `noun`.
    pub fn doubts(states: &[&InvertedPacking], noun: &str) -> Vec<String> {
        let mut doubts = Doubts::default();
        states.iter().enumerate().for_each(|(n, state)| doubts.take(n, state));
        states.iter().enumerate().for_each(|(n, state)| doubts.count_further(n, state));
        let beside = doubts::beside_the_count(states, noun);
        beside.into_iter().chain(doubts.finish(states.len(), noun)).collect()
    }

    /// The inversion of several states in sentences; none if nothing was inferred.
    pub fn inferred(states: &[&InvertedPacking]) -> Vec<String> {
        let best: Vec<_> = states.iter().filter_map(|s| Some((*s, recommended(s)?))).collect();
        let judged: Vec<Judged> = best.iter().flat_map(|(s, b)| Judged::of(b, &s.packing.report)).collect();
        let rms = |q: InferredQuantity| {
            let of = judged.iter().filter(|j| j.quantity == q);
            let squares: Vec<f64> = of.map(|j| (j.inferred - j.counted).powi(2)).collect();
            let (mean, digits) = (squares.iter().sum::<f64>() / squares.len() as f64, q.digits());
            (!squares.is_empty()).then(|| format!("{} {:.digits$}", q.symbol(), mean.sqrt()))
        };
        let errors: Vec<String> = InferredQuantity::countable().filter_map(rms).collect();
        if errors.is_empty() {
            return Vec::new();
        }
        let models: BTreeSet<&str> = best.iter().map(|(_, b)| b.model.as_str()).collect();
        let mut found = vec![format!(
            "The model {} inferred the structure of {}; rms differences from the count: {}.",
            and(&models.into_iter().collect::<Vec<_>>()),
            count(best.len(), "state"),
            and(&errors)
        )];
        let with: Vec<bool> = judged.iter().filter_map(Judged::is_inside).collect();
        if !with.is_empty() {
            let inside = with.iter().filter(|is_inside| **is_inside).count();
            found.push(format!("{inside} of {} counted values lie in their 95 % intervals.", with.len()));
        }
        found
    }
}

fn done(state: &InvertedPacking) -> String {
    let r = &state.packing.report;
    let stress = match r.stress_ratio() {
        Some(q) if q.abs() >= ISOTROPIC => format!(", under a deviatoric stress q/p of {q:.2}"),
        Some(_) => ", isotropic in stress".to_owned(),
        None => String::new(),
    };
    let anisotropy = eps(r).map_or_else(String::new, |e| format!(", and the contact anisotropy ε is {e:.3}"));
    format!(
        "{} at {} kPa{stress}. Counted: {:.2} contacts per grain without rattlers (z){anisotropy}.",
        count(r.contacts.grains, "grain"),
        four_digits(r.pressure() / 1e3),
        r.contacts.mechanical_coordination,
    )
}

/// A number rounded to four significant digits, so that 50.000003 is 50.
fn four_digits(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

fn done_of_several(states: &[InvertedPacking]) -> String {
    let range = |of: &dyn Fn(&PackingReport) -> f64, form: &dyn Fn(f64) -> String| {
        let values = states.iter().map(|s| of(&s.packing.report));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let [low, high] = [low, high].map(form);
        if low == high { low } else { format!("{low} to {high}") }
    };
    let grains = states.iter().map(|s| s.packing.report.contacts.grains).max().unwrap_or(0);
    format!(
        "{} in {} states: pressure {} kPa. Counted: z {}, ε {}.",
        count(grains, "grain"),
        states.len(),
        range(&|r| r.pressure() / 1e3, &|p| three_digits(Some(p), 1)),
        range(&|r| r.contacts.mechanical_coordination, &|z| format!("{z:.2}")),
        range(&|r| r.fabric.contact_anisotropy, &|eps| format!("{eps:.3}"))
    )
}

/// Words for the data of a result.
pub fn data(result: &Inference) -> String {
    let data = match result.origin.source.as_deref() {
        Some(source) if source != PACKING_REPORT.name => {
            result.origin.data().unwrap_or_default().replace('_', " ")
        }
        _ => "its moduli".to_owned(),
    };
    format!("{data}, the stress, and the sizes and material of the grains")
}

fn of_one(state: &InvertedPacking, best: &Inference) -> Vec<String> {
    let (data, model, judged) = (data(best), &best.model, Judged::of(best, &state.packing.report));
    let main = [InferredQuantity::Z, InferredQuantity::Eps];
    let is_shown =
        |j: &&Judged| main.contains(&j.quantity) || !judged.iter().any(|j| main.contains(&j.quantity));
    let values: Vec<String> = judged.iter().filter(is_shown).map(Judged::words).collect();
    let infers = match values.as_slice() {
        [] => format!("From {data}, the model {model} infers no quantity that can be counted."),
        values => format!("From {data}, the model {model} infers {}.", and(values)),
    };
    std::iter::once(infers).chain(inside(&judged)).collect()
}

/// Quantities whose interval contains the counted value, and those whose does not.
fn inside(judged: &[Judged]) -> Option<String> {
    let of = |wanted| -> Vec<&str> {
        judged.iter().filter(|j| j.is_inside() == Some(wanted)).map(|j| j.quantity.symbol()).collect()
    };
    let (inside, outside) = (of(true), of(false));
    let lie = |all: &[&str]| format!("The counted {} lie{}", and(all), s(all.len() == 1));
    let text = match (inside.as_slice(), outside.as_slice()) {
        ([], []) => return None,
        (all, []) => format!("{} in the 95 % interval{}", lie(all), s(all.len() > 1)),
        ([], all) => format!("{} outside of the 95 % interval{}", lie(all), s(all.len() > 1)),
        (some, others) => {
            format!("The 95 % intervals contain the counted {}, but not {}", and(some), and(others))
        }
    };
    let farthest =
        judged.iter().filter_map(|j| Some((j.sigmas()?, j.quantity))).max_by(|a, b| a.0.total_cmp(&b.0));
    let farthest = farthest.filter(|_| judged.len() > 1);
    let farthest =
        farthest.map_or_else(String::new, |(s, q)| format!("; {} is farthest, {s:.1} σ away", q.symbol()));
    Some(format!("{text}{farthest}."))
}

fn s(is_wanted: bool) -> &'static str {
    if is_wanted { "s" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured_packing::tests::{lattice, measured};
    use grainlab_core::notes::{Note, Status};
    use grainlab_core::results::{Estimate, MicrostructureCovariance};

    fn result(status: Status, z: Option<(f64, f64)>, reasons: &[&'static str]) -> Inference {
        let mut found = Estimate { model: "relaxed".to_owned(), status, ..Estimate::default() };
        found.notes = reasons.iter().map(|reason| Note::remark(*reason)).collect();
        if let Some((value, sigma)) = z {
            let at = InferredQuantity::Z as usize;
            found.values.0[at] = Some(value);
            found.covariance.insert(MicrostructureCovariance::zeros())[(at, at)] = sigma * sigma;
        }
        found.into()
    }

    /// A lattice, of which every grain has six contacts.
    fn state(step: u64, touching: bool, result: Inference) -> InvertedPacking {
        let mut packing = measured(&lattice(touching));
        packing.step = step;
        InvertedPacking { packing, acoustic: None, further_acoustic: Vec::new(), results: vec![result] }
    }

    fn of(touching: bool, result: Inference) -> Findings {
        Findings::of(&[state(1, touching, result)])
    }

    #[test]
    fn a_value_beside_its_count_has_its_distance_and_is_inside_or_outside_of_its_interval() {
        let found = of(true, result(Status::Ok, Some((5.9, 0.1)), &[])).found;
        assert_eq!(
            found,
            [
                "From its moduli, the stress, and the sizes and material of the grains, the model relaxed infers z 5.900 ± 0.100 (counted 6.000, 1.0 σ away).",
                "The counted z lies in the 95 % interval."
            ]
        );
        let Findings { found, doubts, .. } = of(true, result(Status::Ok, Some((5.0, 0.1)), &[]));
        assert!(
            found[0].contains("10.0 σ away")
                && found[1] == "The counted z lies outside of the 95 % interval."
        );
        assert_eq!(doubts, ["The counted z is outside of its 95 % interval."]);
    }

    #[test]
    fn an_estimate_with_another_status_is_doubted_with_its_first_reason() {
        assert!(of(true, result(Status::Ok, Some((6.0, 0.1)), &["a note"])).doubts.is_empty());
        for status in [Status::Extrapolated, Status::Contradictory] {
            let doubts = of(true, result(status, Some((6.0, 0.1)), &["why", "more"])).doubts;
            assert_eq!(doubts, [format!("The estimate is {status}: why.")]);
        }
    }

    #[test]
    fn without_an_estimate_the_reason_is_the_doubt_and_nothing_is_found() {
        let unknown = of(true, result(Status::Unknown, None, &["smooth contacts"]));
        assert!(unknown.found.is_empty());
        assert_eq!(unknown.doubts, ["Nothing was inferred: model relaxed: smooth contacts."]);
        let gas = of(false, result(Status::Unknown, None, &[]));
        assert!(
            gas.found.is_empty()
                && gas.doubts[0].starts_with("Nothing was inferred: there is no stiffness: ")
        );
        assert_eq!(Findings::of(&[]).done, "No packing at the end of a phase was measured.");
    }

    #[test]
    fn several_states_have_one_sentence_and_a_doubt_names_the_number_of_its_states() {
        let states = [
            state(1, true, result(Status::Ok, Some((6.3, 0.2)), &[])),
            state(2, true, result(Status::Extrapolated, Some((5.6, 0.1)), &["far"])),
        ];
        let Findings { done, found, doubts } = Findings::of(&states);
        assert!(done.starts_with("1 grain in 2 states: pressure "), "{done}");
        assert_eq!(
            found,
            [
                "The model relaxed inferred the structure of 2 states; rms differences from the count: z 0.354.",
                "1 of 2 counted values lie in their 95 % intervals."
            ]
        );
        assert_eq!(doubts, ["In 1 of 2 states: the estimate is extrapolated: far."]);
    }

    #[test]
    fn errors_of_one_sign_and_fewer_values_in_their_intervals_than_by_chance_are_doubts() {
        let of = |z: &[f64]| {
            let one = |(n, z): (u64, &f64)| state(n, true, result(Status::Ok, Some((*z, 0.1)), &[]));
            Findings::of(&(1..).zip(z).map(one).collect::<Vec<_>>()).doubts
        };
        assert!(of(&[5.95, 6.05, 5.9, 5.5]).is_empty() && of(&[6.1; 7]).is_empty());
        assert_eq!(of(&[6.1; 8]), ["z is inferred too high in every state."]);
        assert_eq!(of(&[5.5, 6.5, 5.5, 6.1]), ["Only 1 of 4 counted values lie in their 95 % intervals."]);
    }

    #[test]
    fn doubts_that_differ_by_numbers_are_one_with_their_range_and_the_number_of_its_states() {
        let doubt = |n, phi: f64| {
            let mut one = state(n, true, result(Status::Ok, Some((6.0, 0.1)), &[]));
            one.packing.notes = vec![Note::overfull(phi)];
            one
        };
        let states = [
            doubt(1, 0.9769),
            doubt(2, 0.981),
            doubt(3, 0.96),
            state(4, true, result(Status::Ok, Some((6.0, 0.1)), &[])),
        ];
        assert_eq!(
            Findings::of(&states).doubts,
            [
                "In 3 of 4 states: solid fraction 0.960 to 0.981: no grains fill a cell so far; check the units of cell and radii."
            ]
        );
    }

    #[test]
    fn a_reason_counts_in_every_state_that_has_it_not_only_where_it_is_the_first() {
        let of =
            |n, why: &[&'static str]| state(n, true, result(Status::Extrapolated, Some((6.0, 0.1)), why));
        let states = [of(1, &["the pressure", "the law"]), of(2, &["the law"]), of(3, &["the law", "x"])];
        assert_eq!(
            Findings::of(&states).doubts,
            [
                "In 1 of 3 states: the estimate is extrapolated: the pressure.",
                "In every state: the estimate is extrapolated: the law."
            ]
        );
    }

    #[test]
    fn of_many_doubts_the_first_are_written_out_and_the_others_counted() {
        let mut one = state(1, true, result(Status::Ok, Some((6.0, 0.1)), &[]));
        one.packing.notes = ["a", "b", "c", "d", "e"].map(Note::remark).to_vec();
        assert_eq!(Findings::of(&[one]).doubts, ["A.", "B.", "C.", "And 2 further warnings."]);
    }

    #[test]
    fn the_pressures_of_several_states_of_soft_grains_keep_three_digits() {
        let states = [1e-4, 2e-4].map(|share: f64| {
            let mut soft = lattice(true);
            soft.contacts.iter_mut().for_each(|c| c.normal_force *= share);
            InvertedPacking { packing: measured(&soft), ..state(1, true, result(Status::Unknown, None, &[])) }
        });
        let [low, high] = states.each_ref().map(|s| three_digits(Some(s.packing.report.pressure() / 1e3), 1));
        assert!(low.starts_with("0.00"), "{low}");
        let text = done_of_several(&states);
        assert!(text.contains(&format!("pressure {low} to {high} kPa")), "{text}");
    }
}
