//! A table in memory, inverted by one model.

use super::answer::Answer;
use super::case::cases;
use super::columns::Row;
use super::rows::Rows;
use super::state::State;
use super::{drawn, prior};
use crate::commands::packings::import::in_range;
use grainlab_console::Failure;
use grainlab_core::notes::Note;
use grainlab_emt::Draws;
use grainlab_node_kit::Exit;
use grainlab_results::Inference;
use std::sync::atomic::{AtomicBool, Ordering};

/// Reason of a result that was not begun.
pub(crate) const INTERRUPTED: &str = "interrupted";

/// The model, and what goes with it.
#[derive(Clone, Copy, Debug)]
pub struct By<'a> {
    /// Name of the model.
    pub model: &'a str,
    /// Name of the calibration, path of its file, or text of the file.
    pub calibration: &'a str,
    /// Text of a file of a prior.
    pub prior: Option<&'a str>,
    /// Relative error of each modulus without its own.
    pub error: Option<f64>,
    /// Number and seed of draws from the posterior of the first row.
    pub draws: Option<(usize, u64)>,
}

/// The answer of a row.
#[derive(Debug)]
pub struct InvertedRow {
    /// Name of the sample, if a column has it.
    pub sample: Option<String>,
    /// Estimate of the model; if it has none, its notes have the reason.
    pub inference: Inference,
    /// Why the status is contradictory, or nothing is determined.
    pub contradictions: Vec<String>,
    /// The exit code that the command would have without an answer; `None` with one.
    pub failed: Option<Exit>,
}

/// The answers of a table.
#[derive(Debug)]
pub struct Inverted {
    /// One for each row.
    pub rows: Vec<InvertedRow>,
    /// Draws from the posterior of the first row, if asked for.
    pub draws: Option<Draws>,
}

/// Inverts each row of `table`, text of the form of `grainlab invert --table`, on all cores.
///
/// # Errors
/// Wrong names, columns or priors; draws of a row that has no answer; `stop` was set.
pub fn invert(table: Vec<u8>, by: &By<'_>, stop: &AtomicBool) -> Result<Inverted, Failure> {
    let mut cases = cases(&[by.model.to_owned()], &[by.calibration.to_owned()], None)?;
    if let Some(text) = by.prior {
        prior::apply_text("prior", text, &mut cases)?;
    }
    let [case] = &cases[..] else { return Err(Failure::usage("name one model and one calibration")) };
    if case.model == grainlab_emt::free_contact() && (by.prior.is_some() || by.draws.is_some()) {
        return Err(Failure::usage("prior and draws are not for model free-contact"));
    }
    in_range("error", by.error, "0 to 1", |v| (0.0..=1.0).contains(&v))?;
    let mut rows = Rows::of_text(table, State { relative_error: by.error, ..State::default() })?;
    let (mut found, mut draws, mut notes) = (Vec::new(), None, Vec::new());
    let answer = |number, row| match row {
        Ok(Row { state, .. }) => Answer::of(state, Some(number), &cases),
        Err(bad) => Answer::of_bad_row(bad, number),
    };
    while let Some(answers) = rows.next(answer)? {
        if stop.load(Ordering::Relaxed) {
            return Err(Failure::new(Exit::Interrupted, INTERRUPTED));
        }
        for answer in answers {
            let (sample, exit) = (answer.sample().map(str::to_owned), answer.exit(&cases));
            let failed = (!matches!(answer.outcomes[..], [Ok(_)])).then_some(exit);
            if let (Some((count, seed)), None, None, Ok(state)) = (by.draws, &draws, failed, &answer.state) {
                let of_row = drawn::drawn(state, case, count, seed);
                let (of_row, estimate) = of_row.map_err(|e| Failure::new(Exit::PhysicsInvalid, e))?;
                notes.extend(drawn::unlike(&of_row, &estimate, case.prior.is_some()).map(Note::remark));
                draws = Some(of_row);
            }
            let mut inference = answer.inferences(&cases).into_iter().next();
            inference.iter_mut().for_each(|inference| inference.estimate.notes.append(&mut notes));
            let contradictions = answer.contradictions();
            found.extend(inference.map(|inference| InvertedRow {
                sample,
                inference,
                contradictions,
                failed,
            }));
        }
    }
    Ok(Inverted { rows: found, draws })
}
