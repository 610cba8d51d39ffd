//! Estimates against the truth in a table, model by model.
//!
//! - [`score`]: statistics of the errors of one quantity; [`plot`]: estimates against the truth, plotted

#[cfg(feature = "studio")]
mod plot;
mod score;

use super::answer::Answer;
use super::case::Case;
use super::columns::BadRow;
use super::rows::Rows;
use super::state::State;
use super::table::Tally;
use grainlab_console::{Failure, Format, Table, count, exact, fixed, say};
use grainlab_core::results::InferredQuantity;
use grainlab_node_kit::Exit;
use score::Score;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// The result of one case for one quantity of one group of rows.
#[derive(Debug, Serialize)]
struct Judged {
    /// Cells of the columns grouped by.
    group: Vec<String>,
    model: &'static str,
    calibration: String,
    /// The γ/Δ that the model used, or `none`.
    gamma_over_delta_source: &'static str,
    quantity: &'static str,
    /// The quantity that it is compared with.
    truth: &'static str,
    #[serde(flatten)]
    score: Score,
}

/// The result of one case for one row: whether there is an estimate, the γ/Δ used, and the error of each quantity whose truth is known.
struct Verdict {
    solved: bool,
    gamma: &'static str,
    errors: [Option<score::Error>; InferredQuantity::COUNT],
    /// True and inferred contact anisotropy.
    anisotropy: Option<[f64; 2]>,
}

pub(super) fn run(
    mut rows: Rows,
    by: &[String],
    cases: &[Case],
    plot: Option<&Path>,
    format: Format,
) -> Result<Exit, Failure> {
    plot.map_or(Ok(()), |path| grainlab_console::has_name_of("--plot", path, "svg"))?;
    if !rows.columns.has_truth() {
        let needed = InferredQuantity::ALL.map(InferredQuantity::name).join(", ");
        return Err(Failure::usage(format!("{}: no column to judge by ({needed})", rows.name())));
    }
    let mut tally = Tally::new("invalid");
    let mut board = Board::default();
    let mut points = vec![Vec::new(); cases.len()];
    let mut unsolved = Vec::new();
    loop {
        let piece = rows.next(|number, row| {
            let row = row.map_err(|bad| (number, bad))?;
            let verdicts: Vec<_> = cases.iter().map(|case| Verdict::of(&row.state, case)).collect();
            let unsolved = verdicts.iter().all(|v| !v.solved).then(|| {
                let answer = Answer::of(row.state, Some(number), cases);
                (answer.exit(cases), answer.complaint(cases))
            });
            Ok::<_, (u64, BadRow)>((row.group, verdicts, unsolved))
        })?;
        let Some(piece) = piece else { break };
        for row in piece {
            match row {
                Ok((group, verdicts, reason)) => {
                    tally.add(Exit::Done, "");
                    unsolved.extend(reason);
                    for (points, verdict) in points.iter_mut().zip(&verdicts) {
                        points.extend(verdict.anisotropy);
                    }
                    board.enter(group, &verdicts);
                }
                // A missing estimate is part of the statistics. An invalid row is an error.
                Err((number, bad)) => {
                    tally.add(Exit::Usage, &Answer::of_bad_row(bad, number).complaint(cases));
                }
            }
        }
    }
    let judged = board.judged(cases);
    let text = || table(&judged, by, fixed).without_empty_columns().text() + &overconfident(&judged);
    format.print(&judged, || table(&judged, by, |v, _| exact(v)).csv(), text)?;
    if let Some(path) = plot.filter(|_| points.iter().all(Vec::is_empty)) {
        tally.end(&rows)?;
        return Err(Failure::usage(format!(
            "{} is not written: no row of {} has eps, and a model that infers it",
            path.display(),
            rows.name()
        )));
    }
    #[cfg(feature = "studio")]
    if let Some(path) = plot {
        grainlab_console::write_whole(path, plot::svg(cases, points))?;
    }
    if let Some((exit, complaint)) = unsolved.first() {
        say!("{complaint}\ngrainlab: {} without an estimate, this the first", count(unsolved.len(), "row"));
        tally.unsolved(unsolved.len(), *exit);
    }
    tally.end(&rows)
}

impl Verdict {
    fn of(state: &State, case: &Case) -> Self {
        let estimate = state.infer(case).ok();
        let errors = InferredQuantity::ALL.map(|quantity| {
            let truth = state.truth.get(against(quantity))?;
            Some(score::Error::of(estimate.as_ref(), quantity, truth))
        });
        let found = estimate.as_ref().and_then(|e| e.structure.eps);
        let anisotropy = state.truth.eps.zip(found).map(<[f64; 2]>::from);
        Self { solved: estimate.is_some(), gamma: state.gamma_source(case), errors, anisotropy }
    }
}

/// The quantity for comparison: k̂ is not a property of a packing, so that k is used.
fn against(quantity: InferredQuantity) -> InferredQuantity {
    if quantity == InferredQuantity::KHat { InferredQuantity::K } else { quantity }
}

/// Scores of each quantity by group, case and γ/Δ.
#[derive(Default)]
struct Board {
    /// Numbers of the groups, in the order of their first rows.
    groups: HashMap<Vec<String>, usize>,
    scores: BTreeMap<(usize, usize, &'static str), [Score; InferredQuantity::COUNT]>,
}

impl Board {
    fn enter(&mut self, group: Vec<String>, verdicts: &[Verdict]) {
        let next = self.groups.len();
        let group = *self.groups.entry(group).or_insert(next);
        for (case, verdict) in verdicts.iter().enumerate() {
            let scores = self.scores.entry((group, case, verdict.gamma)).or_default();
            let known = scores.iter_mut().zip(&verdict.errors);
            known.for_each(|(score, error)| error.iter().for_each(|error| score.add(error)));
        }
    }

    /// For each quantity of the model whose truth is known.
    fn judged(&self, cases: &[Case]) -> Vec<Judged> {
        let mut judged = Vec::new();
        let mut groups: Vec<_> = self.groups.iter().collect();
        groups.sort_by_key(|(_, number)| **number);
        for ((group, case, gamma), scores) in &self.scores {
            let case = &cases[*case];
            let domain = case.model.domain(&case.calibration);
            for (quantity, score) in InferredQuantity::ALL.into_iter().zip(scores) {
                if score.rows > 0 && (score.solved > 0 || domain.structure[quantity as usize].is_some()) {
                    judged.push(Judged {
                        group: groups[*group].0.clone(),
                        model: case.model.name(),
                        calibration: case.calibration.name().to_owned(),
                        gamma_over_delta_source: gamma,
                        quantity: quantity.name(),
                        truth: against(quantity).name(),
                        score: *score,
                    });
                }
            }
        }
        judged
    }
}

/// Every result, with numbers printed by `number`, which takes their digits.
fn table(judged: &[Judged], by: &[String], number: fn(Option<f64>, usize) -> String) -> Table {
    let columns = ["model", "calibration", "gamma_over_delta_source", "quantity", "truth", "rows", "solved"];
    let columns = columns.into_iter().chain(["extrapolated", "bias", "scatter", "rms", "mean_absolute"]);
    let columns = columns.chain(["intervals", "covered"]);
    let mut t = Table::new(by.iter().map(String::as_str).chain(columns));
    for j in judged {
        let (s, digits) = (&j.score, if j.quantity.starts_with("eps") { 4 } else { 3 });
        let cells =
            [j.model, &j.calibration, j.gamma_over_delta_source, j.quantity, j.truth].map(str::to_owned);
        let counts = [s.rows, s.solved, s.extrapolated].map(|n| n.to_string());
        let numbers = [s.bias(), s.scatter(), s.rms(), s.mean_absolute()].map(|v| number(v, digits));
        let covered = [s.intervals.to_string(), number(s.coverage(), 3)];
        t.row(j.group.iter().cloned().chain(cells).chain(counts).chain(numbers).chain(covered));
    }
    t
}

/// One line for each quantity whose intervals hold the truth far less often than stated.
fn overconfident(judged: &[Judged]) -> String {
    let line = |j: &Judged| {
        format!(
            "{}{}: its 95 % intervals hold {} in {} of {} rows: these packings are unlike those of calibration {}, or {} was \
             counted in another way\n",
            j.group.iter().map(|cell| format!("{cell} ")).collect::<String>(),
            j.model,
            j.truth,
            j.score.covered(),
            j.score.intervals,
            j.calibration,
            j.truth,
        )
    };
    judged.iter().filter(|j| j.score.is_overconfident()).map(line).collect()
}
