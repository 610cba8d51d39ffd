//! A launched run in some 20 lines: preparation, measurements, estimates, and the directory.

mod states;

pub use crate::packing_text::moduli;

use crate::acoustic::AcousticReport;
use crate::acoustic_text;
use crate::inference::{Inference, Origin, by_origin};
use crate::packing_text::{eps, stress_ratio};
use crate::read_back::InvertedPacking;
use crate::summary::Summary;
use grainlab_console::{count, fixed, three_digits};
use grainlab_core::Vec3;
use grainlab_core::notes::{Note, Status};
use grainlab_core::results::{InferredQuantity, PackingReport};
use grainlab_msgs::{Exit, topics};
use std::collections::BTreeSet;
use std::path::Path;

/// The model of the paper (its Eqs. 21 and 22, corrected).
const PAPER: &str = "ratio";

/// Sets of data, or nodes that infer, that are shown of one packing.
const MOST_GROUPS: usize = 3;

/// Notes on an estimate that are shown; those on the packing all are.
const MOST_NOTES: usize = 1;

/// The result of a run as text. `files` are those that the directory has, and `program` is the name of the binary on the command
/// line.
pub fn text(s: &Summary, directory: &Path, files: &[&str], program: &str) -> String {
    let mut lines: Vec<String> = ended(s.launched.exit, s.reason.as_deref(), s.saved_step)
        .map(|why| row("Ended", &why))
        .into_iter()
        .collect();
    match s.states.as_slice() {
        [] => lines.push(row("Prepared", "no packing of the end of a phase was measured")),
        [state] => lines.extend(one(state)),
        several => lines.extend(states::lines(several)),
    }
    lines.extend(of_instruments(&s.of_instruments));
    let engines: Vec<String> =
        s.engines.iter().map(|e| format!("{}, packings from step {}", e.engine, e.from_step)).collect();
    lines.extend((!engines.is_empty()).then(|| row("Engine", &engines.join("; "))));
    lines.push(row("Run", &pace(s)));
    let folder = quoted(&directory.display().to_string());
    let files = if files.is_empty() { "nothing was written".to_owned() } else { files.join(", ") };
    lines.push(row("Files", &format!("{folder}: {files}")));
    let next = [
        [Exit::Interrupted, Exit::DataLoss]
            .iter()
            .any(|exit| s.launched.exit == exit.code())
            .then(|| format!("launch --resume {folder}    # {}", goes_on(s.saved_step))),
        (!s.states.is_empty()).then(|| format!("analyze {folder}    # all that is measured")),
        Some(format!("bag info {folder}    # what was recorded")),
        Some("launch --scene s2 --verbose    # another scene, every model".to_owned()),
    ];
    for (n, command) in next.into_iter().flatten().enumerate() {
        lines.push(row(if n == 0 { "Next" } else { "" }, &format!("{program} {command}")));
    }
    lines.join("\n") + "\n"
}

/// Step from which a resumed run goes on.
pub fn goes_on(saved_step: Option<u64>) -> String {
    saved_step
        .map_or_else(|| "begins anew: no state was saved".to_owned(), |n| format!("goes on from step {n}"))
}

/// Number of lost messages. A recorder that was killed, or had no room on the disk, did not count all of its file.
pub fn lost_words(lost: u64, uncounted_files: usize) -> String {
    match uncounted_files {
        0 => format!("{lost} lost"),
        n => format!("{lost} lost, not counting {} whose recorder ended early", count(n, "file")),
    }
}

/// Meaning of an exit code other than 0 for the lines below it, with the step of the last packing in the recording.
pub fn ended(code: u8, reason: Option<&str>, saved_step: Option<u64>) -> Option<String> {
    let exit = Exit::ALL.into_iter().find(|e| e.code() == code)?;
    let saved = || match saved_step {
        Some(step) => format!("the last saved state is that of step {step}"),
        None => "no state was saved".to_owned(),
    };
    let why = match exit {
        Exit::Done => return None,
        Exit::Failure => format!("a process failed; {}", saved()),
        Exit::Usage => "invalid arguments".to_owned(),
        Exit::DataLoss => match reason {
            Some(reason) => format!("messages or results are missing or refused: {reason}"),
            None => "messages or results are missing in the recording".to_owned(),
        },
        Exit::PhysicsInvalid => {
            reason.map_or_else(|| format!("the loading path was not completed; {}", saved()), str::to_owned)
        }
        Exit::Interrupted => format!("interrupted; {}", saved()),
    };
    Some(format!("with exit code {code}: {why}"))
}

/// A word for a shell.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+=:,@%".contains(c);
    let is_plain = !word.is_empty() && word.chars().all(is_plain);
    if is_plain { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

fn row(name: &str, text: &str) -> String {
    format!("{name:<10}{text}")
}

fn one(state: &InvertedPacking) -> Vec<String> {
    let r = &state.packing.report;
    let mut lines = vec![row("Prepared", &prepared(r)), row("Counted", &counted(r))];
    match r.elasticity.as_ref().err() {
        None => lines.push(row("Measured", &measured(r))),
        Some(why) => lines.push(row("Measured", &format!("no stiffness: {why}"))),
    }
    let told = r.elasticity.as_ref().err().map(Note::from);
    let notes = state.packing.notes.iter().filter(|note| Some(*note) != told.as_ref());
    lines.extend(notes.map(|note| row("Note", &note.to_string())));
    let of_speeds = state.acoustics().filter_map(AcousticReport::doubt);
    lines.extend(of_speeds.map(|(note, more)| row("Note", &format!("wave speeds: {note}{more}"))));
    let groups = by_origin(&state.results);
    let shown = if groups.len() > MOST_GROUPS { MOST_GROUPS - 1 } else { groups.len() };
    for (origin, results) in &groups[..shown] {
        let source = source(origin, state, groups.len() > 1);
        match Inference::recommended(results) {
            Some(best) => lines.extend(recommended(best, &source, r)),
            None => {
                let why = Inference::why_unknown(results).unwrap_or_else(|| "no model was asked".to_owned());
                lines.push(row("Inferred", &format!("unknown from {source}: {why}")));
            }
        }
        if groups.len() < MOST_GROUPS {
            lines.extend(by_the_paper(results, r));
        }
    }
    if shown < groups.len() {
        lines.push(row("", &format!("and {} more: --verbose has all", groups.len() - shown)));
    }
    if groups.is_empty() {
        lines.push(row("Inferred", "nothing: no moduli were inverted"));
    }
    lines
}

fn recommended(e: &Inference, source: &str, truth: &PackingReport) -> Vec<String> {
    let title = format!("from {source}, without the contacts, by model {} ({}):", e.model, e.status);
    let values = estimate(e, truth).map(|(name, value, sigma, error)| {
        let sigma = sigma.unwrap_or_else(|| "?".to_owned());
        row("", &format!("{name:6}{value:6} +- {sigma:6}  error {error}"))
    });
    let why = e.notes.iter().filter(|_| e.status != Status::Ok).take(MOST_NOTES);
    let why = why.map(|note| row("Note", &note.to_string()));
    std::iter::once(row("Inferred", &title)).chain(values).chain(why).collect()
}

fn by_the_paper(results: &[&Inference], truth: &PackingReport) -> Option<String> {
    let e = results.iter().find(|r| {
        r.model == PAPER && r.values[InferredQuantity::K].or(r.values[InferredQuantity::Eps]).is_some()
    })?;
    let values = estimate(e, truth).map(|(name, value, _, error)| format!("{name} {value} (error {error})"));
    let values = values.collect::<Vec<_>>().join(", ");
    Some(row("Paper", &format!("by its model {}: {values}, {}", e.model, e.status)))
}

fn prepared(r: &PackingReport) -> String {
    let unbalanced =
        r.unbalanced_force_ratio.map_or_else(String::new, |u| format!(", unbalanced force {u:.0e}"));
    format!(
        "{} grains at {} kPa, solid fraction {:.4}, q/p {}{unbalanced}",
        r.contacts.grains,
        three_digits(Some(r.pressure() / 1e3), 2),
        r.solid_fraction,
        stress_ratio(r),
    )
}

fn counted(r: &PackingReport) -> String {
    let c = &r.contacts;
    let axis = r.fabric.reference_axis;
    let about = if axis == Vec3::z() {
        String::new()
    } else {
        format!(" about ({:.2}, {:.2}, {:.2})", axis.x, axis.y, axis.z)
    };
    format!(
        "{}, {}: k {:.3}, z {:.3}, eps {}, eps_k {}{about}",
        count(c.contacts, "contact"),
        count(c.rattlers, "rattler"),
        c.coordination,
        c.mechanical_coordination,
        fixed(eps(r), 4),
        fixed(r.stiffness_anisotropy(), 4)
    )
}

fn measured(r: &PackingReport) -> String {
    let [g12, g13, theta] = moduli(r).map(|m| three_digits(m, 2));
    let [c11, c33, c13] = r.projected().map_or([None; 3], |t| [t.c11, t.c33, t.c13].map(Some));
    let [c11, c33, c13] = [c11, c33, c13].map(|m| three_digits(m.map(|m| m / 1e6), 2));
    format!("G12 {g12}, G13 {g13}, C11 {c11}, C33 {c33}, C13 {c13}, Theta {theta} MPa")
}

/// Data that were inverted and are not about a packing of the run.
fn of_instruments(results: &[Inference]) -> Option<String> {
    let data: BTreeSet<String> = results.iter().filter_map(|r| r.origin.data()).collect();
    let first = data.first()?;
    let more = match data.len() {
        1 => String::new(),
        n => format!(" and {} more", n - 1),
    };
    Some(row(
        "Also",
        &format!("inverted, and of no packing of the run: {first}{more}: summary.json has the estimates"),
    ))
}

/// The data inverted: `moduli`, or `wave speeds (…)`; and the node, if several infer.
fn source(origin: &Origin, state: &InvertedPacking, several: bool) -> String {
    let data = match (origin.source.as_deref(), state.acoustic_of(origin.measurement.as_ref())) {
        (Some(name), Some(a)) if name == topics::WAVE_SPEEDS.name => acoustic_text::heading(a),
        _ => origin.data().unwrap_or_else(|| "moduli".to_owned()),
    };
    match &origin.by {
        Some(node) if several => format!("{data} ({node})"),
        _ => data,
    }
}

/// Name, value, standard deviation, and error against the counted value, of each quantity of an estimate.
fn estimate(
    e: &Inference,
    truth: &PackingReport,
) -> impl Iterator<Item = (&'static str, String, Option<String>, String)> {
    InferredQuantity::ALL.into_iter().filter_map(|q| {
        let (value, truth, digits) = (e.values[q]?, truth.counted(q)?, q.digits());
        let sigma = e.sigma(q).map(|s| format!("{s:.digits$}"));
        Some((q.text(), format!("{value:.digits$}"), sigma, format!("{:+.digits$}", value - truth)))
    })
}

fn pace(s: &Summary) -> String {
    let since = if s.launched.resumed { " since it was resumed" } else { "" };
    let mut text = format!("{:.1} s{since}", s.launched.wall_seconds);
    if let Some(rate) = s.particle_steps_per_second.filter(|rate| *rate > 0.0) {
        text += &format!(", {:.1} M particle-steps per second of computing", rate / 1e6);
    }
    if let Some(n) = s.launched.exchanges {
        let in_all = if s.launched.resumed { " in all" } else { "" };
        text += &format!(", {}{in_all}", count(n, "exchange"));
    }
    let (messages, lost) = s.topics.iter().fold((0, 0), |(m, l), t| (m + t.recorded, l + t.lost));
    // A killed recorder leaves no counts.
    text += &match s.topics.is_empty() {
        true => "; messages were not counted".to_owned(),
        false => {
            format!(
                "; {} recorded, {}",
                count(messages, "message"),
                lost_words(lost, s.launched.uncounted_files)
            )
        }
    };
    if s.within_phases.packings > 0 {
        text += &format!(", {} within phases", count(s.within_phases.packings, "packing"));
    }
    for node in s.launched.nodes.iter().filter(|n| n.restarts > 0) {
        text += &format!("; {} was restarted {}", node.name, count(node.restarts, "time"));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured_packing::tests::lattice;

    #[test]
    fn a_path_can_be_pasted_into_a_shell() {
        assert_eq!(quoted("recordings/runs/demo-1-1"), "recordings/runs/demo-1-1");
        assert_eq!(quoted("my runs/it's"), r"'my runs/it'\''s'");
    }

    /// A lattice of grains with the modulus of a gel: kPa and less.
    #[test]
    fn moduli_and_pressure_of_soft_grains_keep_three_digits() {
        let mut soft = lattice(true);
        soft.material.shear_modulus = 1e4;
        soft.contacts.iter_mut().for_each(|c| c.normal_force *= 1e-4);
        let report = crate::measured_packing::tests::measured(&soft).report;
        // C13 of this lattice is 0, and has no digits.
        for text in [prepared(&report), measured(&report).replace("C13 0.00,", "")] {
            assert!(!text.contains("0.00,") && !text.contains("0.00 ") && !text.contains("0.01,"), "{text}");
        }
        let [g12, ..] = moduli(&report).map(Option::unwrap);
        assert!(g12 < 0.01 && measured(&report).contains(&format!("G12 {}", three_digits(Some(g12), 2))));
    }

    #[test]
    fn only_a_run_that_is_done_ends_without_a_reason() {
        for exit in Exit::ALL {
            assert_eq!(ended(exit.code(), None, None).is_none(), exit == Exit::Done, "{exit:?}");
        }
        let why = ended(4, Some("phase 2 (rest) did not meet its end conditions"), None).unwrap();
        assert_eq!(why, "with exit code 4: phase 2 (rest) did not meet its end conditions");
    }

    #[test]
    fn a_run_that_lost_data_says_why_if_it_is_known() {
        let of = |reason| ended(Exit::DataLoss.code(), reason, None).unwrap();
        assert!(of(None).ends_with("missing in the recording"));
        assert!(of(Some("speed = NaN is refused")).ends_with("missing or refused: speed = NaN is refused"));
    }

    #[test]
    fn losses_that_a_killed_recorder_did_not_count_are_not_called_none() {
        assert_eq!(lost_words(0, 0), "0 lost");
        assert_eq!(lost_words(2, 1), "2 lost, not counting 1 file whose recorder ended early");
    }

    #[test]
    fn only_files_that_exist_are_listed() {
        let summary = Summary::of_nothing(Exit::DataLoss);
        let files = |files: &[&str]| {
            let text = text(&summary, Path::new("r"), files, "grainlab");
            text.lines().find(|l| l.starts_with("Files")).unwrap().to_owned()
        };
        assert_eq!(files(&["scene.toml", "logs"]), "Files     r: scene.toml, logs");
        assert_eq!(files(&[]), "Files     r: nothing was written");
    }

    #[test]
    fn an_interrupted_run_names_the_state_that_was_saved_or_says_that_none_was() {
        let why = |saved| ended(Exit::Interrupted.code(), None, saved).unwrap();
        assert_eq!(
            why(Some(120)),
            "with exit code 130: interrupted; the last saved state is that of step 120"
        );
        assert_eq!(why(None), "with exit code 130: interrupted; no state was saved");
        assert_eq!(
            [Some(120), None].map(goes_on),
            ["goes on from step 120", "begins anew: no state was saved"]
        );
    }
}
